"""Two together: a pair of laws is added, where none alone is supported.

Or where only a curve without a name is: two named laws that explain more tell more.

What is accepted goes on record as two rounds, so that each law is told with what may
stand in its place beside the other. Each takes away half of what both do: neither does
anything sure alone.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.evidence.confidence import probability
from bondgraph.diagnosis.evidence.judged import Judged, Rule
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors, chunk_count
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.base.beyond_noise import explainable
from bondgraph.diagnosis.search.considered import Setting, promising
from bondgraph.diagnosis.search.one_round import MUCH
from bondgraph.diagnosis.search.pairs.pair_fits import Pair, best_of_each
from bondgraph.diagnosis.search.pairs.pairs import Pairing
from bondgraph.diagnosis.search.pairs.stand_ins import instead_of
from bondgraph.diagnosis.search.pairs.two import (
    WORTH,
    JudgedPair,
    PairErrors,
    judge_pair,
    plainest,
)
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.impossible import impossible
from bondgraph.diagnosis.search.trials.worth import fault_of, worth_judging
from bondgraph.diagnosis.work.workers import Workshop
from bondgraph.physics.names import name_of


def two_rounds(
    setting: Setting, found: Round, shop: Workshop, *, kindred: bool = False
) -> tuple[Round, ...]:
    """Return two rounds that add one law each; none where no pair is supported.

    Parameters
    ----------
    found
        The round that found nothing with a name: what it tried is paired.
    kindred
        Whether only one law at two like places is tried: these are few.
    """
    base, rule = setting.base, setting.options.rule
    if not setting.curves or found.cut_short or shop.limit.passed:
        return ()
    if explainable(base, setting.noise) <= MUCH:
        return ()
    bench = Bench.of(base, shop, f"round {setting.number}")
    everything = [one.hypothesis for one in found.promised]
    alone = () if kindred else promising(found.promised, setting.options)
    pairing = Pairing.of(bench, alone, everything)
    pairs = _worth(setting, pairing)
    if not pairs:
        return ()
    chunks = _chunks(found, pairs)
    seen = PairErrors.of(bench, pairing.fits.beside, pairs, setting.noise, chunks)
    judged = [
        judge_pair(pair, seen, pairing.rivals(pair, found.independent), rule)
        for pair in pairs
    ]
    supported = [one for one in judged if one.supported]
    chosen = plainest(supported, rule)
    if chosen is None:
        return ()
    if fault_of(base, chosen.pair.both, setting.recordings, chunks) is not None:
        return ()
    # As if the first left half: all errors of its round are larger by the other half.
    times = 1.0 / (1.0 - chosen.half.value)
    first = _round(found, chosen, chosen.pair.first, supported, seen, rule, times)
    then = Round(chosen.pair.first.fitted, found.tried)
    second = _round(then, chosen, chosen.pair.second, supported, seen, rule)
    return first, second


def explained(made: Sequence[Round]) -> float:
    """Return the share of the left-out error that rounds take away in turn."""
    left = (1.0 - one.chosen.gain.value for one in made if one.chosen is not None)
    return 1.0 - math.prod(left)


def _chunks(found: Round, pairs: Sequence[Pair]) -> int:
    """Return into how many chunks to deal the data: as the round has, if it has."""
    if found.judged:
        return found.judged[0].errors.chunks.size
    return chunk_count(pairs[0].both.fitted)


def _worth(setting: Setting, pairing: Pairing) -> list[Pair]:
    """Return the pairs worth judging, with what may stand in for either of the best."""
    most = setting.options.judged
    pairs = [pair for pair in pairing.best(most) if _is_worth(setting, pair)]
    if pairs:
        others = pairing.exchanged(pairs[0])
        pairs += [pair for pair in others if _is_worth(setting, pair)]
    return best_of_each(pairs)[:most]


def _is_worth(setting: Setting, pair: Pair) -> bool:
    """Return whether each law is worth judging beside the other, and may be there."""
    ways = (
        (pair.first.fitted, pair.both),
        (pair.second.fitted, _with_both(pair, pair.first)),
    )
    return pair.both.reduction(setting.base) >= WORTH / 2 and all(
        worth_judging(base, [added], setting.recordings)[0]
        and impossible(added) is None
        for base, added in ways
    )


def _with_both(pair: Pair, own: Candidate) -> Candidate:
    """Return one law of a pair, with the model that has both."""
    return replace(own, fitted=pair.both.fitted)


def _round(
    before: Round,
    chosen: JudgedPair,
    own: Candidate,
    supported: Sequence[JudgedPair],
    seen: PairErrors,
    rule: Rule,
    times: float = 1.0,
) -> Round:
    """Return the round that adds one law of a pair, beside the other.

    Parameters
    ----------
    times
        How many times larger all errors are taken.
    """
    partner = chosen.pair.without(own)
    added = _told(chosen, partner, times)
    others = instead_of(own, chosen, supported, rule)
    judged = (added, *(_told(one, beside, times) for one, beside in others))
    alone = _enlarged(seen.alone[id(partner)], times)
    sure = probability(added, judged, alone, rule)
    return replace(
        before, judged=(*before.judged, *judged), chosen=added, probability=sure
    )


def _told(one: JudgedPair, partner: Candidate, times: float) -> Judged:
    """Return what is told of the law of a pair that is not its partner."""
    law = partner.hypothesis
    return Judged(
        _with_both(one.pair, one.pair.without(partner)),
        _enlarged(one.whole.errors, times),
        one.half,
        Support.SUPPORTED,
        f"together with {name_of(law.physics)} at {law.place} reduces the left-out "
        f"error by {one.whole.gain}; alone neither surely does",
    )


def _enlarged(errors: LeftOutErrors, times: float) -> LeftOutErrors:
    return replace(errors, chunks=times * errors.chunks, noise=times * errors.noise)
