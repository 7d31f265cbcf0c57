"""The plainer law, where what a wider one adds turns out to be nothing.

The search compares laws over short windows; the final fit, over the horizon that suits
it, knows the parameters better. Where all that a law has beyond a narrower one is there
zero within its error, or not determined, the narrower one is told. The wider one is
refuted, or left open where the recordings leave it open. A narrower one that short
windows did not decide has to fit as well in the end.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.addition import added_strengths, seen_again
from bondgraph.diagnosis.evidence.confidence import probability
from bondgraph.diagnosis.evidence.decision import best_supported
from bondgraph.diagnosis.evidence.judged import Judged, Rule
from bondgraph.diagnosis.evidence.left_out import left_out_errors
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.base.horizons import sharpened
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.diagnosis.search.round_found import Round, accepted, chosen_in
from bondgraph.diagnosis.search.trials.worth import LOST_FROM_THE_START
from bondgraph.diagnosis.work.limit import Limit
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording

MOST_WIDER = 3
"""So many wider laws at most are fitted to the end beside a narrower one."""


def without_needless_parts(
    rounds: Sequence[Round],
    final: FittedModel,
    recordings: Sequence[BoundRecording],
    options: Options,
    limit: Limit,
) -> tuple[list[Round], FittedModel]:
    """Return the rounds and the final model with plainer laws where they suffice.

    What there is no time to see again stands as it was judged.
    """
    plain = list(rounds)
    for i, found in enumerate(rounds):
        narrower = _narrower(found)
        if narrower is None or not any(found is one for one in accepted(rounds)):
            continue
        if limit.passed:
            break
        elsewhere = _parameters([*plain[:i], *plain[i + 1 :]])
        wider = [
            wide
            for wide in _wider(found, narrower)
            if not elsewhere & set(wide.candidate.hypothesis.parameters)
        ]
        finals = {id(found.chosen): final}
        for wide in wider:
            if id(wide) not in finals and not limit.passed:
                chosen = [*plain[:i], replace(found, chosen=wide), *plain[i + 1 :]]
                finals[id(wide)] = _sharpened_with(chosen, final, recordings, options)
        wider = [wide for wide in wider if id(wide) in finals]
        seen = (
            seen_again(wide, narrower, finals[id(wide)], recordings) for wide in wider
        )
        again = dict(zip(map(id, wider), seen, strict=True))
        without = _without(found, narrower, again)
        if without.chosen is found.chosen:
            plain[i] = without
            continue
        told = [*plain[:i], without, *plain[i + 1 :]]
        fitted = _sharpened_with(told, final, recordings, options)
        if narrower.support is Support.SUPPORTED or as_good(
            fitted, final, options.rule
        ):
            plain, final = told, fitted
            other = _chosen_anew(without, options.rule)
            if other is not None and not limit.passed:
                told = [*plain[:i], other, *plain[i + 1 :]]
                fitted = _sharpened_with(told, final, recordings, options)
                if as_good(fitted, final, options.rule):
                    plain, final = told, fitted
    return plain, final


def _chosen_anew(found: Round, rule: Rule) -> Round | None:
    """Return the round with what is plainest of all, if that is not the narrower law.

    A wider law was chosen for what it had added: without that others may do as well.
    """
    narrower, best = found.chosen, best_supported(found.judged, rule)
    if narrower is None or best is None or best.physics in (CURVE, narrower.physics):
        return None
    before = left_out_errors(found.base, best.errors.chunks.size)
    sure = probability(best, found.judged, before, rule)
    return replace(found, chosen=best, probability=sure)


def as_good(plain: FittedModel, wide: FittedModel, rule: Rule) -> bool:
    """Return whether the final fit is as good without what the wider law adds.

    Each fit has scaled its errors by its own, so they are compared in one scale.
    """
    left, left_by_wide = (
        float(np.sum((one.residuals() / wide.problem.sigma) ** 2))
        for one in (plain, wide)
    )
    return left <= (1.0 + rule.materiality) * left_by_wide


def _parameters(rounds: Sequence[Round]) -> set[str]:
    """Return the parameters of what the rounds have chosen: each can be added once."""
    return {name for one in chosen_in(rounds) for name in one.hypothesis.parameters}


def _narrower(found: Round) -> Judged | None:
    """Return the narrowest law, not refuted, that the chosen one is or contains.

    One that only lost long stretches did so beside laws that may have been taken out
    since: it is not refuted here, the final fit decides.
    """
    chosen = found.chosen
    if chosen is None:
        return None
    contained = [
        j
        for j in found.judged
        if (j.support is not Support.REFUTED or j.reason == LOST_FROM_THE_START)
        and j.gain.value > 0.0
        and chosen.candidate.hypothesis.contains(j.candidate.hypothesis)
        and added_strengths(chosen, j)
    ]
    return max(
        contained,
        key=lambda j: (j.support is Support.SUPPORTED, j.gain.value),
        default=chosen,
    )


def _wider(found: Round, narrower: Judged) -> list[Judged]:
    """Return the best supported laws at the place that contain the narrower one.

    The chosen one first, which may be one of them.
    """
    wider = [
        j
        for j in found.judged
        if j.support is Support.SUPPORTED
        and j.candidate.hypothesis.contains(narrower.candidate.hypothesis)
        and added_strengths(j, narrower)
    ]
    wider.sort(key=lambda j: (j is not found.chosen, -j.gain.value))
    return wider[:MOST_WIDER]


def _without(found: Round, narrower: Judged, again: Mapping[int, Judged]) -> Round:
    """Return the round with wider laws as the final fit sees them.

    The narrower one is chosen where nothing of the chosen one stands.

    Parameters
    ----------
    again
        The wider laws as seen again, by the id of the law as judged.
    """
    judged = tuple(again.get(id(j), j) for j in found.judged)
    before = found.chosen
    after = again.get(id(before))
    if before is None or after is None or after is before:
        return replace(found, judged=judged)
    # The wider law is there the narrower one: what it takes away this one does, and the
    # resamples that it won this one has won.
    told = narrower
    if narrower.support is not Support.SUPPORTED:
        told = replace(
            before,
            candidate=narrower.candidate,
            reason=f"{before.reason}, in a wider form that adds nothing",
        )
        judged = tuple(told if j is narrower else j for j in judged)
    return replace(found, judged=judged, chosen=told)


def _sharpened_with(
    rounds: Sequence[Round],
    final: FittedModel,
    recordings: Sequence[BoundRecording],
    options: Options,
) -> FittedModel:
    """Return the final fit of the first model with what the rounds have chosen."""
    kept = chosen_in(rounds)
    values = {name: v for one in kept for name, v in one.fitted.values.items()}
    hypotheses = [one.hypothesis for one in kept]
    fitted = fitted_with(rounds[0].base, final, hypotheses, values)
    return sharpened(fitted, recordings, options, rounds[0].base)
