"""A resistance that something leads may be wrong in what its own flow does."""

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
    f,
    flow,
)
from bondgraph.diagnosis.search.options import Options
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.unknown import UnknownRelation

INERTIA, PEAK = 0.5, 36.0
STEP, PARTS = 0.05, 20


def trainer():
    """Return a flywheel with a brake that drags with the square of a coil's current."""
    drag = sympy.Symbol("k") * flow("coil") ** 2
    graph = BondGraph("trainer", domain="rotation")
    graph.one("coil", Sf("current"), domain="analogue")
    graph.one("wheel", Se("torque"), I("J"), R("brake", law=drag * f))
    graph.measure("speed", flow="wheel")
    graph.parameter("J", INERTIA, "kg*m^2", std=0.0)
    graph.parameter("k", 0.05, "N*m*s/rad", bounds=(0.0, 1.0))
    return graph.finish()


def drag(speed):
    """Return what a brake of eddy currents drags per squared ampere and speed."""
    return 0.06 / (1.0 + (speed / PEAK) ** 2)


def braked(graph, seed, samples=800):
    random = np.random.default_rng(seed)
    torque = np.repeat(random.uniform(1.2, 3.8, samples // 40), 40)
    current = np.repeat(random.uniform(1.1, 1.7, samples // 50), 50)
    speed, read = 30.0, []
    for t, i in zip(torque, current, strict=True):
        read.append(speed)
        for _ in range(PARTS):
            speed += STEP / PARTS * (t - drag(speed) * i**2 * speed) / INERTIA
    read = np.array(read) + 0.05 * random.normal(size=samples)
    channels = {
        "torque": (torque, "N*m"),
        "current": (current, "A"),
        "speed": (read, "rad/s"),
    }
    time = STEP * np.arange(samples)
    return bind_to(graph, Recording.from_arrays(f"run {seed}", time, channels))


@pytest.mark.long
def test_a_brake_past_its_peak_is_told_as_a_factor_along_its_speed():
    graph = trainer()
    found = diagnose(
        graph,
        [braked(graph, 1)],
        held_out=[braked(graph, 2)],
        options=Options(
            library=(UnknownRelation(), QuadraticDrag(), CoulombFriction())
        ),
    )
    (curve,) = found.findings
    assert (curve.physics, curve.place) == ("unknown_relation", "brake")
    assert "brake changes with angular velocity" in curve.statement
    assert found.held_out.after.nrmse < 0.1 * found.held_out.before.nrmse
    (law,) = found.recovered
    usual = np.interp(38.0, law.curve_argument, law.curve_value)
    shape = drag(law.curve_argument) / drag(38.0)
    assert law.curve_value / usual == pytest.approx(shape, abs=0.05)


def curves_at_outlet(law):
    graph = BondGraph("tank", domain="hydraulic")
    graph.zero("valve", Se("opening"), domain="analogue")
    graph.zero("tank", Sf("pump"), C("area"), R("outlet", law=law))
    graph.measure("level", effort("tank"))
    graph.parameter("area", 1.2, "m^3/Pa")
    graph.parameter("hole", 1.6)
    scales = Scales(ranges={"effort(tank)": (2.0, 5.0)})
    places = all_places(graph.finish(), scales)
    (place,) = (p for p in places if p.name == "outlet")
    return {one.words: one for one in UnknownRelation().propose(place)}


def test_what_a_valve_passes_may_be_a_factor_along_its_pressure():
    passes = sympy.Symbol("hole") * effort("opening") * sympy.sqrt(e)
    curves = curves_at_outlet(passes)
    law = curves["outlet changes with pressure"].law
    assert law.subs(effort("opening"), 0) == 0
    assert law.has(e)
    assert not law.has(f)


def test_a_law_that_nothing_leads_has_no_such_factor():
    passes = sympy.Symbol("hole") * sympy.sqrt(e)
    assert "outlet changes with pressure" not in curves_at_outlet(passes)
