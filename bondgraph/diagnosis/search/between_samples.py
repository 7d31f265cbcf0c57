"""What happens between samples: how inputs behave there, and how finely to step.

Both are chosen on the base model, before any physics is looked for. Half a sample of
delay, or the error of too long a step, would else be found as physics.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.steps import explicit_steps, left
from bondgraph.fitting.estimate import FitSettings, FittedModel, fit_model
from bondgraph.fitting.fine_steps import simulated_as
from bondgraph.fitting.step_error import MOST_SUBSTEPS, step_error
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.commands import go_in_steps
from bondgraph.simulation.solvers import Hold, RungeKutta4, Sdirk2
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
FITS_BETTER = 0.98
"""The other way inputs can behave must leave less than this share of the error."""

OF_NOISE, OF_RESIDUAL = 0.3, 0.03
"""Of the noise and of what the model leaves: a step's error below these is fine."""


def fitted_either_way(
    graph: FinishedGraph, recordings: Sequence[BoundRecording], settings: FitSettings
) -> FittedModel:
    """Return the model fitted with inputs joined by lines or held, as fits better.

    Where both fit alike, held if they stay the same from most samples to the next: so
    does a command that goes in steps.
    """
    if go_in_steps(recordings):
        settings = replace(settings, hold=Hold.ZERO)
    own = fit_model(graph, recordings, settings)
    if not own.problem.model.input_names or not own.problem.model.n_states:
        return own
    other = Hold.ZERO if settings.hold is Hold.FIRST else Hold.FIRST
    changed = replace(settings, hold=other)
    rival = fit_model(graph, recordings, changed, sigma=own.problem.sigma)
    return rival if rival.optimum.cost < FITS_BETTER * own.optimum.cost else own


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


def held_as_fits(fitted: FittedModel) -> FittedModel:
    """Return the model with inputs held or joined, as fits better from where it is.

    What a base model leaves hides a difference that shows once it has been explained.
    """
    if not fitted.problem.model.input_names or not fitted.problem.model.n_states:
        return fitted
    other = Hold.ZERO if fitted.problem.hold is Hold.FIRST else Hold.FIRST
    rival = simulated_as(fitted, fitted.problem.solver, other)
    return rival if rival.optimum.cost < FITS_BETTER * fitted.optimum.cost else fitted


def _is_fine(fitted: FittedModel, noise: Array) -> bool:
    if fitted.problem.solver.substeps >= MOST_SUBSTEPS:
        return True
    change = step_error(fitted.problem, fitted.optimum.theta, fitted.optimum.initial)
    return bool(np.all(change <= _fine(fitted, noise)))


def _fine(fitted: FittedModel, noise: Array) -> Array:
    """Return the error of a step, per output, that is none."""
    residual = left(fitted.problem, fitted.optimum.linearisation)
    return np.maximum(OF_NOISE * noise, OF_RESIDUAL * residual)
