"""Screening: what every hypothesis promises, from the base model's optimum.

A hypothesis is nested in the base model, so it is judged first by the slope of the
error in its strengths where they are zero. What that costs grows with the number of
places and laws only: it reads a limited share of the data, and only a fixed number of
hypotheses goes on to the next, dearer stage.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import Promised, Rejected, Screened
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import FORMS, Trial, promise
from bondgraph.physics.hypothesis import Hypothesis

Array = NDArray[np.float64]


def screen(bench: Bench, hypotheses: Sequence[Hypothesis]) -> Screened:
    """Return every hypothesis with what it promises, the best first."""
    trials = [Trial(hypothesis) for hypothesis in hypotheses]
    results = bench.screen(promise, trials, "screening")
    promised, rejected = [], []
    chance = [result["by_chance"] for result in results if "by_chance" in result]
    for hypothesis, result in zip(hypotheses, results, strict=True):
        if "refused" in result:
            rejected.append(Rejected(hypothesis, result["refused"]))
        else:
            begun = _begun_best(hypothesis, result.get("order", ()), result.get("near"))
            promised.append(Promised(begun, result["promised"]))
    promised.sort(key=lambda one: -one.reduction)
    others = len(promised) - len(chance)
    return Screened(
        tuple(promised), tuple(rejected), effective_number(np.array(chance)) + others
    )


def _begun_best(
    hypothesis: Hypothesis, order: Sequence[int], near: Mapping[str, float] | None
) -> Hypothesis:
    """Return a law that differs in its form only from start to start, from the best.

    Of many forms, a ripple's lengths for instance, a fit from most would be in vain.
    Before them from where a fit over short windows has ended, if there was one: the
    first fit that keeps the promise may be the last one.
    """
    starts = best = hypothesis.starts
    if len(starts) > FORMS and len(order) >= len(starts):
        best = tuple(starts[i] for i in order[:FORMS])
    elif not near:
        return hypothesis
    return replace(hypothesis, starts=(near, *best) if near else best)


def effective_number(chance: Array) -> float:
    """Return to how many independent hypotheses those tried amount.

    Many say nearly the same. Each counts by how rarely it explains so much of a
    surrogate; the best of M independent ones would have a median p-value of
    1 - 0.5^(1/M) (after Cheverud, Heredity 87, 2001, and Westfall and Young).

    Parameters
    ----------
    chance
        Share of every surrogate that a hypothesis explains, (hypotheses, draws).
    """
    if chance.size == 0:
        return 0.0
    draws = chance.shape[1]
    ranks = chance.argsort(axis=1).argsort(axis=1)
    p_values = (draws - ranks) / (draws + 1.0)
    median = float(np.median(p_values.min(axis=0)))
    number = np.log(0.5) / np.log1p(-median)
    return float(np.clip(number, 1.0, len(chance)))
