"""Edits with split bonds, wrapped inputs and states: they print, draw and compose."""

import pickle

import numpy as np
import pytest
import sympy
from physics_machines import MACHINES, inputs, numeric, outputs
from proposed import PROPOSED

from bondgraph import BondGraph, C, I, R, Se, derive, draw_svg, to_python
from bondgraph.errors import StructureError
from bondgraph.physics.dynamics import delaying, lagging
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.structure.edits import (
    ConnectJunctions,
    InsertElement,
    LoosenBond,
    ObstructBond,
    ReplaceMeasurement,
    SeveralEdits,
    SignalState,
    SwapInputs,
    SwapMeasurements,
    WrapInput,
)
from bondgraph.structure.graph import Bond
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import displacement, effort, f, flow, q

K, D = sympy.symbols("k d", real=True)
PAIR = (Parameter(name="k", value=40.0), Parameter(name="d", value=0.2))
SPRING, DAMPER = C("give_spring", law=K * q), R("give_damper", law=D * f)


def one_of_each_edit():
    """Return a hypothesis of the library for every entry and kind of edit."""
    chosen = {}
    for name, _, physics, hypothesis in PROPOSED:
        key = type(physics), type(hypothesis.edit)
        chosen.setdefault(key, (name, hypothesis))
    return list(chosen.values())


EACH = one_of_each_edit()
EACH_ID = [f"{n}-{h.physics}-{h.place}-{type(h.edit).__name__}" for n, h in EACH]


@pytest.mark.parametrize(("name", "hypothesis"), EACH, ids=EACH_ID)
def test_the_model_with_it_is_python_text_that_makes_it_again(name, hypothesis):
    edited = hypothesis.apply(MACHINES[name])
    namespace = {}
    text = to_python(edited)
    exec(text, namespace)
    assert namespace["model"]().finish() == edited
    assert "graph.bond(" not in text


@pytest.mark.parametrize(("name", "hypothesis"), EACH, ids=EACH_ID)
def test_it_survives_pickling_and_goes_on(name, hypothesis):
    again = pickle.loads(pickle.dumps(hypothesis))
    edited = hypothesis.apply(MACHINES[name])
    assert again == hypothesis
    assert again.apply(MACHINES[name]) == edited
    # What is derived from a graph is kept by its value.
    assert hash(again.apply(MACHINES[name])) == hash(edited)
    # The next round of a search starts from here.
    assert all_places(edited, Scales())


@pytest.mark.parametrize(
    "word", ["compliance", "lag", "delay", "hysteresis", "saturation", "overflow"]
)
def test_it_can_be_drawn(word):
    name, hypothesis = next((n, h) for n, h in EACH if h.physics == word)
    svg = draw_svg(hypothesis.apply(MACHINES[name]))
    assert hypothesis.element in svg


def shaft_on_a_spring():
    """Two inertias and a spring between, written by hand: what a split must give."""
    g = BondGraph("by hand", domain="rotation")
    g.one("shaft", Se("torque"), I("first"))
    g.zero("between")
    g.one("twist", SPRING, DAMPER)
    g.one("far", I("second"))
    g.join("shaft", "between")
    g.join("between", "far")
    g.join("between", "twist")
    g.measure("angle", displacement="shaft")
    for name in ("first", "second"):
        g.parameter(name, 0.3, "kg*m^2", std=0.0)
    for parameter in PAIR:
        g.parameter(parameter.name, parameter.value)
    return g.finish()


def rigid_shaft():
    g = BondGraph("rigid", domain="rotation")
    g.one("shaft", Se("torque"), I("first"), I("second"))
    g.measure("angle", displacement="shaft")
    for name in ("first", "second"):
        g.parameter(name, 0.3, "kg*m^2", std=0.0)
    return g.finish()


def test_a_loosened_bond_is_the_model_written_by_hand():
    edit = LoosenBond(Bond("shaft", "second"), "give", (SPRING, DAMPER), PAIR)
    edited = edit.apply(rigid_shaft())
    by_hand = shaft_on_a_spring()
    assert outputs(edited) == pytest.approx(outputs(by_hand), rel=1e-9)
    assert len(derive(edited).states) == len(derive(by_hand).states)


