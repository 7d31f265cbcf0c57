"""Fit a graph's parameters to recordings: the pieces put together."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.automatic import accumulates, automatic_horizon, choose_horizon
from bondgraph.fitting.first_states import first_guess
from bondgraph.fitting.fitted import FittedModel
from bondgraph.fitting.horizon import Automatic, cut
from bondgraph.fitting.levenberg_marquardt import Optimum, minimise
from bondgraph.fitting.loss import SquaredError, scale_of
from bondgraph.fitting.noise import WhiteNoise, lag_one
from bondgraph.fitting.posing import pose, prepare
from bondgraph.fitting.problem import FitProblem, Linearisation
from bondgraph.fitting.result import FitResult
from bondgraph.fitting.settings import FitSettings
from bondgraph.fitting.solving import solve, solve_from
from bondgraph.fitting.starts import ManyStarts
from bondgraph.fitting.told import report
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.model_channels import matched, refuse_twice
from bondgraph.structure.graph import FinishedGraph

__all__ = [
    "FitSettings",
    "FittedModel",
    "accumulates",
    "choose_horizon",
    "first_guess",
    "fit",
    "fit_model",
    "pose",
    "prepare",
    "solve",
    "weigh",
]

Array = NDArray[np.float64]
RESCALINGS = 4
SAME_SCALE = 0.05
"""Residual scales within this share of each other weigh the outputs alike."""

SAME_COLOUR = 0.02


def fit(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    *,
    settings: FitSettings | None = None,
) -> FitResult:
    """Fit the free parameters of a model to recordings by simulation error.

    Parameters
    ----------
    graph
        The model. Parameters with ``std=0.0`` stay; those with a positive std are held
        by it; those with None are free.
    recordings
        One or several, each with its own initial states.

    Raises
    ------
    FitError, ParameterError
        If nothing can be fitted: no output, a parameter without a value.
    RecordingError
        If there is no recording, one is given twice, or one is of another model.
    """
    chosen = FitSettings() if settings is None else settings
    recordings = matched(graph, recordings)
    refuse_twice(recordings)
    return report(fit_model(graph, recordings, chosen), graph, recordings)


def fit_model(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    settings: FitSettings,
    *,
    sigma: Array | None = None,
) -> FittedModel:
    """Fit, choosing the horizon and the residual scales where they are not given."""
    model, recordings = prepare(graph), matched(graph, recordings)
    horizon, start = settings.horizon, None
    if isinstance(horizon, Automatic):
        horizon, start = automatic_horizon(graph, model, recordings, settings)
    problem = pose(graph, model, cut(recordings, horizon), settings, sigma)
    if start is None or isinstance(settings.starts, ManyStarts):
        optimum = solve_from(
            problem, settings.starts, settings.strategy, settings.iterations
        )
    else:
        optimum = minimise(
            problem, start.theta, start.initial, iterations=settings.iterations
        )
    if sigma is None:
        problem, optimum = weigh(problem, optimum, settings)
    return FittedModel(graph=graph, problem=problem, optimum=optimum, horizon=horizon)


def weigh(
    problem: FitProblem, optimum: Optimum, settings: FitSettings
) -> tuple[FitProblem, Optimum]:
    """Return the fit with each output weighed by its own residual, and its colour.

    The residual scale weighs outputs against each other and against priors, and so
    depends on the optimum that depends on it.
    """
    for _ in range(RESCALINGS):
        scale = residual_scale(problem, optimum)
        phi = _colour(problem, optimum, settings)
        same_scale = np.allclose(scale, problem.sigma, rtol=SAME_SCALE, atol=0.0)
        same_colour = np.allclose(phi, problem.correlation, rtol=0.0, atol=SAME_COLOUR)
        if not np.isfinite(scale).all() or (same_scale and same_colour):
            break
        heavier = replace(problem, sigma=scale, correlation=phi)
        if same_colour and _weighs_nothing(problem):
            optimum = _scaled(optimum, float(problem.sigma[0] / scale[0]) ** 2)
        else:
            optimum = minimise(
                heavier,
                optimum.theta,
                optimum.initial,
                iterations=settings.iterations,
            )
        problem = heavier
    return problem, optimum


def _colour(problem: FitProblem, optimum: Optimum, settings: FitSettings) -> Array:
    if isinstance(settings.noise, WhiteNoise):
        return np.zeros_like(problem.sigma)
    return lag_one(
        optimum.linearisation.residuals, problem.shots.edges, len(optimum.theta)
    )


def _weighs_nothing(problem: FitProblem) -> bool:
    """Return whether the residual scale has nothing to weigh against."""
    alone = len(problem.sigma) == 1 and isinstance(problem.loss, SquaredError)
    return alone and not np.isfinite(problem.prior_std[problem.free]).any()


def _scaled(optimum: Optimum, factor: float) -> Optimum:
    """Return the optimum with all squared residuals times `factor`."""
    at = optimum.linearisation
    scaled = Linearisation(
        at.residuals * np.sqrt(factor),
        at.hessian * factor,
        at.slope * factor,
        at.cost * factor,
        at.states,
    )
    return replace(optimum, linearisation=scaled, cost=optimum.cost * factor)


def residual_scale(problem: FitProblem, optimum: Optimum) -> Array:
    """Return the size of the residuals per output, by the loss's measure; never 0."""
    measured = np.isfinite(problem.shots.outputs)
    size = [
        scale_of(problem.loss, column[known])
        for column, known in zip(
            optimum.linearisation.residuals.T, measured.T, strict=True
        )
    ]
    scale: Array = problem.sigma * np.maximum(size, 1e-12)
    return scale
