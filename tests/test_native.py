"""Native code does what the tape does: values, slopes, simulations, sensitivities."""

import math

import numpy as np
import pytest
import sympy
from numba import njit
from sympy import symbols

from bondgraph import BondGraph, C, I, R, Sdirk2, Sdirk3, Se, Sf, derive, e, f, q, t
from bondgraph.errors import EquationError
from bondgraph.numeric.kernel.machine import run
from bondgraph.numeric.model import compile_model
from bondgraph.numeric.native.calls import call_slopes, call_values
from bondgraph.numeric.native.compiling import (
    compiled_text,
    module_text,
    slopes_of,
    values_of,
)
from bondgraph.numeric.tape import record_tape
from bondgraph.simulation.engines import Interpreted, Native, WhenItPays
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, RungeKutta4

x, y, z = symbols("x y z")
FUNCTIONS = [
    x + y, x - y - z, x * y * z, x / y, x**2, x**5, 1 / x**3, x**y, sympy.sqrt(x),
    sympy.sin(x), sympy.cos(x), sympy.tan(x), sympy.exp(x), sympy.log(x),
    sympy.tanh(x), sympy.sinh(x), sympy.cosh(x), sympy.atan(x), sympy.asin(x / 9),
    sympy.acos(x / 9), sympy.atan2(x, y), sympy.Abs(x - y), sympy.sign(x - y),
    sympy.Max(x, y, z), sympy.Min(x, y * z), sympy.Heaviside(x - y),
    sympy.Piecewise((x**2, x < y), (sympy.sqrt(x), (x > z) & (y > 0)), (x * z, True)),
    sympy.Piecewise((x, sympy.Or(x <= z, sympy.Not(y < x))), (y, True)),
]  # fmt: skip
POINTS = [(0.3, 1.7, 2.9), (2.2, 0.4, 1.1), (1.5, 1.5, 0.2), (8.1, 3.3, 5.0)]


def compiled(expressions):
    """Return (v, d) -> values and tangents by tape, and values and slopes natively."""
    tape = record_tape([x, y, z], [], expressions, lambda _: True)
    functions = [values_of(tape, "values"), slopes_of(tape, "slopes", [0, 1, 2])]
    code = compiled_text(module_text(functions))

    def by_tape(point):
        v, d = np.zeros(tape.n_slots), np.zeros((tape.n_slots, 3))
        v[: 3 + len(tape.constants)] = [*point, *tape.constants]
        d[:3] = np.eye(3)
        run(tape.code, 3 + len(tape.constants), v, d, 3)
        return v[tape.outputs], d[tape.outputs]

    def natively(point):
        n = len(expressions)
        v, alone = np.array([*point, *[0.0] * n]), np.array([*point, *[0.0] * n])
        j = np.zeros((n, 3))
        from_python(code["values"], alone, code["slopes"], v, j.reshape(-1))
        assert np.array_equal(v, alone, equal_nan=True)
        return v[3:], j

    return by_tape, natively


@njit
def from_python(values, alone, slopes, v, j):
    call_values(values, alone)
    call_slopes(slopes, v, j)


@pytest.fixture(scope="module")
def every_function():
    return compiled(FUNCTIONS)


@pytest.mark.parametrize("point", POINTS)
def test_every_operation_means_what_it_means_on_the_tape(every_function, point):
    by_tape, natively = every_function
    values, tangents = by_tape(point)
    own, slopes = natively(point)
    assert np.isfinite(values).all()
    assert own == pytest.approx(values, rel=1e-14, abs=1e-14)
    assert slopes == pytest.approx(tangents, rel=1e-12, abs=1e-13)


def test_outside_its_domain_a_function_is_nan_or_infinite_as_on_the_tape():
    laws = [sympy.sqrt(x), sympy.log(x), sympy.exp(-1000 * x), sympy.log(x + 1)]
    by_tape, natively = compiled(laws)
    values, _ = by_tape((-1.0, 0.0, 0.0))
    own, _ = natively((-1.0, 0.0, 0.0))
    assert np.array_equal(own, values, equal_nan=True)
    assert math.isnan(own[0])
    assert math.isinf(own[2])


