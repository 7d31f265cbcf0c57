"""Over a steep edge the values of an explicit method may hold where slopes do not."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, I, R, Recording, Se, WholeRecordings, bind_to, f
from bondgraph.diagnosis.evidence.leftover import foretold, noise_floor
from bondgraph.diagnosis.search.base.steps import (
    explicit_steps,
    faithful,
    is_fine,
    slopes_hold,
)
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.problem import linearise_windows
from bondgraph.simulation.solvers import Hold, RungeKutta4, Sdirk2

STEP, FINE, RESISTANCE, INDUCTANCE, DROP, NOISE = 1e-3, 200, 0.5, 9e-4, 0.8, 0.2


def winding():
    g = BondGraph("winding", domain="electrical")
    drop, edge = sympy.symbols("drop edge")
    brush = R("brush", law=drop * sympy.tanh(f / edge))
    g.one("coil", Se("voltage"), R("resistance"), I("inductance"), brush)
    g.measure("current", flow="coil")
    g.parameter("resistance", 0.55, "ohm")
    g.parameter("inductance", 1e-3, "H")
    g.parameter("drop", 0.7, "V", bounds=(0.0, 10.0))
    g.parameter("edge", 0.015, "A", std=0.0)
    return g.finish()


@pytest.fixture(scope="module")
def recording():
    """Of a current against a drop that is set-valued, stepped by hand."""
    time = STEP * np.arange(1500)
    voltage = np.repeat(np.random.default_rng(2).uniform(-6.0, 6.0, 150), 10)
    current, told = 0.0, []
    for now in voltage:
        told.append(current)
        for _ in range(FINE):
            h = STEP / FINE / INDUCTANCE
            free = current + h * (now - RESISTANCE * current)
            current = np.sign(free) * max(abs(free) - h * DROP, 0.0)
    read = np.array(told) + NOISE * np.random.default_rng(3).standard_normal(time.size)
    channels = {"voltage": (voltage, "V"), "current": (read, "A")}
    return bind_to(winding(), Recording.from_arrays("run", time, channels))


@pytest.fixture(scope="module")
def fitted(recording):
    settings = FitSettings(hold=Hold.ZERO, solver=Sdirk2(4), horizon=WholeRecordings())
    return fit_model(winding(), [recording], settings)


def test_values_that_hold_do_not_make_slopes_that_hold(fitted):
    at = fitted.optimum.theta, fitted.optimum.initial
    problem = replace(fitted.problem, solver=RungeKutta4(4))
    here = linearise_windows(problem, *at)
    assert is_fine(problem, *at, here)
    assert not slopes_hold(problem, *at, here)
    assert slopes_hold(fitted.problem, *at, fitted.optimum.linearisation)


def test_no_explicit_method_is_taken_whose_slopes_run_away(fitted):
    plenty = np.full(1, 10.0)
    assert explicit_steps(fitted.problem, fitted.optimum, plenty) is None


def test_a_fit_whose_slopes_have_run_away_goes_on_with_an_implicit_method(fitted):
    problem = replace(fitted.problem, solver=RungeKutta4(4))
    start = 0.95 * fitted.optimum.theta
    found = faithful(problem, start, fitted.optimum.initial, 30, 1e-6)
    assert isinstance(found.solver, Sdirk2)
    assert found.optimum.theta == pytest.approx(fitted.optimum.theta, rel=0.02)


def test_what_a_model_foretells_is_no_noise(fitted, recording):
    floor = noise_floor([recording])
    assert foretold(fitted, floor) == floor
    too_high = {"current": 20.0 * NOISE}
    assert foretold(fitted, too_high)["current"] == pytest.approx(NOISE, rel=0.1)
