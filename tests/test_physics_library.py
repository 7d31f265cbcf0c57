"""Every entry of the physics library: it fits in, starts at nothing, and dissipates."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pint
import pytest
import sympy
from numpy.typing import NDArray

from bondgraph import GY, TF, BondGraph, C, FinishedGraph, I, R, Se, Sf, derive
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.junction import JunctionPlace, junction_place
from bondgraph.physics.places.scales import Scales
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Sdirk2
from bondgraph.structure.domains import DOMAINS
from bondgraph.structure.edits import InsertElement
from bondgraph.structure.elements import (
    Compliance,
    FlowSource,
    Inertance,
    OneJunction,
    Resistance,
)
from bondgraph.structure.graph import Measurement
from bondgraph.structure.signals import Signal, e, effort, f, flow, p, q, signals_in, t
from bondgraph.structure.units import compatible

Array = NDArray[np.float64]

FRICTION = {
    "viscous_friction",
    "coulomb_friction",
    "load_dependent_friction",
    "stribeck_friction",
    "quadratic_drag",
    "leak",
    "square_root_orifice",
}
"""Words whose laws can only take power out."""


def slider() -> FinishedGraph:
    g = BondGraph("slider", domain="translation")
    g.one("carriage", Se("force"), I("mass"), C("spring"))
    g.measure("position", displacement="carriage")
    g.measure("speed", flow="carriage")
    known = (("mass", 2.0, "kg"), ("spring", 0.02, "m/N"))
    for name, value, unit in known:
        g.parameter(name, value, unit, std=0.0)
    return g.finish()


def geared_arm() -> FinishedGraph:
    g = BondGraph("geared arm", domain="rotation")
    g.one("motor", Se("torque"), I("rotor"))
    g.one("joint", I("arm"), C("twist"))
    g.join("motor", TF("gear"), "joint")
    g.measure("angle", displacement="joint")
    g.measure("speed", flow="motor")
    known = (
        ("rotor", 0.02, "kg*m^2"), ("arm", 0.5, "kg*m^2"),
        ("twist", 0.1, "rad/(N*m)"), ("gear", 4.0, "1"),
    )  # fmt: skip
    for name, value, unit in known:
        g.parameter(name, value, unit, std=0.0)
    return g.finish()


def dc_drive() -> FinishedGraph:
    g = BondGraph("DC drive", domain="electrical")
    g.one("winding", Se("voltage"), I("inductance"), R("resistance"))
    g.zero("rail", Sf("charger"), C("capacitor"))
    g.one("cable", R("line"))
    g.one("shaft", I("rotor"), domain="rotation")
    g.join("rail", "cable")
    g.join("cable", "winding")
    g.join("winding", GY("k_m"), "shaft")
    g.measure("current", flow="winding")
    g.measure("speed", flow="shaft")
    g.measure("rail_voltage", effort="rail")
    known = (
        ("inductance", 0.05, "H"), ("resistance", 1.0, "ohm"),
        ("capacitor", 0.3, "F"), ("line", 0.4, "ohm"), ("k_m", 0.3, "V*s/rad"),
        ("rotor", 0.02, "kg*m^2"),
    )  # fmt: skip
    for name, value, unit in known:
        g.parameter(name, value, unit, std=0.0)
    return g.finish()


def two_tanks() -> FinishedGraph:
    g = BondGraph("two tanks", domain="hydraulic")
    g.zero("upper", Sf("pump"), C("area_1"))
    g.one("pipe", R("laminar"))
    g.zero("lower", C("area_2"))
    g.join("upper", "pipe")
    g.join("pipe", "lower")
    g.measure("pressure_1", effort="upper")
    g.measure("pressure_2", effort="lower")
    for name in ("area_1", "area_2"):
        g.parameter(name, 0.5, "m^3/Pa", std=0.0)
    g.parameter("laminar", 2.0, "Pa*s/m^3", std=0.0)
    return g.finish()


def draining_tank() -> FinishedGraph:
    """A tank whose outlet, a resistance, is free to be fitted."""
    g = BondGraph("draining tank", domain="hydraulic")
    g.zero("tank", Sf("inflow"), C("area"), R("outlet"))
    g.measure("pressure", effort="tank")
    g.parameter("area", 0.5, "m^3/Pa", std=0.0)
    g.parameter("outlet", 2.0, "Pa*s/m^3")
    return g.finish()


MACHINES = {
    make.__name__: make()
    for make in (slider, geared_arm, dc_drive, two_tanks, draining_tank)
}
SAMPLES = 400


@cache
def numeric(graph: FinishedGraph) -> NumericModel:
    return compile_model(derive(graph))


def outputs(graph: FinishedGraph, values: Mapping[str, float] | None = None) -> Array:
    """Return the outputs under inputs that make everything move, from rest.

    `values` replaces some of the graph's parameter values.
    """
    model = numeric(graph)
    known = {**graph.parameters.values_by_name(), **(values or {})}
    time = 0.01 * np.arange(SAMPLES)
    phases = np.arange(1, len(model.input_names) + 1)
    u = 1.3 * np.sin(np.outer(time, 4.0 * phases) + 0.3 * phases)
    shot = shoot(
        model,
        Shots(time, u, np.zeros((SAMPLES, 1)), (0, SAMPLES)),
        parameters=np.array([known[n] for n in model.parameter_names]),
        initial=np.zeros((1, model.n_states)),
        directions=None,
        solver=Sdirk2(),
        hold=Hold.FIRST,
    )
    assert shot.completed.all()
    assert np.isfinite(shot.outputs).all()
    return shot.outputs


def scales_of(graph: FinishedGraph) -> Scales:
    """Return the sizes of the signals at every junction in the graph's simulation."""
    probes = []
    for junction in graph.junctions:
        one = isinstance(junction, OneJunction)
        common, carried = (flow, effort) if one else (effort, flow)
        probes.append((str(common(junction.name).name), common(junction.name)))
        largest = sympy.Max(
            *(abs(carried(b.name)) for b in graph.bonds_at(junction.name))
        )
        probes.append((str(carried(junction.name).name), largest))
    probed = replace(
        graph, measurements=tuple(Measurement(name, x, "1") for name, x in probes)
    )
    sizes = np.sqrt(np.mean(outputs(probed) ** 2, axis=0))
    return Scales(dict(zip((name for name, _ in probes), sizes.tolist(), strict=True)))