def test_the_branch_not_taken_does_not_spoil_the_slope():
    law = sympy.Piecewise((sympy.sqrt(x), x > 0), (y, True))
    _, natively = compiled([law])
    value, slopes = natively((-1.0, 3.0, 0.0))
    assert value.tolist() == [3.0]
    assert slopes.tolist() == [[0.0, 1.0, 0.0]]


def pendulum():
    g = BondGraph("pendulum", domain="rotation")
    weight, coulomb, slip, b = symbols("weight coulomb slip b")
    g.one(
        "axle",
        Se("torque"),
        I("J"),
        R("friction", law=coulomb * sympy.tanh(f / slip) + b * f),
        C("mass", law=weight * sympy.sin(q)),
    )
    g.measure("angle", displacement="axle")
    g.measure("net", effort="J")
    known = {"J": 0.1, "weight": 4.0, "coulomb": 0.3, "b": 0.02, "slip": 0.01}
    return g, known


def divider():
    g = BondGraph("divider")
    k, s = symbols("k s")
    g.one("line", Se("u"), R("valve", law=k * (f + f**3)))
    g.zero("node", R("shunt", law=s * (e + e**3)))
    g.one("coil", I("l"), R("r"))
    g.join("line", "node")
    g.join("node", "coil")
    g.measure("i", flow="coil")
    g.measure("v", effort="node")
    return g, {"k": 1.5, "s": 0.6, "l": 0.4, "r": 0.9}


def warming():
    g = BondGraph("warming", domain="translation")
    k = symbols("k")
    g.one("mass", Se("force"), I("m"), C("spring", law=k * (1 + t) * q), R("c"))
    g.measure("x", displacement="mass")
    return g, {"m": 1.2, "k": 4.0, "c": 0.3}


def bench():
    g = BondGraph("load bench", domain="rotation")
    g.one("axle", Sf("speed"), R("b"), I("J"))
    g.measure("torque", effort="speed")
    return g, {"b": 1.7, "J": 0.2}


MACHINES = [pendulum, divider, warming, bench]


def posed(make, samples=301):
    """Return model, parameters, three windows and their initial states."""
    graph, known = make()
    model = compile_model(derive(graph.finish()))
    values = np.array([known[name] for name in model.parameter_names])
    draw = np.random.default_rng(5)
    time = 0.5 + 1e-3 * np.cumsum(draw.uniform(0.5, 1.5, samples))
    u = 1.5 * np.sin(9 * time) + 0.3 * draw.normal(size=samples)
    shots = Shots(time, u[:, None], np.zeros((samples, 1)), (0, 100, 180, samples))
    return model, values, shots, draw.normal(scale=0.3, size=(3, model.n_states))


def simulated(make, solver, engine, *, hold=Hold.FIRST, sensitive=True):
    model, values, shots, initial = posed(make)
    return shoot(
        model,
        shots,
        parameters=values,
        initial=initial,
        directions=np.arange(len(values))[::-1].copy() if sensitive else None,
        solver=solver,
        hold=hold,
        engine=engine,
    )


@pytest.mark.parametrize("solver", [Sdirk2(), Sdirk3(substeps=2)], ids=str)
@pytest.mark.parametrize("make", MACHINES, ids=lambda m: m.__name__)
def test_native_simulations_are_those_of_the_tape(make, solver):
    hold = Hold.ZERO if make is warming else Hold.FIRST
    tape = simulated(make, solver, Interpreted(), hold=hold)
    native = simulated(make, solver, Native(), hold=hold)
    alone = simulated(make, solver, Native(), hold=hold, sensitive=False)
    assert native.completed.all()
    assert tape.completed.all()
    for ours, theirs in (
        (native.outputs, tape.outputs),
        (alone.outputs, tape.outputs),
        (native.states, tape.states),
    ):
        assert ours == pytest.approx(theirs, rel=1e-11, abs=1e-12)
    size = np.abs(tape.sensitivities).max(axis=(0, 1), initial=1e-3)
    apart = np.abs(native.sensitivities - tape.sensitivities) / size
    assert apart.max(initial=0.0) < 1e-8


