"""Two laws at once, judged as one candidate.

A pair is one among as many as there are of its class, has to take away half of what is
left, and each of the two must be needed beside the other.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.decision import best_supported
from bondgraph.diagnosis.evidence.gain import Gain, compare
from bondgraph.diagnosis.evidence.judged import Judged, Rule, judge
from bondgraph.diagnosis.evidence.leads import alike
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors, left_out_errors
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.pairs.pair_fits import Pair
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.judging import errors_of

Array = NDArray[np.float64]
WORTH = 0.5
"""Of the left-out error, that two laws must take away together to be told."""


@dataclass(frozen=True, slots=True)
class JudgedPair:
    """A pair, and what left-out data say of it as one candidate."""

    pair: Pair
    whole: Judged

    @property
    def supported(self) -> bool:
        """Whether it is."""
        return self.whole.support is Support.SUPPORTED

    @property
    def half(self) -> Gain:
        """Half of what both take away."""
        return half_of(self.whole.gain)


@dataclass(frozen=True, slots=True)
class PairErrors:
    """Errors on left-out data: without any law, with each alone, with each pair.

    Those with one are called by the id of its candidate, those with two of its pair.
    """

    before: LeftOutErrors
    alone: Mapping[int, LeftOutErrors]
    both: Mapping[int, LeftOutErrors]

    @classmethod
    def of(
        cls,
        bench: Bench,
        beside: Mapping[int, Bench],
        pairs: Sequence[Pair],
        noise: Array,
        chunks: int,
    ) -> "PairErrors":
        """Return the errors of pairs, and of their laws alone.

        Parameters
        ----------
        beside
            For each first law the bench whose base model has it.
        chunks
            Into how many the data are dealt.
        """
        singles = {id(one): one for pair in pairs for one in (pair.first, pair.second)}
        alone = errors_of(bench, list(singles.values()), chunks, noise)
        both = {
            id(pair): errors_of(beside[id(pair.first)], [pair.both], chunks, noise)[0]
            for pair in pairs
        }
        before = left_out_errors(bench.base, chunks)
        return cls(before, dict(zip(singles, alone, strict=True)), both)


def judge_pair(pair: Pair, seen: PairErrors, pairs: float, rule: Rule) -> JudgedPair:
    """Return what left-out data say of two laws, one of so many independent pairs."""
    errors = seen.both[id(pair)]
    whole = replace(pair.both, complexity=pair.complexity)
    judged = judge(whole, seen.before, errors, pairs, rule)
    alone = [seen.alone[id(one)] for one in (pair.first, pair.second)]
    if not (judged.gain.value >= WORTH and each_needed(alone, errors, rule)):
        judged = replace(judged, support=Support.UNDECIDED)
    return JudgedPair(pair, judged)


def each_needed(
    alone: Sequence[LeftOutErrors], both: LeftOutErrors, rule: Rule
) -> bool:
    """Return whether two laws together leave surely and materially less than each."""
    gains = [compare(one, both) for one in alone]
    return all(
        gain.value >= rule.materiality and gain.p_value <= rule.false_alarm_probability
        for gain in gains
    )


def plainest(supported: Sequence[JudgedPair], rule: Rule) -> JudgedPair | None:
    """Return the pair to believe: of those that predict like the best, the plainest."""
    best = best_supported([one.whole for one in supported], rule)
    if best is None:
        return None

    def far_fetched(one: JudgedPair) -> list[tuple[bool, int]]:
        members = (one.pair.first, one.pair.second)
        laws = (replace(one.whole, candidate=member) for member in members)
        return sorted((rule.plainness(law) for law in laws), reverse=True)

    fewest = best.candidate.complexity
    near = (
        one
        for one in supported
        if one.whole.candidate.complexity <= fewest and alike(best, one.whole)
    )
    return min(near, key=far_fetched)


def half_of(gain: Gain) -> Gain:
    """Return half of what two take away together: each leaves the same share."""
    left = sqrt(max(1.0 - gain.value, 1e-12))
    return Gain(1.0 - left, gain.std / (2.0 * left), gain.p_value)
