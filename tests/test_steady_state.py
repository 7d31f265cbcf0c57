"""Steady states against hand-derived ones, and what is said where there is none."""

import numpy as np
import pytest
import sympy
from catalogue import CASES, agree, expression

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
    linearise,
    q,
)
from bondgraph.equations.steady_state import SteadyState, SteadyStatus
from bondgraph.errors import EquationError, ParameterError
from bondgraph.numeric.jacobian import point, residual
from bondgraph.numeric.model import compile_model
from bondgraph.numeric.state_space import state_space
from bondgraph.numeric.steady_state import steady_state


def named(name: str) -> FinishedGraph:
    return next(case for case in CASES if case.name == name).graph()


def test_a_linear_machine_is_solved_in_symbols() -> None:
    found = steady_state(named("dc_motor"), inputs={"u": sympy.Symbol("u0")})
    assert found.status is SteadyStatus.FOUND
    for state, text in {
        "p_la": "la*b*u0/(ra*b + k**2)",
        "p_j": "j*k*u0/(ra*b + k**2)",
    }.items():
        assert agree(found[state], expression(text))


def test_a_constant_source_shifts_the_rest_position() -> None:
    graph = BondGraph("hanging")
    m, g = sympy.symbols("m g")
    graph.one("mass", Se("weight", value=-m * g), I("m"), C("c"), R("b"))
    graph.measure("x", displacement="mass")
    found = steady_state(graph.finish())
    assert agree(found["q_c"], expression("-m*g*c"))
    assert found["p_m"] == 0


def test_algebraic_unknowns_have_their_values_too() -> None:
    found = steady_state(named("resistive_loop_with_c"), inputs={"u": 1})
    assert agree(found["q_c"], expression("c*r2/(r1 + r2)"))
    (unknown,) = derive(named("resistive_loop_with_c")).unknowns
    # At rest nothing flows through r3: the loop is the divider of r1 and r2.
    flow = expression("1/(r1 + r2)")
    known = {"e_r1": "r1", "f_r1": "1", "e_r2": "r2"}[unknown.name]
    assert agree(found[unknown.name], expression(known) * flow)


def test_a_free_integrator_is_named() -> None:
    resting = steady_state(named("lowerleg"))
    assert resting.status is SteadyStatus.FAMILY
    assert resting.free == ("q_joint",)
    held = steady_state(named("lowerleg"), hold={"q_joint": 0.25})
    assert held["q_joint"] == 0.25
    turning = steady_state(named("lowerleg"), inputs={"torque": 2})
    assert turning.status is SteadyStatus.MOVING
    assert agree(turning.growth["q_joint"], expression("2*kg*kw/c"))


def test_a_free_rotor_keeps_any_speed_and_no_torque() -> None:
    drive = named("two_mass_drive")
    resting = steady_state(drive)
    assert resting.status is SteadyStatus.FAMILY
    assert len(resting.free) == 1
    assert resting.free[0] in ("p_j1", "p_j2")
    chosen = steady_state(drive, guess={resting.free[0]: 0.5})
    assert chosen[resting.free[0]] == 0.5
    assert agree(chosen["p_j1"] / chosen["p_j2"], expression("j1/j2"))
    spinning = steady_state(drive, hold={"p_j2": sympy.Symbol("j2")})
    assert agree(spinning["p_j1"], expression("j1"))
    driven = steady_state(drive, inputs={"torque": 1})
    assert driven.status is SteadyStatus.NOT_FOUND
    assert "d(p_j1)/dt + d(p_j2)/dt does not vanish" in driven.reason
    with pytest.raises(EquationError, match="does not vanish"):
        linearise(derive(drive), driven)
    with pytest.raises(EquationError, match="no steady state"):
        state_space(
            drive.with_parameters(dict.fromkeys(drive.parameters, 1.0)), at=driven
        )


def pendulum() -> FinishedGraph:
    graph = BondGraph("pendulum")
    w = sympy.Symbol("w")
    weight = Se("weight", value=-w * sympy.sin(displacement("joint")))
    graph.one("joint", Se("torque"), I("j"), R("b"), weight)
    graph.measure("theta", displacement="joint")
    finished = graph.finish()
    return finished.with_parameters({"w": 3.0, "j": 0.5, "b": 0.1})