def exact_pendulum(make, shots, values, initial, model):
    """Return the angle by the exponentially finer classical method, written out."""
    known = dict(zip(model.parameter_names, values, strict=True))

    def rate(state, torque):
        momentum, angle = state
        speed = momentum / known["J"]
        dry = known["coulomb"] * np.tanh(speed / known["slip"])
        weight = known["weight"] * np.sin(angle)
        return np.array([torque - dry - known["b"] * speed - weight, speed])

    rows = []
    for window, part in enumerate(shots.slices):
        state = initial[window].copy()
        time, u = shots.time[part], shots.inputs[part, 0]
        rows.append(state[1])
        for k in range(len(time) - 1):
            n = 20
            h = (time[k + 1] - time[k]) / n
            for i in range(n):
                now, half, then = (
                    u[k] + (u[k + 1] - u[k]) * (i + share) / n for share in (0, 0.5, 1)
                )
                a = rate(state, now)
                b = rate(state + h / 2 * a, half)
                c = rate(state + h / 2 * b, half)
                d = rate(state + h * c, then)
                state = state + h / 6 * (a + 2 * b + 2 * c + d)
            rows.append(state[1])
    return np.array(rows)


def test_the_explicit_method_has_order_four_between_samples():
    model, values, shots, initial = posed(pendulum)
    assert model.state_names == ("p_J", "q_mass")
    exact = exact_pendulum(pendulum, shots, values, initial, model)
    errors = [
        np.abs(
            simulated(pendulum, RungeKutta4(n), Native(), sensitive=False).outputs[:, 0]
            - exact
        ).max()
        for n in (1, 2, 4)
    ]
    assert errors[0] < 1e-5
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.5)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4, abs=0.5)


@pytest.mark.parametrize("solver", [RungeKutta4(), Sdirk2()], ids=str)
def test_sensitivities_to_nothing_have_no_columns(solver):
    """Once a call of a function that was not there: the process ended."""
    model, values, shots, initial = posed(pendulum)
    shot, alone = (
        shoot(
            model,
            shots,
            parameters=values,
            initial=initial,
            directions=directions,
            solver=solver,
            hold=Hold.FIRST,
            engine=Native(),
            of_initial=False,
        )
        for directions in (np.zeros(0, np.int64), None)
    )
    assert shot.sensitivities.shape == (*alone.outputs.shape, 0)
    np.testing.assert_array_equal(shot.outputs, alone.outputs)


@pytest.mark.parametrize("hold", Hold)
@pytest.mark.parametrize("make", [pendulum, warming], ids=lambda m: m.__name__)
def test_explicit_sensitivities_are_those_of_the_discrete_solution(make, hold):
    model, values, shots, initial = posed(make)

    def outputs(parameters, start, directions=None):
        return shoot(
            model,
            shots,
            parameters=parameters,
            initial=start,
            directions=directions,
            solver=RungeKutta4(),
            hold=hold,
        )

    own = outputs(values, initial, np.arange(len(values))).sensitivities
    n = len(values)
    for k in range(n + model.n_states):
        change, shift = np.zeros(n), np.zeros(model.n_states)
        step = 1e-6 * (values[k] if k < n else 1.0)
        if k < n:
            change[k] = step
        else:
            shift[k - n] = step
        up = outputs(values + change, initial + shift).outputs
        down = outputs(values - change, initial - shift).outputs
        slope = (up - down) / (2 * step)
        scale = np.abs(slope).max()
        assert own[:, :, k] == pytest.approx(slope, abs=3e-6 * scale), k


def test_both_kinds_of_steps_agree_on_a_held_input():
    fine = simulated(warming, RungeKutta4(4), Native(), hold=Hold.ZERO)
    other = simulated(warming, Sdirk3(substeps=16), Native(), hold=Hold.ZERO)
    assert fine.outputs == pytest.approx(other.outputs, abs=1e-9)


def test_an_explicit_method_refuses_what_is_only_implicit():
    with pytest.raises(EquationError, match="implicitly") as caught:
        simulated(divider, RungeKutta4(), Native())
    assert "Sdirk2" in str(caught.value)


def test_code_is_compiled_once_and_only_where_it_pays():
    model, *_ = posed(pendulum)
    engine = WhenItPays()
    assert not engine.compiles(model, 100)
    assert engine.compiles(model, 100_000)
    assert not WhenItPays(operations=3).compiles(model, 100_000)
    text = module_text([values_of(model.dynamics, "values")])
    assert compiled_text(text) is compiled_text(text)