def junctions(graph: FinishedGraph, scales: Scales) -> list[JunctionPlace]:
    return [junction_place(graph, j.name, scales) for j in graph.junctions]


SCALES = {name: scales_of(graph) for name, graph in MACHINES.items()}
BASE = {name: outputs(graph) for name, graph in MACHINES.items()}
CASES = [
    (name, physics, hypothesis)
    for name, graph in MACHINES.items()
    for junction in graph.junctions
    for physics in LIBRARY
    for hypothesis in physics.propose(
        junction_place(graph, junction.name, SCALES[name])
    )
]
EDITED = [hypothesis.apply(MACHINES[name]) for name, _, hypothesis in CASES]


def cases(
    wanted: Callable[[Hypothesis], bool] = lambda _: True,
) -> pytest.MarkDecorator:
    """Run a test for every hypothesis, by its number."""
    chosen = [
        pytest.param(i, id=f"{name}-{hypothesis.element}-{i}")
        for i, (name, _, hypothesis) in enumerate(CASES)
        if wanted(hypothesis)
    ]
    return pytest.mark.parametrize("number", chosen)


def inserted(hypothesis: Hypothesis) -> bool:
    return isinstance(hypothesis.edit, InsertElement)


def words_at(graph: FinishedGraph) -> set[str]:
    """Return what the library proposes for a graph, at any place."""
    return {
        hypothesis.physics
        for junction in graph.junctions
        for physics in LIBRARY
        for hypothesis in physics.propose(
            junction_place(graph, junction.name, Scales())
        )
    }


def test_every_entry_proposes_something_somewhere():
    for physics in LIBRARY:
        proposed = [h for _, origin, h in CASES if origin is physics]
        assert proposed, type(physics).__name__
        assert {h.physics for h in proposed} == {physics.word}
        assert physics.reference


@cases()
def test_it_fits_into_the_graph_and_is_told_in_words(number):
    name, _, hypothesis = CASES[number]
    graph, edited = MACHINES[name], EDITED[number]
    assert edited.by_name.keys() == graph.by_name.keys() | {hypothesis.element}
    assert (hypothesis.element in graph.by_name) is not inserted(hypothesis)
    assert hypothesis.words.strip() == hypothesis.words != ""
    assert hypothesis.edit.describe()
    assert hypothesis.starts
    for start in hypothesis.starts:
        assert set(start) <= set(hypothesis.parameters)
        for parameter, value in start.items():
            low, high = edited.parameters[parameter].bounds
            assert low <= value <= high
    # The law is in port variables and in parameters of its own, and uses all of them.
    own = {s.name for s in hypothesis.law.free_symbols if not isinstance(s, Signal)}
    ports = {str(symbol) for symbol in (e, f, p, q, t)}
    assert own - ports == {p.name for p in hypothesis.edit.parameters}


@cases()
def test_it_simulates_at_every_start(number):
    hypothesis, edited = CASES[number][2], EDITED[number]
    # A friction that falls with speed has several answers where nothing has inertia.
    falls = hypothesis.physics == "stribeck_friction"
    several = falls and numeric(edited).n_unknowns > 0
    for start in hypothesis.starts[: 1 if several else None]:
        outputs(edited, start)