def test_a_pendulum_rests_where_the_torque_balances_it() -> None:
    found = steady_state(pendulum(), inputs={"torque": 1.5})
    assert found.status is SteadyStatus.FOUND
    assert float(found["q_joint"]) == pytest.approx(np.pi / 6)
    upper = steady_state(pendulum(), inputs={"torque": 1.5}, guess={"q_joint": 2.5})
    assert float(upper["q_joint"]) == pytest.approx(np.pi - np.pi / 6)
    system = state_space(pendulum(), at=found)
    # θ̈ j + b θ̇ + w cos(θ0) θ = torque
    expected = np.roots([0.5, 0.1, 3.0 * np.cos(np.pi / 6)])
    assert np.sort_complex(system.poles()) == pytest.approx(np.sort_complex(expected))
    symbolic = linearise(derive(pendulum()), found)
    poles = symbolic.transfer_function().poles({"w": 3.0, "j": 0.5, "b": 0.1})
    assert np.sort_complex(poles) == pytest.approx(np.sort_complex(expected))


def test_too_much_torque_leaves_no_rest() -> None:
    found = steady_state(pendulum(), inputs={"torque": 4.0})
    assert found.status is SteadyStatus.NOT_FOUND
    assert "stays at" in found.reason


def test_the_torque_that_holds_a_pendulum_is_found() -> None:
    found = steady_state(
        pendulum(), inputs={"torque": None}, hold={"q_joint": np.pi / 2}
    )
    # Affine in what is sought, so the answer is a formula although sin is in it.
    assert agree(found["torque"], expression("w"))
    assert found["p_j"] == 0


def test_a_double_root_is_one_point_and_not_a_family() -> None:
    found = steady_state(
        pendulum(), inputs={"torque": 3.0}, guess={"q_joint": np.pi / 2}
    )
    assert found.status is SteadyStatus.FOUND


def test_starts_where_the_slope_is_zero_or_infinite_are_overcome() -> None:
    values = {"m": 2.0, "b": 0.5}
    drag = named("quadratic_drag").with_parameters(values)
    found = steady_state(drag, inputs={"force": 2.0})
    assert float(found["p_m"]) == pytest.approx(2.0 * 2.0)  # v² = 2/0.5
    tank = named("tank_with_orifice").with_parameters({"a": 2.0, "kv": 0.5})
    found = steady_state(tank, inputs={"inflow": 0.75})
    assert float(found["q_a"]) == pytest.approx(2.0 * (0.75 / 0.5) ** 2)


def test_coulomb_friction_at_speed_is_steady_while_the_height_grows() -> None:
    graph = BondGraph("lift")
    fc, b = sympy.symbols("fc b")
    guide = R("guide", law=fc * sympy.sign(f) + b * f)
    graph.one("mass", Se("force"), I("m"), guide)
    graph.measure("height", displacement="mass")
    finished = graph.finish().with_parameters({"fc": 1.0, "b": 2.0, "m": 3.0})
    found = steady_state(finished, inputs={"force": 5.0}, guess={"p_m": 1.0})
    assert found.status is SteadyStatus.MOVING
    assert float(found["p_m"]) == pytest.approx(6.0)
    assert float(found.growth["q_mass"]) == pytest.approx(2.0)
    A = state_space(finished, at=found).A
    assert A[0, 0] == pytest.approx(-2.0 / 3.0)
    stuck = steady_state(finished, inputs={"force": 0.5})
    assert stuck.status is SteadyStatus.NOT_FOUND
    assert "a law that jumps" in stuck.reason


def test_a_nonlinear_family_names_its_free_state() -> None:
    # Two tanks joined by an orifice: any common level is a rest.
    graph = BondGraph("tanks")
    kv = sympy.Symbol("kv")
    graph.zero("left", C("a1"))
    graph.zero("right", C("a2"))
    graph.one("pipe", R("valve", law=kv * e / (1 + e**2)))
    graph.join("left", "pipe")
    graph.join("pipe", "right")
    graph.measure("level", effort="left")
    finished = graph.finish().with_parameters({"a1": 1.0, "a2": 2.0, "kv": 1.0})
    found = steady_state(finished, guess={"q_a1": 0.4, "q_a2": 0.8})
    assert found.status is SteadyStatus.FAMILY
    assert len(found.free) == 1
    assert float(found["q_a2"]) == pytest.approx(2 * float(found["q_a1"]))


