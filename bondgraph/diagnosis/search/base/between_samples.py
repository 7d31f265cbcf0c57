"""Steps between samples: chosen on the base model, before any physics is looked for.

The error of too long a step would else be found as physics.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.base.steps import explicit_steps, left
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.fine_steps import simulated_as
from bondgraph.fitting.step_error import MOST_SUBSTEPS, step_error
from bondgraph.simulation.solvers import RungeKutta4, Sdirk2

Array = NDArray[np.float64]
OF_NOISE, OF_RESIDUAL = 0.3, 0.03
"""Of the noise and of what the model leaves: a step's error below these is fine."""


def finely_stepped(fitted: FittedModel, noise: Array) -> FittedModel:
    """Return the model with such steps that half of one changes nothing.

    Explicit ones where they do, for they are many times cheaper.

    Parameters
    ----------
    noise
        Standard deviation per output, 0 where it is not known.
    """
    if not fitted.problem.model.n_states:
        return fitted
    explicit = explicit_steps(fitted.problem, fitted.optimum, _fine(fitted, noise))
    if explicit == fitted.problem.solver:
        return fitted
    if explicit is not None:
        return simulated_as(fitted, explicit, fitted.problem.hold)
    if isinstance(fitted.problem.solver, RungeKutta4):
        fitted = simulated_as(fitted, Sdirk2(), fitted.problem.hold)
    while not _is_fine(fitted, noise):
        solver = fitted.problem.solver
        finer = replace(solver, substeps=2 * solver.substeps)
        stepped = simulated_as(fitted, finer, fitted.problem.hold)
        if stepped is fitted:
            break
        fitted = stepped
    return fitted


def _is_fine(fitted: FittedModel, noise: Array) -> bool:
    if fitted.problem.solver.substeps >= MOST_SUBSTEPS:
        return True
    change = step_error(fitted.problem, fitted.optimum.theta, fitted.optimum.initial)
    return bool(np.all(change <= _fine(fitted, noise)))


def _fine(fitted: FittedModel, noise: Array) -> Array:
    """Return the error of a step, per output, that is none."""
    residual = left(fitted.problem, fitted.optimum.linearisation)
    return np.maximum(OF_NOISE * noise, OF_RESIDUAL * residual)
