"""One round of search: the whole library, at every place of the current model.

Hypotheses are screened by what each promises, the best are fitted, the best of these
judged on left-out data, and of the supported ones the simplest is chosen.
"""

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import (
    CURVE,
    Candidate,
    Promised,
    Rejected,
)
from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.search.base.beyond_noise import explainable, left_beside
from bondgraph.diagnosis.search.base.runaway import run_away
from bondgraph.diagnosis.search.considered import Setting, considered, promising
from bondgraph.diagnosis.search.laws.beside_the_lead import with_fitted
from bondgraph.diagnosis.search.laws.curve_from_law import with_curve_drawn
from bondgraph.diagnosis.search.laws.elsewhere import begun_elsewhere
from bondgraph.diagnosis.search.laws.finer import finest_of
from bondgraph.diagnosis.search.laws.fits import (
    fit_best,
    fit_remembering,
    fit_whatever,
)
from bondgraph.diagnosis.search.laws.lag_or_store import lag_or_store
from bondgraph.diagnosis.search.laws.other_places import at_other_places
from bondgraph.diagnosis.search.laws.read_off import read_off
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.judging import Verdicts, judge_all
from bondgraph.diagnosis.search.trials.memory import REASON as FORGETS
from bondgraph.diagnosis.search.trials.screening import screen
from bondgraph.diagnosis.search.trials.worth import worth_judging
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.physics.hypothesis import Hypothesis

Array = NDArray[np.float64]

MUCH = 0.5
"""A residual of which so much is not noise, and of which no law with a name takes away
so much, is looked at again: what remembers promises little from afar, for it changes
what all other numbers are. Behind a first finding that would cost more than it has ever
shown.
"""

FAR_AWAY = 10.0
"""Of a model whose values have left the stated ones by so many times, what is found and
leaves much is held against all that promises nothing from there.
"""

LITTLE = 0.1
"""Who leaves no more than this share of what such a model left stands as it is."""

LED_ASTRAY = 3
"""How often what led is set aside because it remembers nothing beyond a window."""

HOPELESS = 0.75
"""A candidate with less than this share of the best reduction is not judged."""


def one_round(setting: Setting, shop: Workshop) -> Round:
    """Propose, screen, fit and judge; return what was found."""
    base, options, done = setting.base, setting.options, shop.limit.undone
    bench = Bench.of(base, shop, f"round {setting.number}")
    hypotheses = considered(setting)
    screened = screen(bench, hypotheses)
    leading = promising(screened.promised, options)
    seen = _led(setting, bench, leading, hypotheses, screened.independent)
    if setting.is_first and explainable(base, setting.noise) > MUCH:
        first = {id(one.hypothesis) for one in leading}
        others = [one for one in screened.promised if id(one.hypothesis) not in first]
        tried = screened.independent + len(others)
        # From a model that has run away no promise says anything.
        ways = (fit_whatever, fit_remembering) if run_away(base) else (fit_remembering,)
        for fit in ways:
            if not _suffices(seen, setting):
                # A curve that was found is to be drawn in the time there is.
                share = seen.verdicts.chosen is not None
                with shop.limit.shared() if share else nullcontext():
                    fitted = fit(bench, others, HOPELESS, options.judged)
                    seen = _judged(setting, bench, fitted, hypotheses, tried, seen)
    if setting.supported and not _suffices(seen, setting):
        # What remembers was worth its fit before, whatever it promises from here.
        first = {id(one.hypothesis) for one in leading}
        again = [
            one
            for one in screened.promised
            if one.hypothesis.told_by in setting.supported
            and id(one.hypothesis) not in first
        ]
        tried = screened.independent + len(again)
        fitted = fit_remembering(bench, again, HOPELESS, options.judged)
        seen = _judged(setting, bench, fitted, hypotheses, tried, seen)
    verdicts, chosen = seen.verdicts, seen.verdicts.chosen
    judged = with_curve_drawn(
        bench, verdicts, screened.independent, options.rule, setting.noise
    )
    drawn: dict[int, Judged] = {}
    if (
        chosen is not None
        and verdicts.before is not None
        and not setting.is_piece(chosen)
    ):
        drawn = finest_of(bench, chosen, judged, verdicts.before)
        chosen = next(iter(drawn.values()))
    kept = [drawn.get(id(j), j) for j in judged]
    return Round(
        base,
        len(hypotheses),
        screened.independent,
        tuple(kept),
        screened.promised,
        (*screened.rejected, *seen.rejected),
        chosen,
        verdicts.probability,
        cut_short=shop.limit.undone > done,
        before=verdicts.before,
    )


