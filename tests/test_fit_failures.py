"""Windows that cannot be simulated: taken out, never calculated with."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    I,
    R,
    Recording,
    Se,
    Sf,
    WholeRecordings,
    Windows,
    bind_to,
    e,
    f,
    fit,
)
from bondgraph.diagnosis.search.base import horizons
from bondgraph.diagnosis.search.options import Options
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import fit_model
from bondgraph.fitting.horizon import cut
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.fitting.loss import Huber
from bondgraph.fitting.noise import AutoregressiveNoise
from bondgraph.fitting.posing import pose, prepare
from bondgraph.fitting.problem import linearise_windows
from bondgraph.fitting.result import FitStatus
from bondgraph.fitting.solving import solve
from bondgraph.simulation.solvers import Hold, RungeKutta4

# dv/dt = (force + a v³) / m leaves every bound in finite time once v is large.
MASS, GROWTH = 2.0, 0.5


def runaway():
    g = BondGraph("runaway", domain="translation")
    g.one("axle", Se("force"), I("m"), R("drag", law=-sympy.Symbol("a") * f**3))
    g.measure("v", flow="axle")
    g.parameter("m", 1.5, "kg")
    g.parameter("a", GROWTH, "N*s^3/m^3")
    return g.finish()


def recording(graph):
    time = 0.01 * np.arange(200)
    force = np.sin(5.0 * time)
    noise = 1e-3 * np.random.default_rng(1).normal(size=200)
    v = 0.3 * np.sin(3.0 * time) + noise
    channels = {"force": (force, "N"), "v": (v, "m/s")}
    return bind_to(graph, Recording.from_arrays("made", time, channels))


@pytest.mark.parametrize("choices", [{}, {"loss": Huber()}])
@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_a_window_that_fails_costs_infinitely_and_moves_no_other(choices, correlation):
    graph = runaway()
    settings = FitSettings(horizon=Windows(50), **choices)
    model = prepare(graph)
    problem = pose(graph, model, cut([recording(graph)], Windows(50)), settings)
    problem = replace(problem, correlation=np.array([correlation]))
    theta = problem.start[problem.free]
    fine = np.full((problem.shots.n_windows, 1), 0.2)
    broken = fine.copy()
    broken[1] = 1e4
    whole = linearise_windows(problem, theta, fine)
    found = linearise_windows(problem, theta, broken)
    others = np.arange(len(fine)) != 1
    assert np.isfinite(whole.cost).all()
    assert found.cost[1] == np.inf
    assert not found.hessian[1].any()
    assert not found.slope[1].any()
    np.testing.assert_allclose(found.cost[others], whole.cost[others])
    np.testing.assert_allclose(found.hessian[others], whole.hessian[others])
    rows = problem.shots.slices[1]
    assert np.isnan(found.residuals[rows]).all()
    assert np.isfinite(np.delete(found.residuals, np.r_[rows], axis=0)).all()
    # A minimisation from there neither warns nor calls itself converged.
    optimum = minimise(problem, theta, broken)
    assert not optimum.converged
    assert optimum.cost == np.inf


def test_windows_that_run_away_from_what_their_first_samples_suggest_begin_at_rest():
    # How warm a wire is no sample shows before a current flows: it looks like anything.
    graph, windows = runaway(), Windows(50)
    settings = FitSettings(horizon=windows)
    shots = cut([recording(graph)], windows)
    problem = pose(graph, prepare(graph), shots, settings)
    suggested = np.full((problem.shots.n_windows, 1), 0.2)
    suggested[1] = 1e4
    optimum, usual = solve(problem, initial=suggested), solve(problem)
    assert optimum.cost == pytest.approx(usual.cost, rel=1e-6)
    np.testing.assert_allclose(optimum.initial, usual.initial, rtol=1e-4, atol=1e-6)


def test_a_model_that_never_runs_says_so():
    graph = runaway().with_parameters({"a": 1e12})
    result = fit(
        graph, [recording(graph)], settings=FitSettings(noise=AutoregressiveNoise())
    )
    assert result.status is FitStatus.SIMULATION_FAILED


@pytest.mark.parametrize("horizon", [WholeRecordings(), Windows(40)])
def test_a_tank_that_may_be_empty_is_fitted_by_an_explicit_method_too(horizon):
    # The root has no finite slope at zero, where the search for states begins.
    outlet, area, step = 0.3, 2.0, 0.1
    g = BondGraph("tank", domain="hydraulic")
    law = sympy.Symbol("outlet") * sympy.sqrt(e)
    g.zero("tank", Sf("inflow"), C("area"), R("hole", law=law))
    g.measure("level", effort="tank")
    g.parameter("outlet", 0.25, bounds=(0.0, 10.0))
    g.parameter("area", 1.5, "m^3/Pa", bounds=(0.1, 10.0))
    random = np.random.default_rng(3)
    inflow = np.repeat(random.uniform(0.2, 0.6, 20), 20)
    level, levels = 1.4, []
    for flow in inflow:
        levels.append(level)
        for _ in range(50):
            level += step / 50 / area * (flow - outlet * np.sqrt(level))
    levels = np.array(levels) + 1e-3 * random.normal(size=len(levels))
    channels = {"inflow": (inflow, "m^3/s"), "level": (levels, "Pa")}
    graph = g.finish()
    run = bind_to(graph, Recording.from_arrays("run", step * np.arange(400), channels))
    settings = FitSettings(horizon=horizon, solver=RungeKutta4(), hold=Hold.ZERO)
    found = fit(graph, [run], settings=settings)
    assert found.estimate("outlet").value == pytest.approx(outlet, rel=0.02)
    assert found.estimate("area").value == pytest.approx(area, rel=0.02)


def test_a_refit_that_fails_does_not_replace_the_fit_of_a_search(monkeypatch):
    # Else all that the search has found would be told as not determined.
    graph = runaway()
    settings = FitSettings(horizon=Windows(50))
    run = recording(graph)
    found = fit_model(graph, [run], settings)
    lost = replace(found, optimum=replace(found.optimum, cost=np.inf))
    monkeypatch.setattr(horizons, "fit_model", lambda *_: lost)
    options = Options(settings=settings)
    assert horizons.sharpened(found, [run], options, found) is found


@pytest.mark.parametrize("iterations", [0, 5])
def test_a_fit_from_beyond_a_bound_begins_at_it(iterations):
    # A law of another form may have left a number where this one may not be.
    graph = runaway()
    graph = graph.with_parameters([replace(graph.parameters["m"], bounds=(1, 3))])
    settings = FitSettings(horizon=Windows(50))
    fitted = fit_model(graph, [recording(graph)], settings)
    names = fitted.problem.free_names
    beyond = np.array([{"m": -280.0, "a": GROWTH}[name] for name in names])
    initial = fitted.optimum.initial
    found = minimise(fitted.problem, beyond, initial, iterations=iterations)
    mass = found.theta[names.index("m")]
    assert 1.0 <= mass <= 3.0
    assert iterations or mass == 1.0
    at = linearise_windows(fitted.problem, found.theta, found.initial)
    np.testing.assert_allclose(found.linearisation.residuals, at.residuals)


def test_rows_of_a_table_that_states_of_their_own_explain_are_refused():
    channels = {"force": (np.arange(9.0), "N"), "v": (np.arange(9.0) / 3.0, "m/s")}
    table = bind_to(runaway(), Recording.from_arrays("table", None, channels))
    with pytest.raises(FitError, match="stores p_m: a state of its own in every row"):
        fit(runaway(), [table])
