"""A curve without a name, drawn as finely as the data tell.

Few knots are enough to find the place, and leave little freedom to mislead. Once a
curve has been chosen its stretches are divided as long as that predicts left-out data
better.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.decision import Judged
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors, left_out_errors
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.bench import Bench
from bondgraph.diagnosis.search.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.trying import Start, Trial, fit_fully
from bondgraph.fitting.problem import truncated_inverse
from bondgraph.fitting.uncertainty import uncertainty
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.unknown import UnknownRelation

Array = NDArray[np.float64]
PIECES = (2, 4, 8)
"""Into how many each stretch of the first curve is divided, one after the other."""

BY_CHANCE = 0.05
"""How often a division that adds nothing may seem to."""


def as_fine_as_told(bench: Bench, chosen: Judged) -> Judged:
    """Return the chosen candidate, a curve divided while left-out data gain by it.

    A division counts where most chunks gain by it, and the data tell every height.
    """
    if chosen.physics != CURVE:
        return chosen
    best, own = chosen.candidate, chosen.candidate.hypothesis
    chunks = len(chosen.errors.chunks)
    errors, coarser = left_out_errors(best.fitted, chunks), best
    for pieces in PIECES:
        finer = _finer(bench, own, coarser, pieces)
        if finer is None or not _told(finer, best):
            break
        # A division that is still too coarse for the curve need not gain by itself.
        coarser, after = finer, left_out_errors(finer.fitted, chunks)
        if _mostly_better(errors, after):
            best, errors = finer, after
    return replace(chosen, candidate=best)


def _mostly_better(before: LeftOutErrors, after: LeftOutErrors) -> bool:
    """Return whether chunks are predicted better by rank, not by their sum.

    A chunk that alone reaches an end of the curve cannot be predicted without it, and
    the less the finer the curve is there.
    """
    from scipy.stats import wilcoxon  # noqa: PLC0415  (slow to import)

    if np.array_equal(before.chunks, after.chunks):
        return False
    test = wilcoxon(before.chunks, after.chunks, alternative="greater")
    return bool(test.pvalue < BY_CHANCE)


def _told(curve: Candidate, coarser: Candidate) -> bool:
    """Return whether each height is known to better than the coarser curve's range.

    Beside the model's own parameters as they are: what these can do themselves (a free
    resistance what is proportional to the flow) the curve need not tell from them.
    """
    fitted = curve.fitted
    problem = fitted.problem
    own = np.isin(problem.free_names, curve.hypothesis.strengths)
    covariance = uncertainty(problem, fitted.optimum).covariance
    heights = [coarser.fitted.values[name] for name in coarser.hypothesis.strengths]
    return bool(np.all(stds_beside(covariance, own) <= np.ptp(heights)))


def stds_beside(covariance: Array, own: NDArray[np.bool_]) -> Array:
    """Return the standard deviations of some parameters with the others held."""
    crossed = covariance[np.ix_(own, ~own)]
    held = truncated_inverse(covariance[np.ix_(~own, ~own)])
    left = covariance[np.ix_(own, own)] - crossed @ held @ crossed.T
    stds: Array = np.sqrt(np.maximum(np.diag(left), 0.0))
    return stds


def _finer(
    bench: Bench, first: Hypothesis, coarse: Candidate, pieces: int
) -> Candidate | None:
    """Return the curve with its stretches divided, fitted from the coarser one."""
    scales = measure_scales(bench.base)
    proposed = [
        hypothesis
        for place in all_places(bench.base.graph, scales)
        if place.name == first.place
        for hypothesis in UnknownRelation(pieces).propose(place)
        if hypothesis.words == first.words
    ]
    if len(proposed) != 1:
        return None
    (hypothesis,) = proposed
    old, new = coarse.hypothesis.strengths, hypothesis.strengths
    heights = [coarse.fitted.values[name] for name in old]
    where = np.linspace(0.0, len(old) - 1.0, len(new))
    between = np.interp(where, np.arange(len(old)), heights)
    values = {
        **coarse.fitted.values,
        **dict(zip(new, map(float, between), strict=True)),
    }
    fitted = coarse.fitted
    start = Start(values, fitted.optimum.initial, fitted.problem.solver)
    trial = Trial(hypothesis, (start,))
    found = bench.candidates([trial], bench.run(fit_fully, [trial], "a finer curve"))
    return found[0] if found else None
