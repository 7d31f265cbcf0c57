"""Displacements between two bodies, and stops that are hit once."""

import numpy as np
import pytest

from bondgraph import BondGraph, I, R, Recording, Se, bind_to, displacement
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.trials.trying import Trial, fit_briefly
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import Windows
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.displacements import known_displacement
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.position import EndStop, Spring

UPPER, LOWER = displacement("upper"), displacement("lower")


def two_bodies(*measured):
    g = BondGraph("two bodies", domain="translation")
    g.one("upper", Se("push"), I("m_upper"), R("rail"))
    g.zero("between")
    g.one("lower", I("m_lower"))
    g.one("joint", R("damper"))
    g.join("upper", "between")
    g.join("between", "lower")
    g.join("between", "joint")
    for name in measured:
        g.measure(f"x_{name}", displacement=name)
    return g.finish()


def places(graph, name, scales=None):
    return [p for p in all_places(graph, scales or Scales()) if p.name == name]


def test_between_two_measured_bodies_the_displacement_is_their_difference():
    graph = two_bodies("upper", "lower")
    assert known_displacement(graph, "joint") == {"upper": 1, "lower": -1}
    (place,) = (p for p in places(graph, "joint") if hasattr(p, "displacement_signal"))
    assert place.displacement_signal == UPPER - LOWER
    (spring,) = Spring().propose(place)
    assert spring.edit.element.value.has(UPPER, LOWER)


def test_beside_one_that_is_not_measured_it_is_not_known():
    graph = two_bodies("upper")
    assert known_displacement(graph, "joint") is None
    assert known_displacement(graph, "upper") == {"upper": 1}
    (place,) = (p for p in places(graph, "joint") if hasattr(p, "displacement_signal"))
    assert list(Spring().propose(place)) == []


def test_what_waits_is_what_has_to_be_reached():
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("m"), R("b"))
    g.measure("x", displacement="cart")
    waiting = {
        hypothesis.physics
        for place in all_places(g.finish(), Scales())
        for physics in LIBRARY
        for hypothesis in physics.propose(place)
        if hypothesis.waits
    }
    assert "end_stop" in waiting
    assert waiting.isdisjoint({"saturation", "dead_zone", "coulomb_friction", "spring"})


def stopped_cart(time, force, stop):
    """Return positions of a cart of 1 kg on 0.5 N·s/m before a stiff stop."""
    fine, step = 50, time[1] - time[0]
    x = v = 0.0
    found = []
    for now in force:
        found.append(x)
        for _ in range(fine):
            pressed = max(x - stop, 0.0)
            v += (now - 0.5 * v - 5e4 * pressed * (1 + 2.0 * v)) * step / fine
            x += v * step / fine
    return np.array(found)


def test_a_stop_that_is_hit_once_is_found_from_where_the_motion_began():
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("m"), R("b"))
    g.measure("x", displacement="cart")
    g.parameter("m", 1.0, "kg", std=0.0)
    g.parameter("b", 0.4, "N*s/m", bounds=(0.01, 10))
    graph = g.finish()
    time = np.arange(1200) * 0.01
    force = 0.6 * np.sin(1.1 * time + 2.0) + 0.4 * np.sin(3.0 * time)
    noise = 5e-4 * np.random.default_rng(1).standard_normal(time.size)
    x = stopped_cart(time, force, stop=0.35) + noise
    assert x.max() == pytest.approx(0.35, abs=0.005)
    channels = {"force": (force, "N"), "x": (x, "m")}
    recording = bind_to(graph, Recording.from_arrays("run", time, channels))
    settings = FitSettings(horizon=Windows(600))
    base = fit_model(graph, [recording], settings)
    place = places(graph, "cart", measure_scales(base))[0]
    upper = next(h for h in EndStop().propose(place) if "upper" in h.words)
    found = fit_briefly(base, Trial(upper, enough=0.99))
    # From the base model's states a short fit leaves 3 %.
    assert found["cost"] < 0.01 * base.optimum.cost
    assert found["values"]["upper_stop_cart"] == pytest.approx(0.35, abs=0.02)