def test_an_obstructed_bond_is_a_resistance_in_series():
    def circuit(*, by_hand):
        g = BondGraph("ESR", domain="electrical")
        g.one("wire", Se("mains"), R("line"))
        if by_hand:
            g.zero("node")
            g.one("branch", C("store"), R("loss", law=D * f))
            g.join("wire", "node")
            g.join("node", "branch")
        else:
            g.zero("node", C("store"))
            g.join("wire", "node")
        g.measure("current", flow="wire")
        g.parameter("line", 1.0, "ohm")
        g.parameter("store", 0.3, "F")
        if by_hand:
            g.parameter("d", 0.2)
        return g.finish()

    loss = R("loss", law=D * f)
    edit = ObstructBond(Bond("node", "store"), "branch", (loss,), PAIR[1:])
    edited = edit.apply(circuit(by_hand=False))
    assert outputs(edited) == pytest.approx(outputs(circuit(by_hand=True)), rel=1e-9)


def test_connected_1_junctions_are_tied_by_what_sits_between():
    g = BondGraph("two wheels", domain="rotation")
    g.one("shaft", Se("torque"), I("first"))
    g.one("far", I("second"), Se("brake"))
    g.measure("angle", displacement="shaft")
    for name in ("first", "second"):
        g.parameter(name, 0.3, "kg*m^2", std=0.0)
    edit = ConnectJunctions("shaft", "far", "give", (SPRING, DAMPER), PAIR)
    edited = edit.apply(g.finish())
    u = inputs(edited)
    u[:, 1] = 0.0
    tied = outputs(edited, u=u)
    assert tied == pytest.approx(outputs(shaft_on_a_spring(), u=u[:, :1]), rel=1e-9)


def test_a_law_that_read_a_split_bond_reads_its_half():
    g = BondGraph("loaded", domain="rotation")
    g.one("shaft", Se("torque"), I("first"), I("second"))
    g.one("contact", R("rubbing", law=D * f * sympy.Abs(effort("shaft>second"))))
    g.join("shaft", "contact")
    g.measure("load", effort="shaft>second")
    for name in ("first", "second"):
        g.parameter(name, 0.3, "kg*m^2", std=0.0)
    g.parameter("d", 0.1, "s/rad")
    spring = C("give", law=sympy.Symbol("s", real=True) * q)
    edit = LoosenBond(
        Bond("shaft", "second"), "split", (spring,), (Parameter(name="s", value=9.0),)
    )
    edited = edit.apply(g.finish())
    half = effort("split_split>second")
    assert edited.measurements[0].expression == half
    assert edited.node("rubbing").law.has(half)


def test_wrapping_an_input_twice_composes_and_keeps_the_order_of_inputs():
    graph = MACHINES["dc_drive"]
    offset, scale = sympy.symbols("offset scale", real=True)
    voltage = effort("voltage")
    first = WrapInput(
        "voltage",
        voltage + offset,
        "shifted",
        (Parameter(name="offset", value=0.3, unit="V"),),
    )
    second = WrapInput(
        "voltage", scale * voltage, "scaled", (Parameter(name="scale", value=0.5),)
    )
    edited = SeveralEdits((first, second)).apply(graph)
    names = [source.name for source in graph.inputs]
    assert [source.name for source in edited.inputs] == names
    assert list(numeric(edited).input_names) == names
    u = inputs(graph)
    expected = u.copy()
    expected[:, 0] = 0.5 * u[:, 0] + 0.3
    assert outputs(edited, u=u) == pytest.approx(outputs(graph, u=expected), rel=1e-9)


def test_what_read_an_input_reads_what_is_applied():
    g = BondGraph("read", domain="electrical")
    g.one("wire", Se("mains"), R("line"), I("coil"))
    g.measure("power", effort("mains") * flow("wire"), unit="W")
    g.parameter("line", 1.0, "ohm")
    g.parameter("coil", 0.1, "H")
    wrapped = WrapInput("mains", 2 * effort("mains"), "amplified").apply(g.finish())
    assert wrapped.measurements[0].expression == effort("amplified") * flow("wire")


