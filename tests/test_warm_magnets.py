"""A motor's constant falls as its magnets warm, by its winding's losses or a body's."""

from dataclasses import replace

import numpy as np
import pytest

from bondgraph import (
    GY,
    BondGraph,
    C,
    FitSettings,
    Hold,
    I,
    R,
    Recording,
    Se,
    Sf,
    bind_to,
    fit,
)
from bondgraph.diagnosis.probing import Scales
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.thermal import TemperatureDependentGyrator

STEP, COUNT = 0.02, 3000
OHM, HENRY, CONSTANT, INERTIA, LOSS = 1.5, 0.02, 0.3, 0.01, 0.004
DRIFT, TIME = 0.12, 15.0


def motor(*, case=False):
    """Return a motor of which current and speed are measured, and its warm case."""
    graph = BondGraph("motor", domain="electrical")
    graph.one("winding", Se("u"), R("ohm"), I("henry"))
    graph.one("shaft", I("rotor"), R("bearing"), domain="rotation")
    graph.join("winding", GY("k_m"), "shaft")
    if case:
        graph.zero("case", Sf("losses"), C("heat"), R("air"), domain="thermal")
        graph.parameter("heat", 100.0, "J/K")
        graph.parameter("air", 2.0, "K/W")
    graph.parameter("ohm", OHM, "ohm")
    graph.parameter("henry", HENRY, "H")
    graph.parameter("k_m", 0.9 * CONSTANT, "V*s/rad")
    graph.parameter("rotor", INERTIA, "kg*m^2")
    graph.parameter("bearing", LOSS, "N*m*s/rad")
    graph.measure("current", flow="winding")
    graph.measure("speed", flow="shaft")
    return graph.finish()


def proposed(graph, place):
    """Return what may warm of an element, where currents come and go all through."""
    scales = Scales(lasting=frozenset({"flow(winding)"}))
    (here,) = (p for p in all_places(graph, scales) if p.name == place)
    return list(TemperatureDependentGyrator().propose(here))


def cooling():
    """Return a recording of a motor whose magnets were warm, and recover."""
    time = STEP * np.arange(COUNT)
    steps = np.random.default_rng(1).uniform(-12.0, 12.0, COUNT // 30 + 1)
    volts = np.repeat(steps, 30)[:COUNT]
    fine = 40
    current = speed = 0.0
    rows = []
    for now, u in zip(time, volts, strict=True):
        rows.append((current, speed))
        for j in range(fine):
            k = CONSTANT * (1.0 - DRIFT * np.exp(-(now + j * STEP / fine) / TIME))
            rise = (u - OHM * current - k * speed) / HENRY
            pull = (k * current - LOSS * speed) / INERTIA
            current += STEP / fine * rise
            speed += STEP / fine * pull
    read = np.array(rows) + np.random.default_rng(2).normal(size=(COUNT, 2)) * 0.01
    channels = {
        "u": (volts, "V"),
        "current": (read[:, 0], "A"),
        "speed": (read[:, 1], "rad/s"),
    }
    return bind_to(motor(), Recording.from_arrays("run", time, channels))


def test_it_is_warmed_by_the_winding_or_as_warm_as_a_body():
    assert [one.words for one in proposed(motor(case=True), "k_m")] == [
        "k_m changes as its magnets warm or cool",
        "k_m changes evenly with time, whatever passes through it",
        "k_m is another one as a recording begins, and recovers",
        "k_m changes with the temperature of case",
    ]


def test_no_wheel_that_turns_in_two_axes_has_magnets():
    graph = BondGraph("gyroscope", domain="rotation")
    graph.one("pitch", Se("push"), I("about_pitch"))
    graph.one("yaw", I("about_yaw"))
    graph.join("pitch", GY("spin"), "yaw")
    graph.parameter("about_pitch", 1.0, "kg*m^2")
    graph.parameter("about_yaw", 1.0, "kg*m^2")
    graph.parameter("spin", 1.0, "N*m*s/rad")
    graph.measure("rate", flow="yaw")
    assert not proposed(graph.finish(), "spin")


@pytest.mark.parametrize("form", [0, 2])
def test_magnets_that_stood_warm_recover(form):
    law = proposed(motor(), "k_m")[form]
    start = law.starts[-1]
    graph = law.apply(motor())
    begun = graph.with_parameters(
        [replace(p, value=start.get(p.name, p.value)) for p in graph.parameters.members]
    )
    found = fit(begun, [cooling()], settings=FitSettings(hold=Hold.ZERO))
    (name,) = (p.name for p in law.edit.parameters if p.unit == "s")
    time = found.estimate(name)
    assert time.value == pytest.approx(TIME, rel=0.1)
    assert found.estimate("k_m").value == pytest.approx(CONSTANT, rel=0.01)
    if form == 2:
        beginning = found.estimate("beginning_k_m")
        assert beginning.value == pytest.approx(-DRIFT, rel=0.05)
