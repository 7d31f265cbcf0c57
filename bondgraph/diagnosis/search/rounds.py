"""The search: physics is added one piece at a time until nothing more is supported.

Each round proposes the whole library at every place of the current model, screens it by
what each hypothesis promises, fits the best, judges the best of these on left-out data,
and hands the improved model on. What an addition makes needless is taken out again.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.answer.showing import simulate_whole
from bondgraph.diagnosis.evidence.decision import Judged, Rule
from bondgraph.diagnosis.evidence.gain import MERE_SHAPE, beside_earlier
from bondgraph.diagnosis.evidence.judging import Verdicts, judge_all
from bondgraph.diagnosis.evidence.left_out import MOST_CHUNKS
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.bench import Bench
from bondgraph.diagnosis.search.between_samples import (
    finely_stepped,
    held_as_fits,
    simulated_as,
)
from bondgraph.diagnosis.search.candidates import (
    CURVE,
    Candidate,
    Promised,
    Rejected,
    Screened,
    propose_all,
)
from bondgraph.diagnosis.search.determined import determined
from bondgraph.diagnosis.search.finer import as_fine_as_told
from bondgraph.diagnosis.search.fits import fit_best, fit_remembering
from bondgraph.diagnosis.search.memory import remembering
from bondgraph.diagnosis.search.removal import pruned, swallowed
from bondgraph.diagnosis.search.screening import screen
from bondgraph.diagnosis.work.workers import Here, Where, Workshop
from bondgraph.fitting.estimate import (
    FitSettings,
    FittedModel,
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
SAME = 1.02
"""Errors within this factor are the same."""

RUINED = 2.0
"""A law with which whole recordings are simulated so many times worse is not the one:
it fits by states that one has to know, a runaway of its own for instance.
"""

MUCH = 0.5
"""A residual of which so much is not noise, and of which nothing at all is found, is
looked at again: what remembers promises little from afar, for it changes what the other
numbers are. Behind a first finding that would cost more than it has ever shown.
"""

HOPELESS = 0.75
"""A candidate with less than this share of the best reduction is not judged."""


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
    fitted, judged
        How many hypotheses per round are fitted, and judged on left-out data, at most.
    most_findings
        Stop after so many.
    where
        Where hypotheses are tried: here, in processes, on an executor.
    resume
        A directory for the journal of what has been worked out: a diagnosis that was
        interrupted goes on from there. None for no journal.
    either_hold
        Whether inputs may behave between samples as suits the base model better,
        rather than as `settings` say.
    """

    settings: FitSettings = field(default_factory=FitSettings)
    rule: Rule = field(default_factory=Rule)
    library: tuple[AbstractPhysics, ...] = LIBRARY
    fitted: int = 40
    judged: int = 10
    most_findings: int = 5
    where: Where = field(default_factory=Here)
    resume: Path | None = None
    either_hold: bool = False


@dataclass(frozen=True, slots=True)
class Round:
    """What one round of search found.

    Parameters
    ----------
    base
        The model the round started from.
    tried
        How many hypotheses were considered.
    judged, promised, rejected
        Candidates judged on left-out data, what every hypothesis promised, and those
        that could not be tried or determined.
    chosen
        The one accepted, if any.
    probability
        Of its physics being the best of those judged.
    removed
        What earlier rounds had added and is needless beside it.
    """

    base: FittedModel
    tried: int = 0
    judged: tuple[Judged, ...] = ()
    promised: tuple[Promised, ...] = ()
    rejected: tuple[Rejected, ...] = ()
    chosen: Judged | None = None
    probability: float | None = None
    removed: tuple[Hypothesis, ...] = ()


def search(
    base: FittedModel,
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    shop: Workshop,
) -> list[Round]:
    """Add supported physics piece by piece; the last round has found nothing more.

    Parameters
    ----------
    recordings
        Those that the base model was fitted to.
    noise
        Residual per output that noise excuses, 0 where it is not known: what lies
        within it is not searched for physics.
    """
    rounds: list[Round] = []
    gains: list[float] = []
    current, authored = base, base.graph.parameters
    added: tuple[Hypothesis, ...] = ()
    while True:
        number = len(rounds) + 1
        if number > options.most_findings or within(current, noise, options.rule):
            return [*rounds, Round(current)]
        # Where a named law has explained nearly all, a free curve would only bend it.
        much = left_beside(base, current, noise) > options.rule.materiality
        found = _one_round(
            current, recordings, noise, options, number, shop, curves=much
        )
        if found.chosen is None:
            return [*rounds, found]
        candidate = found.chosen.candidate
        added = (*added, candidate.hypothesis)
        shop.progress(f"round {number}: trying without what was added before")
        left = pruned(base, current, candidate.fitted, added, options.rule)
        if rounds:
            lost = swallowed(current, left.fitted, left.kept[:-1], authored)
            if lost is not None:
                return [*rounds, _given_up(found, lost)]
        rounds.append(replace(found, removed=left.removed))
        current, added = finely_stepped(left.fitted, noise), left.kept
        if options.either_hold:
            current = held_as_fits(current)
        now = current.problem
        if (now.solver, now.hold) != (base.problem.solver, base.problem.hold):
            base = simulated_as(base, now.solver, now.hold)
        gains.append(found.chosen.gain.value)
        if beside_earlier(gains)[-1] < MERE_SHAPE:
            return [*rounds, Round(current)]