def _judged(
    setting: Setting,
    bench: Bench,
    fitted: Sequence[Candidate],
    hypotheses: Sequence[Hypothesis],
    tried: float,
    earlier: "_Seen | None" = None,
) -> "_Seen":
    """Judge what is material, there, determined, and remembers where it must.

    In the order of proposal: of twins the first is told. What was seen earlier in the
    round is decided anew with it.
    """
    base, recordings, rule = setting.base, setting.recordings, setting.options.rule
    least = rule.materiality / 2
    material = [_beside(c, setting.found) for c in fitted if c.reduction(base) >= least]
    worth, rejected = worth_judging(base, material, recordings)
    order = {one.told_by: i for i, one in enumerate(hypotheses)}
    worth.sort(key=lambda one: order.get(one.hypothesis.told_by, len(order)))
    seen = _Seen(Verdicts(), ()) if earlier is None else earlier
    verdicts = judge_all(
        bench, worth, tried, rule, setting.noise, setting.fault, seen.verdicts
    )
    return _Seen(verdicts, (*seen.rejected, *rejected))


def _led(
    setting: Setting,
    bench: Bench,
    leading: Sequence[Promised],
    hypotheses: Sequence[Hypothesis],
    tried: float,
) -> "_Seen":
    """Fit and judge what promises most, without what leads over windows alone.

    What remembers takes any value anew in every window. Where all that led did so, what
    came less far without is fitted to the end after all.
    """
    seen = _Seen(Verdicts(), ())
    for _ in range(1 + LED_ASTRAY):
        fitted = fit_best(bench, leading, HOPELESS, setting.options.judged)
        fitted = begun_elsewhere(bench, fitted, setting.noise)
        trials = at_other_places(setting.base, fitted, hypotheses)
        fitted = with_fitted(bench, fitted, trials, "the same elsewhere", HOPELESS)
        trials = lag_or_store(setting.base, fitted, hypotheses)
        fitted = with_fitted(bench, fitted, trials, "lags and stores", HOPELESS)
        trials = read_off(fitted, hypotheses)
        fitted = with_fitted(bench, fitted, trials, "laws along the curve", HOPELESS)
        seen = _judged(setting, bench, fitted, hypotheses, tried, seen)
        hollow = {r.hypothesis.told_by for r in seen.rejected if r.reason == FORGETS}
        others = [one for one in leading if one.hypothesis.told_by not in hollow]
        if seen.verdicts.chosen is not None or len(others) == len(leading):
            break
        leading = others
    return seen


def _beside(candidate: Candidate, found: Sequence[Hypothesis]) -> Candidate:
    """Return the candidate, as complex as what it adds to laws that it contains."""
    within = (one for one in found if candidate.hypothesis.contains(one))
    known = sum(len(one.parameters) for one in within)
    # What replaces as many numbers as it adds is as simple as the model itself.
    least = min(candidate.complexity, 1)
    return replace(candidate, complexity=max(candidate.complexity - known, least))


def _suffices(seen: "_Seen", setting: Setting) -> bool:
    """Return whether a law with a name was found that is most of it.

    And, of a model that has run away, not only from far away.
    """
    chosen = seen.verdicts.chosen
    if chosen is None or not seen.has_named:
        return False
    base, fitted = setting.base, chosen.candidate.fitted
    if left_beside(base, fitted, setting.noise) > MUCH:
        return False
    if not run_away(base, FAR_AWAY) or explainable(fitted, setting.noise) <= MUCH:
        return True
    return left_beside(base, fitted, setting.noise) <= LITTLE


@dataclass(frozen=True, slots=True)
class _Seen:
    """What was judged of some hypotheses, and which were not worth it."""

    verdicts: Verdicts
    rejected: tuple[Rejected, ...]

    @property
    def has_named(self) -> bool:
        """Whether a law with a name was chosen."""
        chosen = self.verdicts.chosen
        return chosen is not None and chosen.physics != CURVE
