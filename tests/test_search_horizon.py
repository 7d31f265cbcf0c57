"""The windows of a search: many, and over which a fit can hold on to the machine."""

import numpy as np
import pytest
import sympy

from bondgraph import (
    BondGraph,
    C,
    I,
    MSe,
    R,
    Recording,
    Se,
    Sf,
    bind_to,
    displacement,
    effort,
    q,
)
from bondgraph.diagnosis.search.base.horizons import search_settings
from bondgraph.fitting.automatic import grows
from bondgraph.fitting.estimate import FitSettings, prepare
from bondgraph.fitting.horizon import WholeRecordings, Windows

SAMPLES = 4800


def collar(stiffness):
    """Return a levitated collar, whose magnets push it from the middle or pull."""
    g = BondGraph("collar", domain="translation")
    pull = C("magnet", law=sympy.Symbol("stiffness") * q)
    g.one("collar", Se("force"), I("mass"), R("loss"), pull)
    g.measure("gap", displacement="collar")
    g.parameter("mass", 2.0, "kg", std=0.0)
    g.parameter("loss", 20.0, "N*s/m", bounds=(0, 1000))
    g.parameter("stiffness", stiffness, "N/m")
    return g.finish()


@pytest.mark.parametrize(
    ("stiffness", "horizon"),
    [
        # It runs away by a factor of e every 2 ms: a million times in 56 samples.
        (-5e5, Windows(25)),
        (-5e2, Windows(200)),
        (0.0, Windows(200)),
        (5e5, WholeRecordings()),
    ],
)
def test_an_unstable_machine_is_cut_into_windows_that_hold(stiffness, horizon):
    graph = collar(stiffness)
    random = np.random.default_rng(1)
    channels = {
        "force": (random.standard_normal(SAMPLES), "N"),
        "gap": (1e-4 * random.standard_normal(SAMPLES), "m"),
    }
    time = 5e-4 * np.arange(SAMPLES)
    recording = bind_to(graph, Recording.from_arrays("run", time, channels))
    assert search_settings(graph, [recording], FitSettings()).horizon == horizon


@pytest.mark.parametrize(
    ("runs", "samples", "window"), [(6, 120, 120), (5, 120, 25), (6, 400, 100)]
)
def test_many_short_runs_are_windows_as_they_are(runs, samples, window):
    graph = collar(0.0)
    time, zeros = 5e-4 * np.arange(samples), np.zeros(samples)
    channels = {"force": (zeros, "N"), "gap": (zeros, "m")}
    recordings = [
        bind_to(graph, Recording.from_arrays(f"run {i}", time, channels))
        for i in range(runs)
    ]
    chosen = search_settings(graph, recordings, FitSettings()).horizon
    assert chosen == Windows(window)


def test_what_has_no_state_has_nothing_that_grows():
    g = BondGraph("damper", domain="translation")
    g.one("rod", Sf("speed"), R("loss"))
    g.measure("force", effort("loss"))
    g.parameter("loss", 20.0, "N*s/m", bounds=(0, 1000))
    graph = g.finish()
    speed = np.random.default_rng(1).standard_normal(SAMPLES)
    channels = {"speed": (speed, "m/s"), "force": (20.0 * speed, "N")}
    time = 1e-3 * np.arange(SAMPLES)
    recording = bind_to(graph, Recording.from_arrays("run", time, channels))
    assert not grows(graph, prepare(graph), [recording], FitSettings())


@pytest.mark.parametrize(("stiffness", "runs_away"), [(-5e5, True), (5e5, False)])
def test_an_effect_that_goes_on_growing_is_seen(stiffness, runs_away):
    graph = collar(stiffness)
    time = 5e-4 * np.arange(SAMPLES)
    force = np.random.default_rng(1).standard_normal(SAMPLES)
    channels = {"force": (force, "N"), "gap": (0.0 * time, "m")}
    recording = bind_to(graph, Recording.from_arrays("run", time, channels))
    assert grows(graph, prepare(graph), [recording], FitSettings()) == runs_away


@pytest.mark.parametrize(("push", "runs_away"), [(20.0, True), (-20.0, False)])
def test_what_has_run_away_as_far_as_it_can_go_grew(push, runs_away):
    g = BondGraph("hill", domain="translation")
    slope = sympy.Symbol("push") * sympy.tanh(displacement("ball") / 0.01)
    g.one("ball", Se("force"), I("mass"), R("drag"), MSe("hill", value=slope))
    g.measure("place", displacement="ball")
    g.parameter("mass", 1.0, "kg")
    g.parameter("drag", 20.0, "N*s/m")
    g.parameter("push", push, "N")
    graph = g.finish()
    time = 2e-3 * np.arange(SAMPLES)
    force = np.random.default_rng(1).standard_normal(SAMPLES)
    channels = {"force": (force, "N"), "place": (0.0 * time, "m")}
    recording = bind_to(graph, Recording.from_arrays("run", time, channels))
    assert grows(graph, prepare(graph), [recording], FitSettings()) == runs_away
