"""A resistance may be steered by something that is recorded elsewhere."""

import numpy as np
import pytest
import sympy

from bondgraph import (
    BondGraph,
    C,
    I,
    R,
    Recording,
    Se,
    Sf,
    bind_to,
    diagnose,
    e,
    effort,
)
from bondgraph.diagnosis.search.options import Options
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.unknown import UnknownRelation

MASS, STIFFNESS, COIL, WINDING = 2.0, 180.0, 0.4, 8.0
STEP, PARTS = 0.02, 20


def suspension():
    """Return a mass on a spring and a damper, whose coil is a circuit of its own."""
    graph = BondGraph("damper with a coil")
    graph.one(
        "mass", Se("force"), I("m"), C("spring"), R("damper"), domain="translation"
    )
    graph.one("coil", Se("voltage"), I("L"), R("winding"), domain="electrical")
    graph.measure("x", displacement="mass")
    graph.measure("current", flow="coil")
    graph.parameter("m", MASS, "kg", std=0.0)
    graph.parameter("spring", 1 / 160.0, "m/N", bounds=(1e-4, 1.0))
    graph.parameter("damper", 6.0, "N*s/m", bounds=(0.0, 1e3))
    graph.parameter("L", COIL, "H", std=0.0)
    graph.parameter("winding", 7.0, "ohm", bounds=(0.1, 100.0))
    return graph.finish()


def damping(current):
    """Return how a magnetorheological damper stiffens with its current, N s/m."""
    return 3.0 + 30.0 * current**2 / (0.3 + current**2)


def recorded(graph, seed, samples=900):
    random = np.random.default_rng(seed)
    force = np.repeat(random.normal(scale=15.0, size=samples // 15), 15)
    voltage = np.repeat(random.uniform(0.0, 12.0, samples // 60), 60)
    v = x = i = 0.0
    read = []
    for k in range(samples):
        read.append((x, i))
        for _ in range(PARTS):
            h = STEP / PARTS
            v += h * (force[k] - STIFFNESS * x - damping(i) * v) / MASS
            x += h * v
            i += h * (voltage[k] - WINDING * i) / COIL
    x, i = (np.array(read) + random.normal(size=(samples, 2)) * (2e-4, 2e-3)).T
    channels = {
        "force": (force, "N"),
        "voltage": (voltage, "V"),
        "x": (x, "m"),
        "current": (i, "A"),
    }
    time = STEP * np.arange(samples)
    return bind_to(graph, Recording.from_arrays(f"run {seed}", time, channels))


@pytest.mark.long
def test_a_damper_that_its_coil_stiffens_is_told_as_a_curve_of_the_current():
    graph = suspension()
    library = (UnknownRelation(), QuadraticDrag(), CoulombFriction())
    found = diagnose(
        graph,
        [recorded(graph, 1)],
        held_out=[recorded(graph, 2)],
        options=Options(library=library),
    )
    (curve,) = found.findings
    assert (curve.physics, curve.place) == ("unknown_relation", "damper")
    assert "damper changes with current" in curve.statement
    assert found.held_out.after.nrmse < 0.05 * found.held_out.before.nrmse
    (law,) = found.recovered
    usual = np.interp(0.8, law.curve_argument, law.curve_value)
    shape = damping(law.curve_argument) / damping(0.8)
    assert law.curve_value / usual == pytest.approx(shape, abs=0.1)


def steered_at(name):
    places = all_places(suspension(), Scales())
    (place,) = (one for one in places if one.name == name)
    return [one.words for one in UnknownRelation().propose(place)]


def test_what_is_beside_a_resistance_does_not_steer_it():
    assert steered_at("damper") == [
        "damper changes with current",
        "damper changes with voltage",
    ]
    assert steered_at("winding") == [
        "winding changes with x",
        "winding changes with force",
    ]


CAPACITY, OUTLET, COVERED = 1.5, 2.0, 0.4


def tank():
    """Return a tank that drains through a hole, with a root of the level."""
    graph = BondGraph("tank", domain="hydraulic")
    law = sympy.Symbol("hole") * sympy.sqrt(e)
    graph.zero("tank", Sf("jet"), C("area"), R("outlet", law=law))
    graph.measure("level", effort("tank"))
    graph.parameter("area", 1.2, "m^3/Pa", bounds=(0.1, 10.0))
    graph.parameter("hole", 1.6, bounds=(0.1, 10.0))
    return graph.finish()


def filled(graph, seed, samples=600):
    """Return a run in which the jet covers a part of the hole."""
    random = np.random.default_rng(seed)
    jet = np.repeat(random.uniform(1.0, 5.0, samples // 30), 30)
    level, read = 2.0, []
    for flow in jet:
        read.append(level)
        for _ in range(PARTS):
            passes = OUTLET * (1.0 - COVERED * flow**2 / (9.0 + flow**2))
            level += STEP * 5 / PARTS * (flow - passes * np.sqrt(level)) / CAPACITY
    read = np.array(read) + 2e-3 * random.normal(size=samples)
    channels = {"jet": (jet, "m^3/s"), "level": (read, "Pa")}
    time = 5 * STEP * np.arange(samples)
    return bind_to(graph, Recording.from_arrays(f"run {seed}", time, channels))


@pytest.mark.long
def test_a_root_law_is_steered_by_the_jet_that_meets_its_hole():
    graph = tank()
    found = diagnose(
        graph,
        [filled(graph, 1)],
        held_out=[filled(graph, 2)],
        options=Options(library=(UnknownRelation(), QuadraticDrag())),
    )
    (curve,) = found.findings
    assert (curve.physics, curve.place) == ("unknown_relation", "outlet")
    assert "outlet changes with jet" in curve.statement
    assert found.held_out.after.nrmse < 0.1 * found.held_out.before.nrmse


def test_a_number_of_the_law_that_is_nothing_is_held_at_nothing():
    graph = BondGraph("tank", domain="hydraulic")
    law = sympy.Symbol("hole") * e + sympy.Symbol("seep")
    graph.zero("tank", Sf("jet"), C("area"), R("outlet", law=law))
    graph.measure("level", effort("tank"))
    graph.parameter("area", 1.2, "m^3/Pa")
    graph.parameter("hole", 1.6)
    graph.parameter("seep", 0.0)
    (place,) = (p for p in all_places(graph.finish(), Scales()) if p.name == "outlet")
    (steered,) = (h for h in UnknownRelation().propose(place) if "jet" in h.words)
    held = {p.name: p.value for p in steered.edit.parameters if p.exact}
    assert held["usual_hole_outlet"] == 1.6
    assert held["usual_seep_outlet"] == 0.0
