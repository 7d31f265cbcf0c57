"""Fit a graph's parameters to recordings: the pieces put together."""

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.automatic import accumulates, automatic_horizon, choose_horizon
from bondgraph.fitting.certainty.combinations import barely_known, combination_sentences
from bondgraph.fitting.certainty.identifiability import RECORDED, around
from bondgraph.fitting.certainty.solver_error import solver_error
from bondgraph.fitting.certainty.uncertainty import Uncertainty, uncertainty
from bondgraph.fitting.first_states import first_guess
from bondgraph.fitting.fitted import FittedModel
from bondgraph.fitting.horizon import Automatic, WholeRecordings, cut
from bondgraph.fitting.levenberg_marquardt import Optimum, minimise
from bondgraph.fitting.loss import SquaredError, scale_of
from bondgraph.fitting.noise import WhiteNoise, lag_one
from bondgraph.fitting.posing import pose, prepare
from bondgraph.fitting.problem import FitProblem, Linearisation
from bondgraph.fitting.result import Estimate, FitResult, FitStatus, Score
from bondgraph.fitting.settings import FitSettings
from bondgraph.fitting.solving import solve, solve_from
from bondgraph.fitting.starts import ManyStarts
from bondgraph.numeric.model import NumericModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.model_channels import matched, refuse_twice
from bondgraph.recordings.spread import changes, spread
from bondgraph.simulation.shooting import Shots
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Fitted as FittedSource

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
    "report",
    "score",
    "solve",
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
    refuse_twice(recordings)
    recordings = matched(graph, recordings)
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


def score(
    model: NumericModel,
    shots: Shots,
    residuals: Array,
) -> Score:
    """Return the size of residuals per output, and relative to the outputs' spread.

    Not a number where a measured sample was not simulated. Outputs that never change
    have no spread and are left out of what is relative; where none changes that is not
    a number either.
    """
    measured = np.isfinite(shots.outputs)
    squared = np.where(measured, residuals, 0.0) ** 2
    rmse = np.sqrt(squared.sum(axis=0) / np.maximum(measured.sum(axis=0), 1))
    moving = changes(shots.outputs)
    relative = rmse[moving] / spread(shots.outputs)[moving]
    return Score(
        nrmse=float(np.sqrt(np.mean(relative**2))) if moving.any() else math.nan,
        rmse=dict(zip(model.output_names, map(float, rmse), strict=True)),
        unchanging=tuple(
            name
            for name, moves in zip(model.output_names, moving, strict=True)
            if not moves
        ),
    )


def report(
    fitted: FittedModel, start: FinishedGraph, recordings: Sequence[BoundRecording]
) -> FitResult:
    """Return the fit as the record users see."""
    problem, optimum = fitted.problem, fitted.optimum
    names = fitted.free_names
    known = uncertainty(problem, optimum)
    sources = tuple(recording.name for recording in recordings)
    estimates = _estimates(fitted, start, known)
    coloured = bool(problem.correlation.any())
    phi = zip(problem.model.output_names, map(float, problem.correlation), strict=False)
    return FitResult(
        status=_status(problem, optimum, known),
        model=with_estimates(fitted.graph, estimates, sources),
        estimates=estimates,
        score=score(problem.model, problem.shots, fitted.residuals()),
        cost=optimum.cost,
        iterations=optimum.iterations,
        unidentifiable=_unidentifiable(fitted, known),
        window=_window_seconds(fitted),
        covariance=tuple(tuple(map(float, row)) for row in known.covariance),
        barely_known=barely_known(names, optimum.theta, known.covariance, known.std),
        solver_error=solver_error(
            problem, optimum, inverse=known.inverse, std=known.std, names=names
        )
        if math.isfinite(optimum.cost)
        else None,
        correlation=dict(phi) if coloured else {},
        fitted=fitted,
    )


def _estimates(
    fitted: FittedModel, start: FinishedGraph, known: Uncertainty
) -> tuple[Estimate, ...]:
    theta, problem = fitted.optimum.theta, fitted.problem
    reach = known.quantile * known.std
    low = np.maximum(theta - reach, problem.low[problem.free])
    high = np.minimum(theta + reach, problem.high[problem.free])
    estimates = []
    for i, name in enumerate(fitted.free_names):
        before = start.parameters.get(name)
        told = math.isfinite(known.std[i])
        estimates.append(
            Estimate(
                name=name,
                value=float(theta[i]),
                std=float(known.std[i]) if told else None,
                unit=fitted.graph.parameters[name].unit,
                start=before.value if before is not None else None,
                interval=(float(low[i]), float(high[i])) if told else None,
            )
        )
    return tuple(estimates)


def _unidentifiable(fitted: FittedModel, known: Uncertainty) -> tuple[str, ...]:
    if not len(known.null):
        return ()
    optimum = fitted.optimum
    points = around(
        fitted.problem, optimum.theta, optimum.initial, np.random.default_rng(0)
    )
    names = fitted.free_names
    told = combination_sentences(names, points, RECORDED) if points else ()
    words = {word for sentence in told for word in re.findall(r"\w+", sentence)}
    # What acts nearby may act on nothing just where the fit has ended.
    silent = (n for n, s in zip(names, known.std, strict=True) if not math.isfinite(s))
    told = (*told, *(f"{n} acts on nothing there" for n in silent if n not in words))
    effect = np.einsum("wii->i", optimum.linearisation.hessian)
    acting = [n for n, own in zip(names, effect, strict=False) if own > 0.0]
    return tuple(_of_beginnings(sentence, acting) for sentence in told)


def _of_beginnings(sentence: str, acting: Sequence[str]) -> str:
    """Return what to say of a number that acts, as other initial states would too."""
    for name in acting:
        if sentence.startswith((f"{name} has no effect", f"{name} acts on nothing")):
            return f"{name} cannot be told from the states in which recordings begin"
    return sentence


def _status(problem: FitProblem, optimum: Optimum, known: Uncertainty) -> FitStatus:
    if not math.isfinite(optimum.cost):
        return FitStatus.SIMULATION_FAILED
    if not len(problem.free):
        return FitStatus.NO_FREE_PARAMETERS
    if len(known.null) == len(problem.free):
        return FitStatus.NO_EFFECT
    return FitStatus.CONVERGED if optimum.converged else FitStatus.ITERATION_LIMIT


def _window_seconds(fitted: FittedModel) -> float | None:
    if isinstance(fitted.horizon, WholeRecordings):
        return None
    time = fitted.problem.shots.time
    lengths = [time[s.stop - 1] - time[s.start] for s in fitted.problem.shots.slices]
    return float(np.median(lengths))


def with_estimates(
    graph: FinishedGraph, estimates: Sequence[Estimate], sources: tuple[str, ...]
) -> FinishedGraph:
    """Return the graph with the estimated values and where they come from.

    The std of a parameter stays what was known before the fit, so that the model can be
    fitted again.
    """
    found = {estimate.name: estimate for estimate in estimates}
    return graph.with_parameters(
        [
            replace(
                member,
                value=_inside(found[member.name].value, member.bounds),
                source=FittedSource(sources),
            )
            for member in graph.parameters.members
            if member.name in found
        ]
    )


def _inside(value: float, bounds: tuple[float, float]) -> float:
    return min(max(value, bounds[0]), bounds[1])
