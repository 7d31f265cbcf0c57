"""What only windows of recordings excuse is not told as nothing missing."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, C, I, R, Recording, Se, Sf, Windows, bind_to, q
from bondgraph.diagnosis.answer.long_run import lost_over_whole, off_in_the_long_run
from bondgraph.diagnosis.evidence.leftover import noise_floor
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.simulation.solvers import Hold

STEP, COUNT, NOISE = 1.0, 3000, 1e-3
CAPACITY, SERIES, QUICK, SLOW = 2e4, 0.01, (0.01, 10.0), (0.03, 200.0)


def cell():
    g = BondGraph("cell", domain="electrical")
    g.zero("terminal", Sf("load"))
    law = sympy.Symbol("empty") + q / sympy.Symbol("capacity")
    g.one("loop", C("charge", law=law), R("series"))
    g.join("terminal", "loop")
    g.zero("pair", R("quick"), C("store"))
    g.join("loop", "pair")
    g.measure("voltage", effort="terminal")
    g.parameter("empty", 3.0, "V", std=0.0)
    g.parameter("capacity", 1.8e4, "F", bounds=(100.0, 1e6))
    g.parameter("series", 0.03, "ohm", bounds=(0.0, 1.0))
    g.parameter("quick", 0.03, "ohm", bounds=(1e-4, 1.0))
    g.parameter("store", 600.0, "F", bounds=(1.0, 1e5))
    return g.finish()


def discharged(pairs):
    """Return a cell's voltage under a load in steps, stepped by hand."""
    random = np.random.default_rng(4)
    load = np.repeat(random.uniform(-4.0, 4.0, COUNT // 40), 40)
    charge, drops, voltage = 1000.0, np.zeros(len(pairs)), np.zeros(COUNT)
    for k, current in enumerate(load):
        voltage[k] = 3.0 + charge / CAPACITY + SERIES * current + drops.sum()
        charge += STEP * current
        for i, (resistance, time) in enumerate(pairs):
            fade = np.exp(-STEP / time)
            drops[i] = fade * drops[i] + (1 - fade) * resistance * current
    noisy = voltage + NOISE * random.standard_normal(COUNT)
    channels = {"load": (load, "A"), "voltage": (noisy, "V")}
    return bind_to(
        cell(), Recording.from_arrays("cell", STEP * np.arange(COUNT), channels)
    )


@pytest.mark.parametrize(
    ("pairs", "missing"), [((QUICK,), False), ((QUICK, SLOW), True)]
)
def test_what_acts_more_slowly_than_the_windows_shows_in_whole_recordings(
    pairs, missing
):
    run = discharged(pairs)
    settings = FitSettings(horizon=Windows(120), hold=Hold.ZERO)
    base = fit_model(cell(), [run], settings)
    told = off_in_the_long_run(base, [run], noise_floor([run]))
    assert (told is not None) == missing
    if missing:
        assert "Over windows of 119 s" in told
        assert "misses voltage by" in told


def test_what_integrates_twice_says_nothing_in_the_long_run():
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("mass"))
    g.measure("position", displacement="cart")
    g.parameter("mass", 2.0, "kg")
    cart = g.finish()
    random = np.random.default_rng(1)
    force = np.repeat(random.uniform(-1.0, 1.0, 50), 20)
    push = force + 0.5 * random.standard_normal(1000)
    position = np.cumsum(np.cumsum(push)) * 1e-4 / 2.0
    position += 1e-5 * random.standard_normal(1000)
    channels = {"force": (force, "N"), "position": (position, "m")}
    run = bind_to(cart, Recording.from_arrays("cart", 1e-2 * np.arange(1000), channels))
    base = fit_model(cart, [run], FitSettings(horizon=Windows(50)))
    assert off_in_the_long_run(base, [run], noise_floor([run])) is None
    missed = SimpleNamespace(after=SimpleNamespace(nrmse=30.0))
    (note,) = lost_over_whole(base, [run], missed)
    assert "say nothing" in note
    assert "windows of 0.49 s" in note
    followed = SimpleNamespace(after=SimpleNamespace(nrmse=0.3))
    assert lost_over_whole(base, [run], followed) == ()
