"""Displacements between two bodies, and stops that are hit once."""

from itertools import product

import numpy as np
import pytest
import sympy

from bondgraph import (
    TF,
    BondGraph,
    C,
    I,
    R,
    Recording,
    Se,
    bind_to,
    displacement,
    flow,
)
from bondgraph.diagnosis.probing import measure_scales, probe
from bondgraph.diagnosis.search.trials.trying import Trial, fit_briefly
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import WholeRecordings, Windows
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.displacements import known_displacement
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.position import (
    Cogging,
    EndStop,
    Gravity,
    HardeningSpring,
    Spring,
)
from bondgraph.structure.signals import parameter_symbol

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


def geared_washer(*measured):
    """Return a motor that turns a drum through a gear and a belt that gives."""
    g = BondGraph("washer", domain="rotation")
    g.one("motor", Se("torque"), I("rotor"))
    g.one("pulley")
    g.zero("belt")
    g.one("stretch", C("give"), R("loss"))
    g.one("drum", I("inertia"), R("bearing"))
    g.join("motor", TF("ratio"), "pulley")
    g.join("pulley", "belt")
    g.join("belt", "stretch")
    g.join("belt", "drum")
    for name in measured:
        g.measure(f"angle_{name}", displacement=name)
    known = {
        "rotor": (0.01, "kg*m^2"),
        "ratio": (5.0, "1"),
        "give": (0.02, "rad/(N*m)"),
        "loss": (0.5, "N*m*s/rad"),
        "inertia": (0.2, "kg*m^2"),
        "bearing": (0.1, "N*m*s/rad"),
    }
    for name, (value, unit) in known.items():
        g.parameter(name, value, unit, std=0.0)
    return g.finish()


def test_an_angle_is_known_behind_a_gear_and_a_shaft_that_gives():
    graph = geared_washer("motor")
    ratio = parameter_symbol("ratio")
    assert known_displacement(graph, "pulley") == {"motor": 1 / ratio}
    assert known_displacement(graph, "drum") == {"motor": 1 / ratio, "stretch": -1}
    # And from the drum back to the motor.
    graph = geared_washer("drum")
    assert known_displacement(graph, "pulley") == {"drum": 1, "stretch": 1}
    assert known_displacement(graph, "motor") == {"drum": ratio, "stretch": ratio}


def test_without_any_angle_none_is_known_but_that_of_the_spring():
    graph = geared_washer()
    known = {n: known_displacement(graph, n) for n in ("motor", "pulley", "drum")}
    assert known == {"motor": None, "pulley": None, "drum": None}
    assert known_displacement(graph, "stretch") == {"stretch": 1}


def test_a_known_angle_is_the_one_that_is_simulated():
    graph = geared_washer("motor")
    time = np.arange(200) * 0.01
    torque = np.sin(3.0 * time)
    channels = {"torque": (torque, "N*m"), "angle_motor": (torque, "rad")}
    recording = bind_to(graph, Recording.from_arrays("run", time, channels))
    base = fit_model(graph, [recording], FitSettings(horizon=WholeRecordings()))
    drum = known_displacement(graph, "drum")
    told = sympy.Add(*(k * displacement(name) for name, k in drum.items()))
    angle, speed = probe(base, (told, flow("drum"))).values()
    turned = np.diff(angle)
    np.testing.assert_allclose(
        turned, 0.005 * (speed[1:] + speed[:-1]), atol=2e-3 * np.abs(turned).max()
    )


def test_a_lattice_of_masses_is_gone_through_once():
    """Not once for every way through it, of which six by six masses have millions."""
    g = BondGraph("lattice", domain="translation")
    size = range(6)
    for i, j in product(size, size):
        g.one(f"m_{i}_{j}", I(f"mass_{i}_{j}"))
    for i, j in product(size, size):
        for a, b in ((i, j + 1), (i + 1, j)):
            if max(a, b) in size:
                tie = f"{i}_{j}_{a}_{b}"
                g.zero(f"z_{tie}")
                g.one(f"s_{tie}", C(f"c_{tie}"))
                g.join(f"m_{i}_{j}", f"z_{tie}")
                g.join(f"z_{tie}", f"m_{a}_{b}")
                g.join(f"z_{tie}", f"s_{tie}")
    g.put(Se("push"), on="m_0_0")
    g.measure("speed", flow="m_0_0")
    assert known_displacement(g.finish(), "m_0_0") is None
    g.measure("place", displacement="m_0_0")
    far = known_displacement(g.finish(), "m_5_5")
    assert far["m_0_0"] == 1
    # As many springs as lie between the corners, each passed once.
    assert sorted(far.values()) == [-1] * 10 + [1]


def test_what_goes_rigidly_with_another_has_no_springs_of_its_own_but_its_own_turns():
    graph = geared_washer("motor")

    def proposed(name):
        return {
            hypothesis.physics
            for place in places(graph, name)
            for physics in (Spring(), EndStop(), Gravity(), Cogging())
            for hypothesis in physics.propose(place)
        }

    assert proposed("pulley") == {"gravity", "cogging"}
    assert proposed("motor") == {"spring", "end_stop", "gravity", "cogging"}
    assert proposed("drum") == {"spring", "end_stop", "gravity", "cogging"}


def test_nothing_repeats_along_how_far_a_spring_is_stretched():
    g = BondGraph("two carts", domain="translation")
    g.one("near", Se("push"), I("m_near"), C("buffer"))
    g.zero("between")
    g.one("stretch", C("rope"), R("rope_loss"))
    g.one("far", I("m_far"))
    g.join("near", "between")
    g.join("between", "stretch")
    g.join("between", "far")
    g.measure("far_place", displacement="far")
    for name, unit in (
        ("m_near", "kg"),
        ("m_far", "kg"),
        ("buffer", "m/N"),
        ("rope", "m/N"),
        ("rope_loss", "N*s/m"),
    ):
        g.parameter(name, 1.0, unit)
    graph = g.finish()

    def rippled(graph):
        return {
            place.name
            for place in all_places(graph, Scales())
            if list(Cogging().propose(place))
        }

    assert rippled(graph) == {"near", "far"}
    # Nor where a law of that stretch has been found.
    (stretch,) = (p for p in all_places(graph, Scales()) if p.name == "stretch")
    softer = next(HardeningSpring().propose(stretch))
    assert rippled(softer.apply(graph)) == {"near", "far"}


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
