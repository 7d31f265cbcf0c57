"""Steps so fine that what is told does not depend on them.

A fitted model is fitted again, from where it was, in other steps; they are halved as
long as that moves an estimate.
"""

from dataclasses import replace

import numpy as np

from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.fitted import FittedModel
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.fitting.step_error import MOST_SUBSTEPS
from bondgraph.simulation.solvers import Hold, Solver

MOVED = 0.5
"""Standard errors by which a step's error may move an estimate that is told."""

ITERATIONS = 30


def told_finely(fitted: FittedModel) -> FittedModel:
    """Return the model with such steps that half of one moves no estimate by much.

    What is far below the noise in every sample adds up in thousands of them: a small
    inductance takes what a step has lost.
    """
    while fitted.problem.model.n_states and fitted.optimum.theta.size:
        solver = fitted.problem.solver
        if solver.substeps >= MOST_SUBSTEPS:
            return fitted
        finer = replace(solver, substeps=2 * solver.substeps)
        stepped = simulated_as(fitted, finer, fitted.problem.hold)
        if stepped is fitted:
            return fitted
        moved = np.abs(stepped.optimum.theta - fitted.optimum.theta)
        std = uncertainty(stepped.problem, stepped.optimum).std
        if not np.any(moved > MOVED * std):  # what is not determined has none
            return fitted
        fitted = stepped
    return fitted


def simulated_as(fitted: FittedModel, solver: Solver, hold: Hold) -> FittedModel:
    """Return the model fitted anew, from where it was, with other steps or inputs."""
    problem = replace(fitted.problem, solver=solver, hold=hold)
    optimum = minimise(
        problem, fitted.optimum.theta, fitted.optimum.initial, iterations=ITERATIONS
    )
    if not np.isfinite(optimum.cost):
        return fitted
    return replace(fitted, problem=problem, optimum=optimum)
