"""Unknowns that enter linearly are eliminated: what is left has the same rates."""

import numpy as np
import pytest
from sympy import cos, sin, symbols

from bondgraph import MTF, TF, BondGraph, C, I, R, Se, derive, displacement, e, f
from bondgraph.numeric.explicit_form import explicit_form
from bondgraph.numeric.model import compile_model, evaluate
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, RungeKutta4, Sdirk3


def geared():
    """Two inertias on one shaft: the second is a dependent storage."""
    g = BondGraph("geared", domain="rotation")
    g.one("motor", Se("torque"), I("J"), R("b"))
    g.one("load", I("J_load"), C("k"))
    g.join("motor", TF("gear"), "load")
    g.measure("speed", flow="load")
    g.measure("inertial", effort="J_load")
    return g


def leg():
    """Two rods: two momenta of a point mass depend on both angles' rates."""
    length, way = symbols("length way")
    g = BondGraph("leg", domain="rotation")
    g.one("hip", Se("torque"), I("J_hip"), R("b"), C("k_hip"))
    g.one("knee", I("J_knee"), R("worm", law=symbols("c") * f * (1 + f**2)), C("k"))
    for axis, turn in (("x", cos), ("y", sin)):
        g.one(f"foot_{axis}", I(f"m_{axis}"), domain="translation")
        g.zero(f"sum_{axis}", domain="translation")
        g.join(f"foot_{axis}", f"sum_{axis}")
        hip, knee = displacement("hip"), displacement("knee")
        g.join(f"sum_{axis}", MTF(f"hip_{axis}", length * turn(hip)), "hip")
        g.join(f"sum_{axis}", MTF(f"knee_{axis}", way * turn(knee)), "knee")
    g.prefer("J_hip", "integral")
    g.prefer("J_knee", "integral")
    g.measure("angle", displacement="knee")
    return g


def ring():
    """An algebraic loop of resistances that are straight lines."""
    g = BondGraph("ring", domain="electrical")
    g.one("line", Se("u"), R("series"), R("other"))
    g.zero("node", R("shunt"), R("second"))
    g.one("coil", I("l"), R("r"))
    g.join("line", "node")
    g.join("node", "coil")
    g.measure("v", effort="node")
    return g


def loop():
    """A loop that is no straight line."""
    g = BondGraph("loop", domain="electrical")
    k, s = symbols("k s")
    g.one("line", Se("u"), R("valve", law=k * (f + f**3)))
    g.zero("node", R("shunt", law=s * (e + e**3)))
    g.one("coil", I("l"), R("r"))
    g.join("line", "node")
    g.join("node", "coil")
    g.measure("v", effort="node")
    return g


def forms(make):
    model = compile_model(derive(make().finish()))
    assert model.n_unknowns > 0
    return model, explicit_form(model)


@pytest.mark.parametrize("make", [geared, leg, ring])
def test_the_rates_are_those_that_make_the_residuals_vanish(make):
    model, form = forms(make)
    assert form is not None
    assert form.n_unknowns == 0
    draw = np.random.default_rng(3)
    nx, nz = model.n_states, model.n_unknowns
    for _ in range(20):
        x = draw.normal(size=nx)
        rest = draw.uniform(0.3, 1.5, model.dynamics.n_variables - 2 * nx - nz)
        # Rates and residuals are affine in (ẋ, z): one dense solution is exact.
        at = np.concatenate([x, np.zeros(nx + nz), rest])
        directions = np.zeros((len(at), nx + nz))
        directions[nx : 2 * nx + nz] = np.eye(nx + nz)
        values, slopes = evaluate(model.dynamics, at, directions)
        slopes[:nx, :nx] -= np.eye(nx)
        solved = np.linalg.solve(slopes, -values)
        point = np.concatenate([x, np.full(nx, np.nan), rest])
        rates, _ = evaluate(form.dynamics, point, np.zeros((len(point), 0)))
        assert rates == pytest.approx(solved[:nx], rel=1e-9, abs=1e-12)
        full = np.concatenate([x, solved, rest])
        read, _ = evaluate(model.output, full, np.zeros((len(full), 0)))
        own, _ = evaluate(form.output, point, np.zeros((len(point), 0)))
        assert own == pytest.approx(read, rel=1e-9, abs=1e-12)


def test_explicit_steps_and_their_slopes_are_those_of_implicit_ones():
    model, _ = forms(leg)
    time = np.linspace(0.0, 1.0, 401)
    shots = Shots(time, np.sin(7 * time)[:, None], np.zeros((401, 1)), (0, 401))
    values = np.linspace(0.4, 0.9, len(model.parameter_names))
    about = np.array([1, 4])
    found = [
        shoot(
            model,
            shots,
            parameters=values,
            initial=np.full((1, model.n_states), 0.2),
            directions=about,
            solver=solver,
            hold=Hold.FIRST,
        )
        for solver in (RungeKutta4(2), Sdirk3(8))
    ]
    for a, b in (
        (found[0].outputs, found[1].outputs),
        (found[0].sensitivities, found[1].sensitivities),
    ):
        assert np.abs(a - b).max() < 1e-6 * np.abs(b).max()


def test_what_is_no_straight_line_is_left_alone():
    _, form = forms(loop)
    assert form is None