def runaway():
    g = BondGraph("runaway", domain="translation")
    k = symbols("k")
    g.one("cart", Se("force"), I("m"), R("push", law=-k * f**3))
    g.measure("v", flow="cart")
    return compile_model(derive(g.finish()))


def test_a_window_that_runs_away_leaves_the_others_as_they_are():
    model = runaway()
    time = np.tile(np.linspace(0, 2, 201), 3)
    shots = Shots(time, np.zeros((603, 1)), np.zeros((603, 1)), (0, 201, 402, 603))
    directions = np.arange(len(model.parameter_names))

    def pushed(engine, speeds):
        return shoot(
            model,
            shots,
            parameters=np.ones(len(model.parameter_names)),
            initial=np.array(speeds)[:, None],
            directions=directions,
            solver=Sdirk2(),
            hold=Hold.FIRST,
            engine=engine,
        )

    native = pushed(Native(), [0.1, 1.0, 0.2])
    tape = pushed(Interpreted(), [0.1, 1.0, 0.2])
    calm = pushed(Native(), [0.1, 0.3, 0.2])
    assert native.completed.tolist() == [True, False, True]
    assert native.trouble == tape.trouble
    outer = np.r_[0:201, 402:603]
    assert np.array_equal(native.outputs[outer], calm.outputs[outer])
    assert np.array_equal(native.sensitivities[outer], calm.sensitivities[outer])
    np.testing.assert_allclose(native.outputs, tape.outputs, rtol=1e-9)


def test_a_model_that_runs_away_is_not_completed_by_any_engine():
    model = runaway()
    time = np.linspace(0, 2, 201)
    shots = Shots(time, np.zeros((201, 1)), np.zeros((201, 1)), (0, 201))
    for solver, engine in (
        (RungeKutta4(), Native()),
        (Sdirk2(), Native()),
        (Sdirk2(), Interpreted()),
    ):
        shot = shoot(
            model,
            shots,
            parameters=np.ones(len(model.parameter_names)),
            initial=np.ones((1, 1)),
            directions=None,
            solver=solver,
            hold=Hold.FIRST,
            engine=engine,
        )
        assert shot.completed.tolist() == [False]


@pytest.mark.parametrize(
    ("spring", "rub"),
    [
        (1e4 * q**5, 20 * f / (sympy.Abs(f) + 1e-6)),
        (5 * q, (20 + 30 * sympy.exp(-((f / 0.01) ** 2))) * sympy.tanh(f / 1e-4)),
    ],
    ids=["a steep spring", "friction that falls"],
)
def test_a_step_without_a_solution_is_taken_in_halves_as_on_the_tape(spring, rub):
    g = BondGraph("sharp", domain="translation")
    g.one("body", Se("push"), I("m"), R("rub", law=rub), C("spring", law=spring))
    g.measure("speed", flow="body")
    model = compile_model(derive(g.finish()))
    time = 0.05 * np.arange(200)
    push = 40 * np.sign(np.sin(2 * np.pi * time / 1.7))[:, None]
    shots = Shots(time, push, np.zeros((200, 1)), (0, 200))

    def driven(engine):
        return shoot(
            model,
            shots,
            parameters=np.ones(1),
            initial=np.zeros((1, 2)),
            directions=np.zeros(1, np.int64),
            solver=Sdirk2(substeps=3),
            hold=Hold.ZERO,
            engine=engine,
            reasons=False,
        )

    native, tape = driven(Native()), driven(Interpreted())
    assert native.completed.all()
    assert tape.completed.all()
    np.testing.assert_allclose(native.outputs, tape.outputs, rtol=1e-6, atol=1e-8)


def test_where_no_reason_is_asked_for_none_is_looked_for():
    model = runaway()
    shots = Shots(
        np.linspace(0, 2, 201), np.zeros((201, 1)), np.zeros((201, 1)), (0, 201)
    )
    asked = [
        shoot(
            model,
            shots,
            parameters=np.ones(len(model.parameter_names)),
            initial=np.array([[10.0]]),
            directions=None,
            solver=Sdirk2(),
            hold=Hold.FIRST,
            engine=Native(),
            reasons=reasons,
        )
        for reasons in (True, False)
    ]
    assert not any(shot.completed.any() for shot in asked)
    assert [bool(shot.trouble[0].unknown) for shot in asked] == [True, False]
