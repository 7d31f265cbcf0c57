"""Sensitivities of the solver's order; friction with a peak, on a belt, in a field."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from bondgraph import BondGraph, C, I, R, RField, Sdirk2, Sdirk3, Se, f, ports
from bondgraph.equations.deriving.derivation import derive
from bondgraph.numeric.model import compile_model
from bondgraph.simulation.accuracy import halved_step_difference
from bondgraph.simulation.run import simulate_inputs
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold


def symbols(names):
    return sympy.symbols(names, real=True)


@pytest.mark.parametrize(("kind", "order"), [(Sdirk2, 2), (Sdirk3, 3)])
def test_gradients_have_the_order_of_the_solver(kind, order):
    g = BondGraph("oscillator", domain="translation")
    g.one("mass", I("m"), C("c"))
    g.measure("x", displacement="mass")
    model = compile_model(derive(g.finish()))
    m, c, x0 = 2.0, 0.1, 0.3
    values = np.array([{"m": m, "c": c}[n] for n in model.parameter_names])
    start = np.array([[{"q_c": x0, "p_m": 0.0}[n] for n in model.state_names]])
    mass = model.parameter_names.index("m")
    errors = []
    for n in (60, 120, 240, 480):
        time = np.linspace(0, 3, n + 1)
        shot = shoot(
            model,
            Shots(time, np.zeros((n + 1, 0)), np.zeros((n + 1, 1)), (0, n + 1)),
            parameters=values,
            initial=start,
            directions=np.array([mass]),
            solver=kind(),
            hold=Hold.FIRST,
        )
        omega = 1 / np.sqrt(m * c)
        # x = x0 cos(ω t) with ω = (m c)^(-1/2), so ∂x/∂m = x0 t ω sin(ω t) / (2 m).
        exact = x0 * time * omega * np.sin(omega * time) / (2 * m)
        errors.append(np.abs(shot.sensitivities[:, 0, 0] - exact).max())
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders[-1] == pytest.approx(order, abs=0.15)


def belt(static):
    """A block on a moving belt, held by a spring: it sticks, slips and sticks."""
    g = BondGraph("block on a belt", domain="translation")
    fc, fs, vs, v0 = symbols("fc fs vs v0")
    slip = f - v0
    law = (fc + (fs - fc) * sympy.exp(-((slip / vs) ** 2))) * sympy.sign(slip)
    g.one("block", I("m"), C("c"), R("belt", law=law))
    g.measure("v", flow="block")
    g.measure("spring", effort="c")
    known = {"m": 1.0, "c": 1 / 20, "fc": 1.0, "fs": static, "vs": 0.05, "v0": 0.1}
    return g.finish().with_parameters(known)


def test_stick_slip_on_a_belt_breaks_away_at_the_static_force():
    run = simulate_inputs(
        belt(2.0), np.linspace(0, 6, 12001), initial={"p_m": 0.1, "q_c": 0.0}
    )
    assert run.status.name == "SUCCESSFUL", run.reason
    v, spring = run.output("v"), run.output("spring")
    begins = 2.0 / 20 / 0.1  # the belt stretches the spring to 2 N in one second
    rides = run.time < begins - 1e-3
    assert v[rides] == pytest.approx(np.full(rides.sum(), 0.1), abs=1e-12)
    assert spring[rides] == pytest.approx(20 * 0.1 * run.time[rides], abs=1e-9)
    slips = solve_ivp(
        lambda t, y: [1 + np.exp(-(((y[0] - 0.1) / 0.05) ** 2)) - 20 * y[1], y[0]],
        (begins, 3.0),
        [0.1, 0.1],
        t_eval=run.time[(run.time > 1.0) & (run.time < 1.8)],
        events=caught,
        rtol=1e-10,
        atol=1e-12,
    )
    free = (run.time > 1.0) & (run.time < 1.8)
    assert v[free] == pytest.approx(slips.y[0], abs=2e-3)
    kinds = [event.kind.name for event in run.events]
    assert kinds[:3] == ["SLIPS", "STICKS", "SLIPS"]
    first, second, third = (event.time for event in run.events[:3])
    assert first == pytest.approx(begins, abs=2e-3)
    assert second == pytest.approx(slips.t_events[0][0], abs=5e-3)
    # It rides on until the spring is stretched as before.
    missing = 0.1 - np.interp(second, run.time, spring) / 20
    assert third == pytest.approx(second + missing / 0.1, abs=5e-3)


def caught(t, y):
    """The block is as fast as the belt again."""
    return y[0] - 0.1 if t > 1.3 else -1.0


def test_a_field_of_resistances_sticks_port_by_port():
    g = BondGraph("two feet", domain="translation")
    (tau,) = symbols(["tau"])
    f1, f2 = ports("f", 2)
    laws = (tau * sympy.sign(f1) + 0.1 * f2, 2 * tau * sympy.sign(f2) + 0.1 * f1)
    g.one("left", Se("pull"), I("m1"))
    g.one("right", Se("push"), I("m2"))
    g.put(RField("feet", laws), on=("left", "right"))
    g.measure("v1", flow="left")
    g.measure("v2", flow="right")
    graph = g.finish().with_parameters({"tau": 1.0, "m1": 1.0, "m2": 1.0})
    time = np.linspace(0, 2, 2001)
    run = simulate_inputs(graph, time, inputs={"pull": time, "push": time})
    v1, v2 = run.output("v1"), run.output("v2")
    assert np.abs(v1[time < 0.999]).max() < 1e-12
    assert v1[-1] > 0.4
    assert np.abs(v2).max() < 1e-12


@pytest.mark.parametrize(("kind", "seen"), [(Sdirk2, 3 / 4), (Sdirk3, 7 / 8)])
def test_half_the_step_shows_a_known_share_of_the_error(kind, seen):
    g = BondGraph("oscillator", domain="translation")
    g.one("mass", I("m"), C("c"))
    g.measure("x", displacement="mass")
    model = compile_model(derive(g.finish()))
    values = np.array([{"m": 2.0, "c": 0.1}[n] for n in model.parameter_names])
    start = np.array([[{"q_c": 0.3, "p_m": 0.0}[n] for n in model.state_names]])
    time = np.linspace(0, 3, 121)
    shots = Shots(time, np.zeros((121, 0)), np.zeros((121, 1)), (0, 121))
    case = {"parameters": values, "initial": start, "hold": Hold.FIRST}
    shot = shoot(model, shots, directions=None, solver=kind(), **case)
    exact = 0.3 * np.cos(time / np.sqrt(0.2))
    error = np.sqrt(np.mean((shot.outputs[:, 0] - exact) ** 2))
    estimate = halved_step_difference(model, shots, solver=kind(), **case)
    assert estimate[0] == pytest.approx(seen * error, rel=0.05)
