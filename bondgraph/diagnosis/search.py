"""The search: physics is added one piece at a time until nothing more is supported.

Each round proposes the whole library at every junction of the current model, screens by
short refits, judges the best on left-out data, and hands the improved model on.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import (
    Candidate,
    Rejected,
    complete,
    nested,
    propose_all,
    screen,
)
from bondgraph.diagnosis.decision import CURVE, Judged, Rule, best_supported, judge
from bondgraph.diagnosis.evidence import (
    MOST_CHUNKS,
    LeftOutErrors,
    chunk_count,
    left_out_errors,
)
from bondgraph.fitting.estimate import (
    FittedModel,
    Settings,
    accumulates,
    choose_horizon,
    fit_model,
    prepare,
)
from bondgraph.fitting.horizon import (
    SHORTEST,
    Automatic,
    Horizon,
    WholeRecordings,
    Windows,
)
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.library import LIBRARY
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
Progress = Callable[[str], None]

HOPELESS = 0.75
"""A candidate with less than this share of the best reduction is not judged."""

TWINS = 1e-3
"""Candidates whose residuals differ by less than this share predict the same."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """Choices of a diagnosis.

    Parameters
    ----------
    settings
        Of the fits.
    rule
        When a candidate counts.
    library
        The physics considered.
    judged
        How many candidates per round are judged on left-out data at most.
    most_findings
        Stop after so many.
    """

    settings: Settings = field(default_factory=Settings)
    rule: Rule = field(default_factory=Rule)
    library: tuple[AbstractPhysics, ...] = LIBRARY
    judged: int = 10
    most_findings: int = 3


@dataclass(frozen=True, slots=True)
class Round:
    """What one round of search found.

    Parameters
    ----------
    base
        The model the round started from.
    tried
        How many hypotheses were considered.
    judged, screened, rejected
        Candidates judged on left-out data, those fitted briefly, and hypotheses that
        could not be tried.
    chosen
        The one accepted, if any.
    """

    base: FittedModel
    tried: int = 0
    judged: tuple[Judged, ...] = ()
    screened: tuple[Candidate, ...] = ()
    rejected: tuple[Rejected, ...] = ()
    chosen: Judged | None = None


def search(
    base: FittedModel,
    noise: Array,
    options: Options,
    progress: Progress,
) -> list[Round]:
    """Add supported physics piece by piece; the last round has found nothing more.

    Parameters
    ----------
    noise
        Residual per output that noise excuses, 0 where it is not known: what lies
        within it is not searched for physics.
    """
    rounds: list[Round] = []
    current = base
    while True:
        found = _one_round(current, noise, options, len(rounds) + 1, progress)
        rounds.append(found)
        if found.chosen is None:
            return rounds
        current = found.chosen.candidate.fitted


def explainable(fitted: FittedModel, noise: Array) -> float:
    """Return the largest share of an output's squared residual that is not noise."""
    power = np.nanmean(fitted.residuals() ** 2, axis=0)
    share = 1.0 - noise**2 / np.where(power > 0.0, power, np.inf)
    return float(np.max(np.where(power > 0.0, share, 0.0), initial=0.0))


def search_settings(
    graph: FinishedGraph, recordings: Sequence[BoundRecording], settings: Settings
) -> Settings:
    """Return the settings with a horizon for searching, where it is automatic.

    A plant on which errors accumulate is cut into as many windows as there are chunks:
    long enough that what is missing stands out of the noise, and independent, so that
    drift within one window says nothing about another.
    """
    if not isinstance(settings.horizon, Automatic):
        return settings
    model = prepare(graph)
    horizon: Horizon = WholeRecordings()
    if model.n_states and accumulates(graph, model, recordings, settings):
        samples = sum(len(recording) for recording in recordings) // MOST_CHUNKS
        horizon = Windows(max(samples, SHORTEST))
    return replace(settings, horizon=horizon)


def sharpened(
    fitted: FittedModel, recordings: Sequence[BoundRecording], options: Options
) -> FittedModel:
    """Return the final model refitted over the horizon that suits it.

    The search needs many windows; the parameters need windows over which measurement
    noise, not what still is left out, makes the residual.
    """
    settings = options.settings
    graph = fitted.graph.with_parameters(fitted.values)
    if isinstance(settings.horizon, Automatic):
        model = fitted.problem.model
        horizon = choose_horizon(graph, model, recordings, settings)
        settings = replace(settings, horizon=horizon)
    return fit_model(graph, recordings, settings)


def _one_round(
    base: FittedModel, noise: Array, options: Options, number: int, progress: Progress
) -> Round:
    if explainable(base, noise) < options.rule.materiality:
        return Round(base)
    if number > options.most_findings:
        return Round(base)
    # After a named law, a free curve would only bend that law a little further.
    hypotheses = tuple(
        hypothesis
        for hypothesis in propose_all(base, options.library)
        if number == 1 or hypothesis.physics != CURVE
    )
    screened, rejected = screen(
        base,
        hypotheses,
        options.rule.materiality / 4,
        lambda what: progress(f"round {number}: trying {what}"),
    )
    worth = _worth_judging(screened, base, hypotheses, options)
    judged = _judge_all(worth, base, len(hypotheses), options, number, progress)
    chosen = best_supported(judged, options.rule)
    return Round(base, len(hypotheses), tuple(judged), screened, rejected, chosen)


def _worth_judging(
    screened: Sequence[Candidate],
    base: FittedModel,
    hypotheses: Sequence[Hypothesis],
    options: Options,
) -> list[Candidate]:
    """Return the candidates to judge, in the order they were proposed."""
    if not screened:
        return []
    best = screened[0].reduction(base)
    least = max(options.rule.materiality / 2, HOPELESS * best)
    kept = [c for c in screened if c.reduction(base) >= least][: options.judged]
    order = {id(hypothesis): i for i, hypothesis in enumerate(hypotheses)}
    return sorted(kept, key=lambda c: order[id(c.hypothesis)])


def _judge_all(
    worth: Sequence[Candidate],
    base: FittedModel,
    tried: int,
    options: Options,
    number: int,
    progress: Progress,
) -> list[Judged]:
    """Judge candidates on left-out data; twins share their errors."""
    judged: list[Judged] = []
    if not worth:
        return judged
    best = min(worth, key=lambda candidate: candidate.fitted.optimum.cost)
    chunks = chunk_count(best.fitted)
    before = left_out_errors(base, chunks)
    for candidate in nested([complete(candidate) for candidate in worth]):
        hypothesis = candidate.hypothesis
        progress(f"round {number}: judging {hypothesis.physics} at {hypothesis.place}")
        errors = _twin_errors(candidate, judged)
        if errors is None:
            errors = left_out_errors(candidate.fitted, chunks)
        judged.append(judge(candidate, before, errors, tried, options.rule))
    return judged


def _twin_errors(
    candidate: Candidate, judged: Sequence[Judged]
) -> LeftOutErrors | None:
    """Return the errors of a candidate already judged that predicts the same."""
    own = candidate.fitted.optimum.linearisation.residuals
    size = float(np.linalg.norm(own))
    for other in judged:
        if other.candidate.complexity != candidate.complexity:
            continue
        difference = own - other.candidate.fitted.optimum.linearisation.residuals
        if float(np.linalg.norm(difference)) <= TWINS * size:
            return other.errors
    return None
