"""Screening: what every hypothesis promises, from the base model's optimum.

A hypothesis is nested in the base model, so it is judged first by the slope of the
error in its strengths where they are zero. What that costs grows with the number of
places and laws only: it reads a limited share of the data, and only a fixed number of
hypotheses goes on to the next, dearer stage.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.bench import Bench
from bondgraph.diagnosis.candidates import Promised, Rejected, Screened
from bondgraph.diagnosis.trying import Trial, promise
from bondgraph.physics.hypothesis import Hypothesis


def screen(bench: Bench, hypotheses: Sequence[Hypothesis]) -> Screened:
    """Return every hypothesis with what it promises, the best first."""
    trials = [Trial(hypothesis) for hypothesis in hypotheses]
    results = bench.run(promise, trials, "screening", few=True)
    promised, rejected = [], []
    for hypothesis, result in zip(hypotheses, results, strict=True):
        if "refused" in result:
            rejected.append(Rejected(hypothesis, result["refused"]))
        else:
            promised.append(Promised(hypothesis, result["promised"]))
    promised.sort(key=lambda one: -one.reduction)
    return Screened(tuple(promised), tuple(rejected))