@cases(inserted)
def test_it_starts_at_nothing(number):
    name, _, hypothesis = CASES[number]
    start = dict(hypothesis.starts[0])
    if "coulomb_friction" in hypothesis.extends:
        # What extends a law may start at an optimum of that law, at the same place.
        start |= {n: 0.0 for n in start if n.startswith("coulomb")}
    change = np.abs(outputs(EDITED[number], start) - BASE[name]).max(axis=0)
    allowed = 1e-2 if hypothesis.physics == "added_inertia" else 1e-6
    assert (change <= allowed * np.abs(BASE[name]).max(axis=0)).all()


@cases()
def test_it_does_something_when_it_is_there(number):
    name, _, hypothesis = CASES[number]
    # A difference between directions is smaller than what differs.
    strong = {
        parameter: 0.05 if parameter.startswith("coulomb_difference") else 0.3
        for parameter in hypothesis.parameters
    }
    assert np.abs(outputs(EDITED[number], strong) - BASE[name]).max() > 1e-6


def test_a_friction_of_zero_is_harmless_beside_a_resistance():
    """Two R between two tanks: the one that may be zero must not be divided by."""
    name, _, hypothesis = next(
        case
        for case in CASES
        if (case[0], case[2].physics, case[2].place)
        == ("two_tanks", "viscous_friction", "pipe")
    )
    edited = hypothesis.apply(MACHINES[name])
    (strength,) = hypothesis.parameters
    assert outputs(edited, {strength: 0.0}) == pytest.approx(BASE[name], rel=1e-9)
    doubled = MACHINES[name].with_parameters({"laminar": 4.0})
    assert outputs(edited, {strength: 2.0}) == pytest.approx(outputs(doubled), rel=1e-9)


@cases(lambda hypothesis: hypothesis.physics in FRICTION)
def test_friction_never_gives_power(number):
    hypothesis, edited = CASES[number][2], EDITED[number]
    random = np.random.default_rng(8)
    port = f if f in hypothesis.law.free_symbols else e
    for start in hypothesis.starts:
        values = {**edited.parameters.values_by_name(), **start}
        law = hypothesis.law.xreplace(
            {sympy.Symbol(name, real=True): value for name, value in values.items()}
        )
        loads = signals_in(hypothesis.law)
        function = sympy.lambdify([port, *loads], law, "numpy")
        x = random.normal(size=200) * 10 ** random.uniform(-4, 1, 200)
        answer = function(x, *random.normal(size=(len(loads), 200))) + 0 * x
        assert np.isfinite(answer).all()
        assert (answer * x >= 0.0).all()
        if start not in hypothesis.silent_starts:
            assert float(function(1.0, *range(1, len(loads) + 1))) > 0.0


@cases()
def test_units_of_new_parameters_fit_the_port(number):
    """The law has the unit of an effort (or flow) by the units of what is in it."""
    hypothesis, edited = CASES[number][2], EDITED[number]
    domain = edited.domain_at(hypothesis.place)
    assert domain.checked
    element = edited.node(hypothesis.element)
    if isinstance(element, Inertance):
        unit = edited.parameters[hypothesis.parameters[0]].unit
        assert compatible(unit, f"({domain.momentum_unit})/({domain.flow_unit})")
        return
    flowing = isinstance(element, FlowSource) or e in hypothesis.law.free_symbols
    expected = domain.flow_unit if flowing else domain.effort_unit
    port = {e: domain.effort_unit, f: domain.flow_unit, q: domain.displacement_unit}
    before, after = _in_other_units(hypothesis, edited, port)
    assert after == pytest.approx(before * _factor(expected), rel=1e-9)


# Metres, kilograms, seconds and amperes made smaller by these factors. A law keeps its
# meaning in any units, so its value must change as its own unit says.
FACTORS = {"[length]": 3.0, "[mass]": 7.0, "[time]": 2.0, "[current]": 5.0}
REGISTRY: pint.UnitRegistry = pint.UnitRegistry()


@cache
def _factor(unit: str) -> float:
    """Return how much larger the number of a quantity gets in the smaller units."""
    dimensions = REGISTRY.Quantity(1.0, unit.replace("^", "**")).dimensionality
    return math.prod(
        FACTORS[name] ** float(power) for name, power in dimensions.items()
    )


def _in_other_units(hypothesis, edited, port):
    """Return the law's value at a point, and at the same point in smaller units."""
    random = np.random.default_rng(3)
    here, there = {}, {}
    for symbol in sorted(hypothesis.law.free_symbols, key=str):
        if isinstance(symbol, Signal):
            unit = edited.domain_at(symbol.place).unit(symbol.quantity)
        elif symbol in port:
            unit = port[symbol]
        else:
            unit = edited.parameters[symbol.name].unit
        value = random.uniform(0.2, 0.9)
        here[symbol], there[symbol] = value, value * _factor(unit)
    return float(hypothesis.law.xreplace(here)), float(hypothesis.law.xreplace(there))


