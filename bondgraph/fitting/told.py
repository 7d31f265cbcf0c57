"""What a fit says of itself: estimates, errors, and what it does not determine."""

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.certainty.combinations import barely_known, combination_sentences
from bondgraph.fitting.certainty.identifiability import RECORDED, around
from bondgraph.fitting.certainty.solver_error import solver_error
from bondgraph.fitting.certainty.uncertainty import Uncertainty, uncertainty
from bondgraph.fitting.fitted import FittedModel
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.fitting.levenberg_marquardt import Optimum
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.result import Estimate, FitResult, FitStatus, Score
from bondgraph.numeric.model import NumericModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.spread import changes, spread
from bondgraph.simulation.shooting import Shots
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Fitted as FittedSource

Array = NDArray[np.float64]


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
