"""Laws of several numbers, begun elsewhere: what a fit ends in need not be the best.

A gap, and how stiff it is beyond: with too narrow a gap and too soft a contact much is
explained too, and no small step leads from there to the right ones. So where the
leading laws leave much that is no noise, each of their numbers is made several times
larger and smaller in turn, and what is better from there is kept.
"""

from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.base.beyond_noise import explainable
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully, fit_on
from bondgraph.diagnosis.search.trials.vanished import has_vanished

Array = NDArray[np.float64]
MUCH = 0.5
"""Laws that leave more than this share beyond the noise are begun elsewhere."""

LEADING = 2
"""How many of them."""

TIMES = (1 / 3, 3.0)
BETTER = 0.9
"""A fit from elsewhere is kept where it leaves at most this share."""


def begun_elsewhere(
    bench: Bench, candidates: Sequence[Candidate], noise: Array
) -> list[Candidate]:
    """Return the candidates, the leading ones as the best of fits from elsewhere.

    Parameters
    ----------
    noise
        Residual per output that noise excuses, 0 where it is not known.
    """
    several = [
        one
        for one in sorted(candidates, key=attrgetter("cost"))
        if one.hypothesis.physics != CURVE
        and len(one.hypothesis.parameters) > 1
        and explainable(one.fitted, noise) > MUCH
    ][:LEADING]
    trials = [trial for one in several for trial in _trials(one)]
    if not trials:
        return list(candidates)
    short = bench.run(fit_on, trials, "begun elsewhere", few=True)
    best: dict[int, tuple[float, Trial]] = {}
    for trial, result in zip(trials, short, strict=True):
        known = best.get(id(trial.hypothesis))
        if "refused" not in result and (known is None or result["cost"] < known[0]):
            ended = replace(trial, starts=(Start(result["values"]),))
            best[id(trial.hypothesis)] = result["cost"], ended
    again = [trial for _, trial in best.values()]
    fitted = bench.candidates(again, bench.run(fit_fully, again, "from elsewhere"))
    better = {id(one.hypothesis): one for one in fitted}
    return [_better(one, better.get(id(one.hypothesis))) for one in candidates]


def _trials(candidate: Candidate) -> list[Trial]:
    """Return fits that begin with one number of the law larger or smaller."""
    found = candidate.fitted.values
    starts = [
        Start({**found, name: times * found[name]})
        for name in candidate.hypothesis.parameters
        for times in TIMES
    ]
    return [Trial(candidate.hypothesis, (start,)) for start in starts]


def _better(known: Candidate, other: Candidate | None) -> Candidate:
    """Return the other fit of a law where it is clearly better, and still the law."""
    if other is None or other.cost > BETTER * known.cost or has_vanished(other):
        return known
    return other