@cases(inserted)
def test_a_second_one_at_the_same_place_gets_a_name_of_its_own(number):
    name, physics, hypothesis = CASES[number]
    edited = EDITED[number]
    for other in physics.propose(
        junction_place(edited, hypothesis.place, SCALES[name])
    ):
        if inserted(other):
            assert other.element not in edited.by_name
            assert not set(other.parameters) & set(edited.parameters)
            assert len(other.apply(edited).nodes) == len(edited.nodes) + 1


LINEAR = {
    "viscous_friction": (Resistance, R),
    "leak": (Resistance, R),
    "spring": (Compliance, C),
    "added_inertia": (Inertance, I),
}


@pytest.mark.parametrize("word", LINEAR)
def test_a_linear_element_with_a_free_value_is_not_proposed_again(word):
    kind, element = LINEAR[word]
    domain = "rotation" if word != "leak" else "hydraulic"

    def words(std):
        g = BondGraph("axle", domain=domain)
        junction = g.zero if word == "leak" else g.one
        source = Sf("flow_in") if word == "leak" else Se("torque")
        junction("axle", source, I("J") if word != "leak" else C("J"), element("own"))
        g.measure("theta", effort="axle") if word == "leak" else g.measure(
            "theta", displacement="axle"
        )
        g.parameter("own", 1.0, _linear_unit(kind, domain), std=std)
        g.parameter("J", 1.0, _linear_unit(I if word != "leak" else C, domain), std=0.0)
        graph = g.finish()
        place = junction_place(graph, "axle", Scales())
        assert place.has_free_linear(kind) is (std is None)
        return words_at(graph)

    assert word not in words(std=None)
    assert word in words(std=0.0)
    assert word in words(std=0.1)


def _linear_unit(kind, domain_name):
    domain = DOMAINS[domain_name]
    above, below = {
        R: (domain.effort_unit, domain.flow_unit),
        I: (domain.momentum_unit, domain.flow_unit),
        C: (domain.displacement_unit, domain.effort_unit),
    }[kind]
    return f"({above})/({below})"


def biased(expression, std=None):
    g = BondGraph("biased", domain="translation")
    names = [s.name for s in sympy.sympify(expression).free_symbols]
    offset = Se("offset", value=expression)
    g.one("cart", Se("force"), I("m"), offset)
    g.measure("x", displacement="cart")
    g.parameter("m", 1.0, "kg")
    for name in names:
        if name != "t":
            g.parameter(name, 0.5, "N", std=std)
    return g.finish()


def test_a_fitted_constant_source_is_a_bias_already():
    bias = sympy.Symbol("bias")

    def state(graph):
        return junction_place(graph, "cart", Scales()).has_free_bias, words_at(graph)

    free, words = state(biased(bias))
    assert free
    assert not words & {"constant_bias", "direction_dependent_friction"}
    for graph in (biased(bias, std=0.0), biased(sympy.Integer(3))):
        free, words = state(graph)
        assert not free
        assert {"constant_bias", "direction_dependent_friction"} <= words
    assert state(biased(bias, std=0.1))[0]
    assert not junction_place(slider(), "carriage", Scales()).has_free_bias


def test_a_bias_that_was_inserted_is_not_proposed_twice():
    for name, physics, hypothesis in CASES:
        if hypothesis.physics == "constant_bias":
            edited = hypothesis.apply(MACHINES[name])
            place = junction_place(edited, hypothesis.place, SCALES[name])
            assert place.has_free_bias
            assert not list(physics.propose(place))


def test_laws_of_position_need_a_position_that_is_known():
    def words(*, measured):
        g = BondGraph("free cart", domain="rotation")
        g.one("shaft", Se("torque"), I("J"))
        g.measure("w", flow="shaft")
        if measured:
            g.measure("angle", displacement="shaft")
        g.parameter("J", 1.0, "kg*m^2")
        return words_at(g.finish())

    gained = words(measured=True) - words(measured=False)
    assert gained == {"gravity", "spring", "hardening_spring"}


def test_typical_sizes_that_are_unknown_or_zero_do_not_divide_by_zero():
    for graph in MACHINES.values():
        zero = Scales({f"flow({j.name})": 0.0 for j in graph.junctions})
        for junction in graph.junctions:
            for physics in LIBRARY:
                for hypothesis in physics.propose(
                    junction_place(graph, junction.name, zero)
                ):
                    numbers = [x for s in hypothesis.starts for x in s.values()]
                    exact = [p.value for p in hypothesis.edit.parameters if p.exact]
                    assert np.isfinite([*numbers, *exact]).all()
                    assert all(value > 0.0 for value in exact)
