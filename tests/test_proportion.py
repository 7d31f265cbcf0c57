"""A law may be sure while its size is open, where the model leaves a scale open."""

import numpy as np
import pytest
import sympy

from bondgraph import (
    GY,
    BondGraph,
    C,
    FitSettings,
    I,
    R,
    Recording,
    Se,
    bind_to,
    e,
    f,
)
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.evidence.proportion import known_in_proportion
from bondgraph.diagnosis.records import Verdict
from bondgraph.fitting.estimate import fit_model
from bondgraph.simulation.solvers import Hold
from bondgraph.structure.signals import parameter_symbol

TIME = 0.01 * np.arange(600)
HELD = FitSettings(hold=Hold.ZERO)
RESISTANCE, CONSTANT, INERTIA, BEARING, DRY = 2.0, 0.05, 1.2e-4, 1e-4, 0.02


def speed(voltage):
    """Return the speed of a motor with dry friction, which stops where it may."""
    fine, w = 1e-3, 0.0
    found = np.empty(TIME.size)
    for k, u in enumerate(voltage):
        found[k] = w
        for _ in range(10):
            torque = CONSTANT * (u - CONSTANT * w) / RESISTANCE - BEARING * w
            moved, rub = w + fine * torque / INERTIA, fine * DRY / INERTIA
            w = 0.0 if abs(moved) <= rub else moved - np.sign(moved) * rub
    return found


def motor(*more, exact=False, loosely=False):
    graph = BondGraph("motor", domain="rotation")
    graph.one("winding", Se("voltage"), R("resistance"), domain="electrical")
    graph.one("shaft", I("inertia"), R("bearing"), *more)
    graph.join("winding", GY("constant"), "shaft")
    graph.measure("speed", flow="shaft")
    known = {"std": 0.0}
    graph.parameter("resistance", RESISTANCE, "ohm", **(known if exact else {}))
    graph.parameter(
        "constant", CONSTANT, "N*m/A", **(known if exact or loosely else {})
    )
    stated = {"std": 1e-4} if loosely else {"bounds": (1e-7, 1)}
    graph.parameter("inertia", 1e-4, "kg*m^2", **stated)
    graph.parameter("bearing", 1.2e-4, "N*m*s/rad", bounds=(0, 1))
    for one in more:
        unit = "N*m" if one.law is not None else "N*m*s/rad"
        graph.parameter(one.name, 1e-5, unit, bounds=(0, 1))
    return graph.finish()


def runs(graph):
    made = []
    for seed in (1, 2):
        random = np.random.default_rng(seed)
        voltage = np.repeat(random.uniform(-12, 12, 15), 40)
        read = speed(voltage) + 0.3 * random.standard_normal(TIME.size)
        channels = {"voltage": (voltage, "V"), "speed": (read, "rad/s")}
        made.append(bind_to(graph, Recording.from_arrays(f"{seed}", TIME, channels)))
    return made


def proportion(more, **stated):
    base, graph = motor(**stated), motor(more, **stated)
    models = (fit_model(one, runs(one), HELD) for one in (graph, base))
    return known_in_proportion(*models)


def rubs(name):
    return R(name, law=parameter_symbol(name) * sympy.tanh(10 * f))


def test_a_number_is_known_in_proportion_where_the_model_leaves_a_scale_open():
    found = proportion(rubs("dry"))
    assert found.keys() == {"resistance", "constant", "inertia", "bearing", "dry"}
    assert 0.0 < found["dry"] < 0.1 * DRY


def test_so_it_is_where_the_model_leaves_a_scale_nearly_open():
    found = proportion(rubs("dry"), loosely=True)
    assert found.keys() == {"resistance", "inertia", "bearing", "dry"}
    assert 0.0 < found["dry"] < 0.1 * DRY


def test_nothing_is_where_the_model_leaves_none_open():
    assert proportion(rubs("dry"), exact=True) == {}


@pytest.mark.parametrize("exact", [False, True])
def test_nothing_is_where_only_a_sum_shows(exact):
    assert proportion(R("second"), exact=exact) == {}


def tank(hole, *, known=False):
    """Return a tank that empties through a hole."""
    graph = BondGraph("tank", domain="hydraulic")
    graph.zero("water", C("area"), hole)
    graph.measure("level", effort="water")
    graph.parameter("area", 0.7, "m^3/Pa", **({"std": 0.0} if known else {}))
    if hole.law is None:
        graph.parameter("hole", 9.0, "Pa*s/m^3")
    else:
        for symbol in sorted(hole.law.free_symbols - {e}, key=str):
            graph.parameter(symbol.name, 1.2, bounds=(1e-3, 1e3))
    return graph.finish()


def emptied(hole, **stated):
    """Return what is known in proportion where a hole is no longer a linear one."""
    sunk = (3.0 - 0.1 * np.linspace(0.0, 20.0, 400)) ** 2
    read = sunk + 1e-3 * np.random.default_rng(4).standard_normal(sunk.size)
    recording = Recording.from_arrays(
        "run", np.linspace(0.0, 20.0, 400), {"level": (read, "Pa")}
    )
    graphs = (tank(R("hole", law=hole), **stated), tank(R("hole"), **stated))
    return known_in_proportion(
        *(fit_model(g, [bind_to(g, recording)], HELD) for g in graphs)
    )


def test_a_law_that_replaces_a_number_is_known_in_the_same_proportion():
    through, twice = sympy.Symbol("through"), sympy.Symbol("twice")
    found = emptied(through * sympy.sqrt(e))
    assert found.keys() == {"area", "through"}
    assert 0.0 < found["through"] < 0.1
    assert emptied(through * sympy.sqrt(e), known=True) == {}
    # Two numbers of which only the product shows are more open than the model was.
    assert emptied(through * twice * sympy.sqrt(e)) == {}


def test_dry_friction_is_sure_where_no_torque_is_known():
    words = ("coulomb_friction", "spring", "lag", "quadratic_drag")
    library = tuple(p for p in Options().library if p.word in words)
    graph = motor()
    training, held_out = runs(graph)
    options = Options(library=library, settings=HELD)
    answer = diagnose(graph, [training], held_out=[held_out], options=options)
    assert answer.verdict is Verdict.PHYSICS_MISSING, answer.statement
    (finding,) = answer.findings
    assert (finding.physics, finding.place) == ("coulomb_friction", "shaft")
    assert finding.in_proportion == ("coulomb_shaft",)
    assert "in proportion to the model's own numbers only" in finding.statement
    assert finding.probability > 0.7