def response(states, value, frequency):
    """Return the gain and phase of signals at one frequency (rad/s), T = 1 s."""
    names = [state.value for state in states]
    u, time = effort("u"), sympy.Symbol("T", real=True)
    rates = sympy.Matrix([state.rate.subs(time, 1) for state in states])
    a = np.array(rates.jacobian(names), dtype=float)
    b = np.array(rates.diff(u), dtype=float)
    c = np.array(sympy.Matrix([value]).jacobian(names), dtype=float)
    return (c @ np.linalg.solve(1j * frequency * np.eye(len(names)) - a, b))[0, 0]


@pytest.mark.parametrize(
    ("reach", "phase", "gain"), [(2.0, 0.003, 0.007), (3.0, 0.035, 0.054)]
)
def test_a_delay_is_as_exact_as_it_says(reach, phase, gain):
    states, value = delaying("late", effort("u"), sympy.Symbol("T", real=True))
    for frequency in np.linspace(0.05, reach, 40):
        got = response(states, value, frequency)
        assert abs(abs(got) - 1.0) <= gain
        assert abs(np.angle(got * np.exp(1j * frequency))) <= phase


def test_a_lag_is_a_first_order_low_pass():
    state = lagging("slow", effort("u"), sympy.Symbol("T", real=True))
    for frequency in (0.1, 1.0, 10.0):
        got = response((state,), state.value, frequency)
        assert got == pytest.approx(1.0 / (1.0 + 1j * frequency), rel=1e-12)


def test_refusals_name_what_is_wrong():
    graph = MACHINES["slider"]
    with pytest.raises(StructureError, match="not a junction"):
        InsertElement("mass", R("r", law=D * f), PAIR[1:]).apply(graph)
    with pytest.raises(StructureError, match="no input 'nothing'"):
        WrapInput("nothing", effort("force"), "applied").apply(graph)
    with pytest.raises(StructureError, match="no bond"):
        LoosenBond(Bond("mass", "spring"), "x", (SPRING,), PAIR[:1]).apply(graph)
    with pytest.raises(StructureError, match="not junctions of one kind"):
        ConnectJunctions("first", "coupling", "x", (SPRING,), PAIR[:1]).apply(
            MACHINES["two_masses"]
        )


def test_sensors_are_swapped_with_the_parameters_that_only_one_of_them_reads():
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("mass"))
    g.parameter("zero", 0.1, "m/s")
    g.measure("first", flow("cart") + sympy.Symbol("zero"), unit="m/s")
    g.measure("second", flow("cart"), unit="m/s")
    graph = g.finish()
    swapped = SwapMeasurements("first", "second").apply(graph)
    read = {m.name: m.expression for m in graph.measurements}
    now = {m.name: m.expression for m in swapped.measurements}
    assert now == {"first": read["second"], "second": read["first"]}
    assert swapped.parameters == graph.parameters
    with pytest.raises(StructureError, match="no measurement 'third'"):
        SwapMeasurements("first", "third").apply(graph)


def test_swapped_inputs_drive_each_the_other_place_and_keep_their_order():
    graph = MACHINES["heaters"]
    swapped = SwapInputs("heater1", "heater2").apply(graph)
    assert [s.name for s in swapped.inputs] == [s.name for s in graph.inputs]
    assert Bond("heater2", "block1") in swapped.bonds
    assert Bond("heater1", "block2") in swapped.bonds
    again = SwapInputs("heater1", "heater2").apply(swapped)
    assert set(again.bonds) == set(graph.bonds)
    with pytest.raises(StructureError, match="no input 'block1'"):
        SwapInputs("heater1", "block1").apply(graph)


def test_a_state_of_a_signal_takes_no_power():
    """The machine moves as before, whatever integrates its signals."""
    graph = MACHINES["slider"]
    state = SignalState("way", flow("carriage") ** 2)
    edit = ReplaceMeasurement(
        "position", displacement("carriage") + 0 * state.value, (), (state,)
    )
    assert outputs(edit.apply(graph)) == pytest.approx(outputs(graph), rel=1e-9)
