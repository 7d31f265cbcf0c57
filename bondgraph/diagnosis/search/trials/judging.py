"""Judging: the fitted candidates on data they were not fitted to, twins together."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.evidence.confidence import probability
from bondgraph.diagnosis.evidence.decision import best_supported, with_plainer
from bondgraph.diagnosis.evidence.judged import Judged, Rule, judge
from bondgraph.diagnosis.evidence.left_out import (
    LeftOutErrors,
    chunk_count,
    left_out_errors,
)
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.impossible import impossible
from bondgraph.diagnosis.search.trials.trying import Start, Trial, errors_left_out

Array = NDArray[np.float64]
TWINS = 1e-3
"""Candidates whose residuals differ by less than this share predict the same."""


@dataclass(frozen=True, slots=True)
class Verdicts:
    """All that were judged, the one to believe, if any, and how probable it is.

    Parameters
    ----------
    before
        Errors without any of them.
    """

    judged: tuple[Judged, ...] = ()
    chosen: Judged | None = None
    probability: float | None = None
    before: LeftOutErrors | None = None


def judge_all(
    bench: Bench,
    worth: Sequence[Candidate],
    tried: float,
    rule: Rule,
    noise: Array,
    fault: Callable[[Candidate, int], str | None],
    earlier: Verdicts,
) -> Verdicts:
    """Judge candidates on left-out data; twins share their errors.

    Parameters
    ----------
    tried
        How many independent hypotheses these are the best of.
    noise
        Residual per output that noise excuses, 0 where it is not known.
    fault
        Why a candidate is not the one after all, None where it is; asked of the leading
        ones only, with the number of chunks.
    earlier
        What was said of others already: all are decided together.
    """
    if not worth:
        return earlier
    before = earlier.before
    if before is None:
        best = min(worth, key=lambda candidate: candidate.cost)
        chunks = chunk_count(best.fitted)
        before = left_out_errors(bench.base, chunks)
    else:
        chunks = before.chunks.size
    first = [first_twin(i, worth) for i in range(len(worth))]
    kinds = sorted(set(first))
    seen = errors_of(bench, [worth[i] for i in kinds], chunks, noise)
    errors = dict(zip(kinds, seen, strict=True))
    judged = [
        stable(judge(candidate, before, errors[i], tried, rule))
        for i, candidate in zip(first, worth, strict=True)
    ]
    return decide([*earlier.judged, *judged], before, rule, fault)


def stable(judged: Judged) -> Judged:
    """Return a candidate, refuted where no element has such a curve."""
    reason = impossible(judged.candidate)
    if reason is None:
        return judged
    return replace(judged, support=Support.REFUTED, reason=reason)


def errors_of(
    bench: Bench, candidates: Sequence[Candidate], chunks: int, noise: Array
) -> list[LeftOutErrors]:
    """Return what candidates do on chunks of data that they were not fitted to."""
    trials = [
        Trial(one.hypothesis, (Start.where_ended(one.fitted),), chunks=chunks)
        for one in candidates
    ]
    results = bench.run(errors_left_out, trials, "judging", whole=True)
    per_sample = float(np.sum((noise / bench.base.problem.sigma) ** 2))
    return [
        LeftOutErrors(
            np.array(result["chunks"]),
            np.array(result["surprise"]),
            result["samples"],
            per_sample * result["samples"],
        )
        for result in results
    ]


def decide(
    judged: Sequence[Judged],
    before: LeftOutErrors,
    rule: Rule,
    fault: Callable[[Candidate, int], str | None],
) -> Verdicts:
    """Return the best supported candidate without a fault, others refuted by theirs.

    Parameters
    ----------
    before
        Errors without any of them.
    """
    left = list(with_plainer(judged, rule))
    while chosen := best_supported(left, rule):
        reason = fault(chosen.candidate, before.chunks.size)
        if reason is None:
            sure = probability(chosen, left, before, rule)
            return Verdicts(tuple(left), chosen, sure, before)
        left[left.index(chosen)] = replace(
            chosen, support=Support.REFUTED, reason=reason
        )
    return Verdicts(tuple(left), before=before)


def first_twin(index: int, candidates: Sequence[Candidate]) -> int:
    """Return the index of the first candidate that predicts the same."""
    own = candidates[index]
    residuals = own.fitted.optimum.linearisation.residuals
    size = float(np.linalg.norm(residuals))
    for i, other in enumerate(candidates[:index]):
        if other.complexity != own.complexity:
            continue
        difference = residuals - other.fitted.optimum.linearisation.residuals
        if float(np.linalg.norm(difference)) <= TWINS * size:
            return i
    return index
