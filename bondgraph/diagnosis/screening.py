"""Screening: what every hypothesis promises, from the base model's optimum.

A hypothesis is nested in the base model, so it is judged first by the slope of the
error in its strengths where they are zero. What that costs grows with the number of
places and laws only: it reads a limited share of the data, and only a fixed number of
hypotheses goes on to the next, dearer stage.
"""

from collections.abc import Sequence

import numpy as np

from bondgraph.diagnosis.bench import Bench
from bondgraph.diagnosis.candidates import Chance, Promised, Rejected, Screened
from bondgraph.diagnosis.trying import Trial, promise
from bondgraph.physics.hypothesis import Hypothesis


def screen(bench: Bench, hypotheses: Sequence[Hypothesis]) -> Screened:
    """Return every hypothesis with what it promises, the best first."""
    trials = [Trial(hypothesis) for hypothesis in hypotheses]
    results = bench.screen(promise, trials, "screening")
    promised, rejected = [], []
    chance = [r["by_chance"] for r in results if "by_chance" in r]
    for hypothesis, result in zip(hypotheses, results, strict=True):
        if "refused" in result:
            rejected.append(Rejected(hypothesis, result["refused"]))
        else:
            promised.append(Promised(hypothesis, result["promised"]))
    promised.sort(key=lambda one: -one.reduction)
    highest = np.max(chance, axis=0) if chance else np.ones(1)
    return Screened(
        tuple(promised),
        tuple(rejected),
        Chance(highest, len(promised) / max(len(chance), 1)),
    )
