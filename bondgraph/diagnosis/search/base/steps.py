"""Steps that are fine enough, and as cheap as that allows.

An explicit method takes a machine that is not stiff through a recording many times
faster than an implicit one, and more accurately. What is added to the machine may make
it stiff: a fit that ends where half the steps tell another story, or that was turned
back because nothing could be simulated, is gone on with by an implicit method.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.levenberg_marquardt import Optimum, minimise
from bondgraph.fitting.problem import FitProblem, Linearisation, linearise_windows
from bondgraph.fitting.step_error import step_error
from bondgraph.simulation.native_shooting import suits_explicit
from bondgraph.simulation.solvers import RungeKutta4, Sdirk2, Sdirk3, Solver

Array = NDArray[np.float64]
EXPLICIT = (1, 2, 4)
"""Substeps of the explicit method; with more, an implicit one is as cheap."""

OF_CANDIDATE = 0.1
"""Of what a candidate leaves: a step's error below it decides nothing."""

RUN_AWAY = 10.0
"""Slopes whose squares half a step changes by more are none."""

NO_EFFECT = 1.0
"""Squared, in standard deviations of all samples together: of the whole of a number."""

KINDS: dict[str, type[Solver]] = {
    kind.__name__: kind for kind in (RungeKutta4, Sdirk2, Sdirk3)
}


@dataclass(frozen=True, slots=True)
class Faithful:
    """An optimum, and the solver with which it means something."""

    optimum: Optimum
    solver: Solver


def solver_named(kind: str, substeps: int) -> Solver:
    """Return a solver from what was kept of it as plain data."""
    return KINDS[kind](substeps)


def left(problem: FitProblem, at: Linearisation) -> Array:
    """Return what a model leaves of each output, as a root mean square."""
    found: Array = problem.sigma * np.sqrt(np.nanmean(at.residuals**2, axis=0))
    return found


def explicit_steps(problem: FitProblem, optimum: Optimum, fine: Array) -> Solver | None:
    """Return the explicit method whose steps' errors are within `fine`, if any is."""
    if not suits_explicit(problem.model):
        return None
    for substeps in EXPLICIT:
        solver = RungeKutta4(substeps)
        stepped = replace(problem, solver=solver)
        at = optimum.theta, optimum.initial
        near = np.all(step_error(stepped, *at) <= fine)
        if near and slopes_hold(stepped, *at, linearise_windows(stepped, *at)):
            return solver
    return None


def coarser(problem: FitProblem, optimum: Optimum) -> Solver:
    """Return the problem's solver with as few substeps as decide nothing there.

    Of the hypotheses most are tried to be dropped; so fine as the last fit they need
    not be.
    """
    solver, here = problem.solver, optimum.linearisation
    while solver.substeps > 1:
        fewer = replace(solver, substeps=solver.substeps // 2)
        stepped = replace(problem, solver=fewer)
        if not is_fine(stepped, optimum.theta, optimum.initial, here):
            break
        solver = fewer
    return solver


def faithful(
    problem: FitProblem,
    theta: Array,
    initial: Array,
    iterations: int,
    tolerance: float,
) -> Faithful:
    """Fit, by an implicit method where the explicit one is not to be trusted."""
    if isinstance(problem.solver, RungeKutta4):
        here = linearise_windows(problem, theta, initial)
        if is_fine(problem, theta, initial, here):
            found = minimise(
                problem,
                theta,
                initial,
                iterations=iterations,
                tolerance=tolerance,
                settled=here,
            )
            at = found.theta, found.initial
            end = found.linearisation
            fine = not found.lost and is_fine(problem, *at, end)
            if fine and slopes_hold(problem, *at, end):
                return Faithful(found, problem.solver)
            theta, initial = at
        problem = replace(problem, solver=Sdirk2(problem.solver.substeps))
    found = minimise(
        problem, theta, initial, iterations=iterations, tolerance=tolerance
    )
    return Faithful(found, problem.solver)


def is_fine(
    problem: FitProblem, theta: Array, initial: Array, here: Linearisation
) -> bool:
    """Return whether the error of a step decides nothing about a candidate."""
    if not np.isfinite(here.cost).all():
        return False
    fine = OF_CANDIDATE * left(problem, here)
    return bool(np.all(step_error(problem, theta, initial) <= fine))


def slopes_hold(
    problem: FitProblem, theta: Array, initial: Array, here: Linearisation
) -> bool:
    """Return whether half the steps leave the effects of the parameters as they are.

    Over a steep edge a step may be unstable for a sample or two. The values stay near
    the edge then, but their slopes run away, and a fit neither moves nor tells what it
    determines.

    Parameters
    ----------
    here
        The linearisation there, in the problem's own steps.
    """
    finer = replace(problem.solver, substeps=2 * problem.solver.substeps)
    there = linearise_windows(replace(problem, solver=finer), theta, initial)
    own, other = (
        theta**2 * np.einsum("wii->i", at.hessian)[: len(theta)] for at in (here, there)
    )
    near = (own <= RUN_AWAY * other) & (other <= RUN_AWAY * own)
    return bool((near | (np.maximum(own, other) < NO_EFFECT)).all())
