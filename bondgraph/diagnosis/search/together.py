"""Two together: a pair of laws judged as one candidate, where none alone is supported.

It is one among as many as there are pairs of what was tried, has to take away half of
what is left, and each of the two must be needed beside the other. What is accepted goes
on record as two rounds, so that each law is told with what may stand in its place
beside the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt

from bondgraph.diagnosis.answer.showing import simulate_whole
from bondgraph.diagnosis.answer.wording import name_of
from bondgraph.diagnosis.evidence.decision import (
    Judged,
    Rule,
    alike,
    best_supported,
    judge,
    probability,
)
from bondgraph.diagnosis.evidence.gain import Gain, compare
from bondgraph.diagnosis.evidence.judging import errors_of
from bondgraph.diagnosis.evidence.left_out import (
    LeftOutErrors,
    chunk_count,
    left_out_errors,
)
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.bench import Bench
from bondgraph.diagnosis.search.beyond_noise import explainable
from bondgraph.diagnosis.search.candidates import Candidate
from bondgraph.diagnosis.search.determined import determined
from bondgraph.diagnosis.search.memory import remembering
from bondgraph.diagnosis.search.one_round import (
    MUCH,
    RUINED,
    Round,
    Setting,
    promising,
)
from bondgraph.diagnosis.search.pairs import Pair, Pairing
from bondgraph.diagnosis.work.workers import Workshop

WORTH = 0.5
"""Of the left-out error, that two laws must take away together to be told."""


def two_rounds(setting: Setting, found: Round, shop: Workshop) -> tuple[Round, ...]:
    """Return two rounds that add one law each; none where no pair is supported.

    Parameters
    ----------
    found
        The round that found nothing: what it tried is paired.
    """
    base, options = setting.base, setting.options
    if not setting.curves or found.cut_short or shop.limit.passed:
        return ()
    if explainable(base, setting.noise) <= MUCH:
        return ()
    bench = Bench.of(base, shop, f"round {setting.number}")
    pairing = Pairing.of(bench, promising(found.promised, options))
    near = [pair for pair in pairing.best(options.judged) if _sound(setting, pair)]
    if not near:
        return ()
    near += [pair for pair in pairing.exchanged(near[0]) if _sound(setting, pair)]
    near = _best_of_each(near)[: options.judged]
    seen = _errors(setting, bench, near)
    judged = [_judged(pair, seen, found.independent, options.rule) for pair in near]
    supported = [
        (pair, told)
        for pair, told in zip(near, judged, strict=True)
        if told.support is Support.SUPPORTED
    ]
    pair = _plainest(supported, options.rule)
    if pair is None or not _holds(setting, pair.both):
        return ()
    # As if the first had left half of what both take away, which neither does alone.
    whole = next(told for one, told in supported if one is pair)
    times = 1.0 / (1.0 - half_of(whole.gain).value)
    halfway = [
        (one, replace(told, errors=_times(told.errors, times)))
        for one, told in supported
    ]
    alone = {key: _times(errors, times) for key, errors in seen.alone.items()}
    at_first = replace(seen, alone=alone)
    first = _round(found, pair, pair.first, halfway, at_first, options.rule)
    second = _round(
        Round(pair.first.fitted, found.tried), pair, pair.second, supported, seen,
        options.rule,
    )  # fmt: skip
    return first, second


def _best_of_each(pairs: Sequence[Pair]) -> list[Pair]:
    """Return the best fit of every pair, the best first."""
    best: dict[frozenset[int], Pair] = {}
    for pair in sorted(pairs, key=lambda pair: pair.both.cost):
        best.setdefault(frozenset((id(pair.first), id(pair.second))), pair)
    return list(best.values())


def _sound(setting: Setting, pair: Pair) -> bool:
    """Return whether the data determine both laws, and both remember if they must."""
    ways = (
        (pair.first.fitted, pair.both),
        (pair.second.fitted, _member(pair, pair.first)),
    )
    for base, added in ways:
        known, _ = determined(base, [added])
        kept, _ = remembering(base, known, setting.recordings)
        if not kept:
            return False
    return pair.both.reduction(setting.base) >= WORTH / 2


def _plainest(supported: Sequence[tuple[Pair, Judged]], rule: Rule) -> Pair | None:
    """Return the pair to believe: of those that predict like the best, the plainest."""
    best = best_supported([told for _, told in supported], rule)
    if best is None:
        return None

    def far_fetched(pair: Pair, told: Judged) -> list[tuple[bool, int]]:
        members = (replace(told, candidate=one) for one in (pair.first, pair.second))
        return sorted((rule.plainness(one) for one in members), reverse=True)

    near = [
        (far_fetched(pair, told), i, pair)
        for i, (pair, told) in enumerate(supported)
        if told.candidate.complexity <= best.candidate.complexity and alike(best, told)
    ]
    return min(near)[2]


def _member(pair: Pair, own: Candidate) -> Candidate:
    """Return one law of a pair, with the model that has both."""
    return replace(own, fitted=pair.both.fitted)


def _holds(setting: Setting, candidate: Candidate) -> bool:
    """Return whether whole recordings are simulated about as well as before."""
    before = simulate_whole(setting.base, setting.recordings).score.nrmse
    after = simulate_whole(candidate.fitted, setting.recordings).score.nrmse
    return not after > RUINED * before


@dataclass(frozen=True, slots=True)
class _Errors:
    """Errors on left-out data: without any law, with each alone, with each pair."""

    before: LeftOutErrors
    alone: dict[int, LeftOutErrors]
    both: dict[int, LeftOutErrors]


def _errors(setting: Setting, bench: Bench, pairs: Sequence[Pair]) -> _Errors:
    chunks = chunk_count(pairs[0].both.fitted)
    singles = {id(one): one for pair in pairs for one in (pair.first, pair.second)}
    alone = errors_of(bench, list(singles.values()), chunks, setting.noise)
    both = {}
    for pair in pairs:
        beside = Bench.of(pair.first.fitted, bench.shop, f"{bench.name}, two at once")
        (both[id(pair)],) = errors_of(beside, [pair.both], chunks, setting.noise)
    return _Errors(
        left_out_errors(setting.base, chunks),
        dict(zip(singles, alone, strict=True)),
        both,
    )


def _judged(pair: Pair, seen: _Errors, tried: float, rule: Rule) -> Judged:
    """Return what left-out data say of a pair, one of all pairs of what was tried."""
    errors = seen.both[id(pair)]
    pairs = tried * (tried - 1.0) / 2.0
    whole = replace(pair.both, complexity=pair.complexity)
    judged = judge(whole, seen.before, errors, pairs, rule)
    alone = [seen.alone[id(one)] for one in (pair.first, pair.second)]
    needed = each_needed(alone, errors, rule)
    if judged.support is Support.SUPPORTED and needed and judged.gain.value >= WORTH:
        return judged
    return replace(judged, support=Support.UNDECIDED)


def each_needed(
    alone: Sequence[LeftOutErrors], both: LeftOutErrors, rule: Rule
) -> bool:
    """Return whether two laws together leave surely and materially less than each."""
    gains = [compare(one, both) for one in alone]
    return all(
        gain.value >= rule.materiality and gain.p_value <= rule.false_alarm_probability
        for gain in gains
    )


def _round(
    before: Round,
    pair: Pair,
    own: Candidate,
    supported: Sequence[tuple[Pair, Judged]],
    seen: _Errors,
    rule: Rule,
) -> Round:
    """Return the round that adds one law of a pair, beside the other."""
    partner = pair.without(own)
    rivals = [
        (other, other.without(partner), told)
        for other, told in supported
        if partner in (other.first, other.second)
    ]
    judged = [
        Judged(
            _member(other, one),
            told.errors,
            half_of(told.gain),
            Support.SUPPORTED,
            f"together with {name_of(partner.hypothesis.physics)} at "
            f"{partner.hypothesis.place} reduces the left-out error by {told.gain}; "
            "alone neither surely does",
        )
        for other, one, told in rivals
    ]
    chosen = next(j for (p, _, _), j in zip(rivals, judged, strict=True) if p is pair)
    sure = probability(chosen, judged, seen.alone[id(partner)], rule)
    return replace(
        before, judged=(*before.judged, *judged), chosen=chosen, probability=sure
    )


def _times(errors: LeftOutErrors, times: float) -> LeftOutErrors:
    return replace(errors, chunks=times * errors.chunks, noise=times * errors.noise)


def half_of(gain: Gain) -> Gain:
    """Return half of what two take away together: each leaves the same share."""
    left = sqrt(max(1.0 - gain.value, 1e-12))
    return Gain(1.0 - left, gain.std / (2.0 * left), gain.p_value)