def _given_up(found: Round, lost: str) -> Round:
    """Return the round without its choice, which stands in for what was there."""
    reason = f"leaves nothing of {lost}, and came after it"
    judged = tuple(
        replace(j, support=Support.REFUTED, reason=reason) if j is found.chosen else j
        for j in found.judged
    )
    return replace(found, judged=judged, chosen=None, probability=None)


def within(fitted: FittedModel, noise: Array, rule: Rule) -> bool:
    """Return whether what a model leaves is too near the noise to be worth a search."""
    return explainable(fitted, noise) < rule.materiality


def explainable(fitted: FittedModel, noise: Array) -> float:
    """Return the largest share of an output's squared residual that is not noise."""
    power = np.nanmean(fitted.residuals() ** 2, axis=0)
    share = 1.0 - noise**2 / np.where(power > 0.0, power, np.inf)
    return float(np.max(np.where(power > 0.0, share, 0.0), initial=0.0))


def left_beside(first: FittedModel, current: FittedModel, noise: Array) -> float:
    """Return the share of what `first` left beyond the noise that `current` leaves."""
    before, after = (
        float(np.sum(np.maximum(power - noise**2, 0.0) / first.problem.sigma**2))
        for power in (
            np.nanmean(fitted.residuals() ** 2, axis=0) for fitted in (first, current)
        )
    )
    return after / before if before > 0.0 else 0.0


def search_settings(
    graph: FinishedGraph, recordings: Sequence[BoundRecording], settings: FitSettings
) -> FitSettings:
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
    noise, not what still is left out, makes the residual. Where whole recordings are
    then simulated worse than before, the search's own fit is kept.
    """
    settings = replace(
        options.settings, solver=fitted.problem.solver, hold=fitted.problem.hold
    )
    graph = fitted.graph.with_parameters(fitted.values)
    if isinstance(settings.horizon, Automatic):
        model = fitted.problem.model
        horizon = choose_horizon(graph, model, recordings, settings)
        settings = replace(settings, horizon=horizon)
    refitted = fit_model(graph, recordings, settings)
    before, after = (
        simulate_whole(one, recordings).score.nrmse for one in (fitted, refitted)
    )
    return refitted if after <= SAME * before else fitted


def _one_round(
    base: FittedModel,
    recordings: Sequence[BoundRecording],
    noise: Array,
    options: Options,
    number: int,
    shop: Workshop,
    *,
    curves: bool,
) -> Round:
    bench = Bench.of(base, shop, f"round {number}")
    hypotheses = tuple(
        hypothesis
        for hypothesis in propose_all(base, options.library)
        if (curves or hypothesis.physics != CURVE)
        # A wrong sign or unit shows before anything else. Beside a law that has been
        # found it would only bend it: in a unit a thousand times larger every smooth
        # edge is a sharp one.
        and (number == 1 or not hypothesis.is_slip)
    )
    screened = screen(bench, hypotheses)
    before = simulate_whole(base, recordings).score.nrmse

    def holds(candidate: Candidate) -> bool:
        after = simulate_whole(candidate.fitted, recordings).score.nrmse
        return not after > RUINED * before

    def judged(fitted: Sequence[Candidate], tried: float) -> _Look:
        least = options.rule.materiality / 2
        material = [c for c in fitted if c.reduction(base) >= least]
        known, undetermined = determined(base, material)
        worth, forgetful = remembering(base, known, recordings)
        order = {id(hypothesis): i for i, hypothesis in enumerate(hypotheses)}
        worth.sort(key=lambda candidate: order[id(candidate.hypothesis)])
        verdicts = judge_all(bench, worth, tried, options.rule, noise, holds)
        return _Look(verdicts, (*undetermined, *forgetful))

    promising = _promising(screened, options)
    tried = screened.independent
    look = judged(fit_best(bench, promising, HOPELESS, options.judged), tried)
    nothing = number == 1 and look.verdicts.chosen is None
    if nothing and explainable(base, noise) > MUCH:
        first = {id(one.hypothesis) for one in promising}
        others = [one for one in screened.promised if id(one.hypothesis) not in first]
        found = fit_remembering(bench, others, HOPELESS, options.judged)
        look = look.with_another(judged(found, tried + len(others)))
    verdicts, first_choice = look.verdicts, look.verdicts.chosen
    chosen = None if first_choice is None else as_fine_as_told(bench, first_choice)
    kept = [chosen if j is first_choice and chosen else j for j in verdicts.judged]
    return Round(
        base,
        len(hypotheses),
        tuple(kept),
        screened.promised,
        (*screened.rejected, *look.rejected),
        chosen,
        verdicts.probability,
    )


@dataclass(frozen=True, slots=True)
class _Look:
    """What was judged of some hypotheses, and which were not worth it."""

    verdicts: Verdicts
    rejected: tuple[Rejected, ...]

    def with_another(self, other: "_Look") -> "_Look":
        """Return both looks, with what the other has chosen."""
        both = (*self.verdicts.judged, *other.verdicts.judged)
        verdicts = replace(other.verdicts, judged=both)
        return _Look(verdicts, (*self.rejected, *other.rejected))


def _promising(screened: Screened, options: Options) -> list[Promised]:
    """Return the hypotheses worth a fit, those that promise most first."""
    worth = options.rule.materiality / 4
    return [promised for promised in screened.promised if promised.reduction >= worth][
        : options.fitted
    ]
