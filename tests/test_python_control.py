"""The nonlinear python-control twin against our own simulation and linearisation."""

import warnings

import numpy as np
import pytest
import sympy
from catalogue import CASES

from bondgraph import (
    TF,
    BondGraph,
    C,
    FinishedGraph,
    I,
    R,
    Se,
    Sf,
    derive,
    displacement,
    e,
    f,
)
from bondgraph.errors import EquationError
from bondgraph.numeric.model import compile_model
from bondgraph.numeric.nonlinear_io import to_nonlinear_io
from bondgraph.numeric.state_space import state_space
from bondgraph.numeric.steady_state import steady_state
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Sdirk3

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import control


def crank() -> FinishedGraph:
    """A crank that moves a mass: dependent storage, moving modulus, gravity."""
    graph = BondGraph("crank. and slider")
    length, m, g = sympy.symbols("l m g")
    graph.one("crank", Se("torque"), I("j"), R("b", law=sympy.Symbol("b") * f))
    graph.one("slider", I("m"), Se("weight", value=-m * g))
    arm = TF("arm", law=length * sympy.cos(displacement("crank")))
    graph.join("slider", arm, "crank")
    graph.measure("angle", displacement="crank")
    graph.measure("push", effort="m")
    values = {"l": 0.5, "m": 2.0, "g": 9.81, "j": 0.3, "b": 0.8}
    return graph.finish().with_parameters(values)


def diode() -> FinishedGraph:
    """A diode in a loop with a resistor: a nonlinear algebraic unknown."""
    graph = BondGraph("diode")
    i0, vt = sympy.symbols("i0 vt")
    law = i0 * (sympy.exp(e / vt) - 1)
    graph.one("loop", Se("u"), R("diode", law=law), R("r"), C("c"))
    graph.measure("v", effort="c")
    values = {"i0": 1e-3, "vt": 0.2, "r": 2.0, "c": 0.5}
    return graph.finish().with_parameters(values)


@pytest.mark.parametrize("make", [crank, diode], ids=lambda m: m.__name__)
def test_python_control_simulates_what_we_simulate(make) -> None:
    graph = make()
    system = to_nonlinear_io(graph)
    model = compile_model(derive(graph))
    time = np.linspace(0.0, 1.0, 201)
    u = np.sin(3.0 * time)
    x0 = np.full(model.n_states, 0.1)
    ours = shoot(
        model,
        Shots(time, u[:, None], np.zeros((201, len(model.output_names))), (0, 201)),
        parameters=np.array(list(graph.parameters.values_by_name().values())),
        initial=x0[None, :],
        directions=None,
        solver=Sdirk3(substeps=4),
        hold=Hold.FIRST,
    )
    theirs = control.input_output_response(
        system, time, u, x0, solve_ivp_kwargs={"rtol": 1e-9, "atol": 1e-11}
    )
    scale = np.abs(ours.outputs).max(axis=0)
    found = np.reshape(theirs.outputs, (len(scale), 201)).T
    assert (np.abs(found - ours.outputs).max(axis=0) < 1e-4 * scale).all()


def test_names_and_parameters_are_kept() -> None:
    graph = crank()
    system = to_nonlinear_io(graph)
    assert system.input_labels == ["torque"]
    assert system.output_labels == ["angle", "push"]
    assert system.state_labels == ["p_j", "q_crank"]
    assert system.name == "crank_ and slider"
    assert system.params == graph.parameters.values_by_name()
    time = np.linspace(0.0, 0.1, 11)
    light, heavy = (
        control.input_output_response(system, time, 0 * time, params={"m": mass})
        for mass in (1.0, 4.0)
    )
    assert abs(heavy.outputs[0, -1]) > 1.2 * abs(light.outputs[0, -1])


def test_its_linearisation_is_our_linear_system() -> None:
    graph = crank()
    at = steady_state(graph, inputs={"torque": 6.0}, guess={"q_crank": 0.5})
    ours = state_space(graph, at=at)
    x = [float(at[name]) for name in ours.states]
    theirs = control.linearize(to_nonlinear_io(graph), x, [6.0])
    assert np.asarray(theirs.A) == pytest.approx(ours.A, rel=1e-4, abs=1e-4)
    assert np.asarray(theirs.C) == pytest.approx(ours.C, rel=1e-4, abs=1e-4)


@pytest.mark.parametrize("case", [c for c in CASES if c.linear], ids=lambda c: c.name)
def test_linear_machines_have_the_matrices_of_their_state_space(case) -> None:
    graph = case.graph()
    values = {n: 0.8 + 0.1 * i for i, n in enumerate(graph.parameters)}
    graph = graph.with_parameters(values)
    model = compile_model(derive(graph))
    if model.needs_input_rates:
        with pytest.raises(EquationError, match="needs the rate of an input"):
            to_nonlinear_io(graph)
        return
    system, ours = to_nonlinear_io(graph), state_space(graph)
    draw = np.random.default_rng(2)
    x, u = draw.normal(size=len(ours.states)), draw.normal(size=len(ours.inputs))
    params = system.params
    if len(x):
        assert system.updfcn(0.0, x, u, params) == pytest.approx(
            ours.A @ x + ours.B @ u
        )
    assert system.outfcn(0.0, x, u, params) == pytest.approx(ours.C @ x + ours.D @ u)


def test_a_source_that_sets_a_storage_is_refused() -> None:
    graph = BondGraph("forced")
    graph.one("mass", Sf("v"), I("m"), R("b"))
    graph.measure("force", effort="v")
    finished = graph.finish().with_parameters({"m": 1.0, "b": 1.0})
    with pytest.raises(EquationError, match="needs the rate of an input"):
        to_nonlinear_io(finished)