@pytest.mark.parametrize("case", CASES, ids=lambda c: c.name)
def test_whatever_is_called_steady_is(case) -> None:
    graph = case.graph()
    numbers = {name: 0.7 + 0.2 * i for i, name in enumerate(graph.parameters)}
    graph = graph.with_parameters(numbers)
    if compile_model(derive(graph)).needs_time:
        with pytest.raises(EquationError, match="depends on time"):
            steady_state(graph)
        return
    inputs = {source.name: 0.4 for source in graph.inputs}
    guess = {state.symbol.name: 0.8 for state in derive(graph).states}
    found = steady_state(graph, inputs=inputs, guess=guess)
    if found.status is SteadyStatus.NOT_FOUND:
        assert found.reason
        return
    put = {sympy.Symbol(n, real=True): v for n, v in numbers.items()}
    equations = derive(graph)
    model = compile_model(equations)

    def numbers_of(names):
        return np.array([float(found[str(n)].xreplace(put)) for n in names])

    x = numbers_of(s.symbol for s in equations.states)
    here = point(model, x, numbers_of(equations.inputs), np.array([*numbers.values()]))
    rates = np.array(
        [
            float(sympy.sympify(found.growth.get(n, 0)).xreplace(put))
            for n in model.state_names
        ]
    )
    fields = {"rates": rates, "unknowns": numbers_of(equations.unknowns)}
    here = type(here)(**{n: fields.get(n, getattr(here, n)) for n in here.__slots__})
    assert residual(model, here) == pytest.approx(0.0, abs=1e-7)


def test_names_are_checked_and_time_is_refused() -> None:
    with pytest.raises(EquationError, match=r"no state or input 'torqe'.*Did you mean"):
        steady_state(pendulum(), inputs={"torqe": 1.0})
    with pytest.raises(EquationError, match="depends on time"):
        steady_state(named("modulated_sources"))
    with pytest.raises(ParameterError, match="No value is given"):
        steady_state(named("quadratic_drag"))
    with pytest.raises(EquationError, match="has no 'q_x'"):
        steady_state(named("rc"))["q_x"]


def test_a_steady_state_prints_its_values() -> None:
    text = str(steady_state(named("lowerleg"), inputs={"torque": 2}))
    assert "p_jm = " in text
    assert "d(q_joint)/dt = " in text
    assert "q_joint grows for ever" in text
    assert isinstance(steady_state(named("rc")), SteadyState)


def test_gravity_through_a_moving_modulus() -> None:
    # A crank of length l lifts a mass m: torque = m g l cos(angle) at rest.
    graph = BondGraph("crank")
    length, m, g = sympy.symbols("l m g")
    graph.one("crank", Se("torque"), I("j"), R("b"))
    graph.one("mass", I("m"), Se("weight", value=-m * g))
    arm = TF("arm", law=length * sympy.cos(displacement("crank")))
    graph.join("mass", arm, "crank")
    graph.measure("angle", displacement="crank")
    values = {"l": 0.5, "m": 2.0, "g": 9.81, "j": 0.1, "b": 0.2}
    finished = graph.finish().with_parameters(values)
    angle = 0.4
    torque = 2.0 * 9.81 * 0.5 * np.cos(angle)
    found = steady_state(finished, inputs={"torque": torque}, guess={"q_crank": 0.3})
    assert float(found["q_crank"]) == pytest.approx(angle)


def test_a_flow_source_fills_a_leaking_tank() -> None:
    graph = BondGraph("tank")
    k = sympy.Symbol("k")
    graph.zero("tank", Sf("inflow"), C("a", law=k * q**3), R("leak", law=e / 2))
    graph.measure("pressure", effort="tank")
    finished = graph.finish().with_parameters({"k": 4.0})
    found = steady_state(finished, inputs={"inflow": 2.0}, guess={"q_a": 0.5})
    assert float(found["q_a"]) == pytest.approx(1.0)
