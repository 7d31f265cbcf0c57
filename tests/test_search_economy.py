"""What is tried to be dropped is tried cheaply; what is told is fitted with care."""

from dataclasses import replace

import numpy as np
import pytest

from bondgraph import BondGraph, I, R, Recording, Se, bind_to
from bondgraph.diagnosis.candidates import Promised
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.base.steps import coarser
from bondgraph.diagnosis.search.laws.fits import fit_best
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.posing import coarse
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting import levenberg_marquardt
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.fine_steps import simulated_as
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.fitting.loss import Huber
from bondgraph.fitting.problem import linearise_windows, window_costs
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.places.everywhere import all_places
from bondgraph.simulation.solvers import RungeKutta4, Sdirk2

STEP, MASS, DRAG = 0.02, 2.0, 1.5


def cart(viscous=0.5):
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("mass"), R("viscous"))
    g.measure("speed", flow="cart")
    g.parameter("mass", MASS, "kg", bounds=(1, 5))
    g.parameter("viscous", viscous, "N*s/m", bounds=(0, 1e6))
    return g.finish()


def pushed(samples=800):
    """Return a cart with square drag, stepped by hand."""
    time = np.arange(samples) * STEP
    force = 8.0 * np.sin(1.3 * time) + 5.0 * np.sin(3.1 * time)
    speed, v = np.zeros(samples), 0.0
    for k, push in enumerate(force):
        speed[k] = v
        for _ in range(20):
            v += STEP / 20 / MASS * (push - 0.5 * v - DRAG * v * abs(v))
    noise = 1e-3 * np.random.default_rng(2).standard_normal(samples)
    return Recording.from_arrays(
        "pushed", time, {"force": (force, "N"), "speed": (speed + noise, "m/s")}
    )


@pytest.fixture(scope="module")
def fitted():
    return fit_model(cart(), [bind_to(cart(), pushed())], FitSettings())


def test_what_windows_cost_is_known_without_slopes(fitted):
    problem, optimum = fitted.problem, fitted.optimum
    theta = 1.3 * optimum.theta
    for other in (problem, replace(problem, loss=Huber(2.0))):
        costs = window_costs(other, theta, optimum.initial)
        whole = linearise_windows(other, theta, optimum.initial)
        assert costs == pytest.approx(whole.cost, rel=1e-9)
    lost = window_costs(problem, np.full_like(theta, np.nan), optimum.initial)
    assert np.isinf(lost).all()


def test_a_step_that_is_refused_needs_no_slopes(fitted, monkeypatch):
    looked = []
    monkeypatch.setattr(
        levenberg_marquardt,
        "linearise_windows",
        lambda *of: looked.append(1) or linearise_windows(*of),
    )
    tried = []
    monkeypatch.setattr(
        levenberg_marquardt,
        "window_costs",
        lambda *of: tried.append(1) or 1e9 * window_costs(*of),
    )
    monkeypatch.setattr(
        levenberg_marquardt, "_repair", lambda _, step, costs, __: (step, costs)
    )
    problem, optimum = fitted.problem, fitted.optimum
    minimise(problem, 1.2 * optimum.theta, optimum.initial, iterations=5)
    assert (len(looked), len(tried)) == (1, 5)


def stepped(fitted, solver):
    return simulated_as(fitted, solver, fitted.problem.hold)


@pytest.mark.parametrize("kind", [RungeKutta4, Sdirk2])
def test_hypotheses_are_told_apart_with_as_few_steps_as_do(fitted, kind):
    fine = stepped(fitted, kind(8))
    few = coarse(fine)
    assert few.problem.solver == kind(1)
    assert few.optimum.cost == pytest.approx(fine.optimum.cost, rel=0.01)
    assert fine.problem.solver == kind(8)
    assert coarse(few) is few


def test_steps_that_decide_something_stay(fitted):
    """A time constant of a hundredth of a sample: an explicit step runs away."""
    problem = replace(fitted.problem, solver=RungeKutta4(256))
    theta = np.array([MASS, 100.0 * MASS / STEP])[
        [problem.free_names.index(name) for name in ("mass", "viscous")]
    ]
    there = minimise(problem, theta, fitted.optimum.initial, iterations=0)
    assert coarser(problem, there).substeps > 16


def test_what_is_kept_is_fitted_with_the_steps_of_the_base(fitted):
    fine = stepped(fitted, Sdirk2(4))
    with workshop(Here(), Journal(), lambda _: None) as shop:
        bench = Bench.of(fine, shop, "test")
        assert bench.few.problem.solver == Sdirk2(1)
        place = next(
            p for p in all_places(fine.graph, measure_scales(fine)) if p.name == "cart"
        )
        (drag,) = QuadraticDrag().propose(place)
        found = fit_best(bench, [Promised(drag, 0.5)], 0.5, 3)
    assert [c.fitted.problem.solver for c in found] == [Sdirk2(4)]
    (name,) = drag.strengths
    assert found[0].fitted.values[name] == pytest.approx(DRAG, rel=0.05)
