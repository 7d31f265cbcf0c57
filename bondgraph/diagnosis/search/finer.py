"""A curve without a name, drawn as finely as the data tell.

Few knots are enough to find the place, and leave little freedom to mislead. Once a
curve has been chosen its stretches are divided as long as that predicts left-out data
better.
"""

from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.evidence.decision import Judged
from bondgraph.diagnosis.evidence.gain import compare
from bondgraph.diagnosis.evidence.left_out import left_out_errors
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.bench import Bench
from bondgraph.diagnosis.search.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.trying import Start, Trial, fit_fully
from bondgraph.fitting.uncertainty import uncertainty
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.unknown import UnknownRelation

PIECES = (2, 4, 8)
"""Into how many each stretch of the first curve is divided, one after the other."""


def as_fine_as_told(bench: Bench, chosen: Judged) -> Judged:
    """Return the chosen candidate, a curve divided while left-out data gain by it.

    A division counts by more than the standard error of what it gains, and where the
    data tell every height of it.
    """
    if chosen.physics != CURVE:
        return chosen
    best, own = chosen.candidate, chosen.candidate.hypothesis
    chunks = len(chosen.errors.chunks)
    errors = left_out_errors(best.fitted, chunks)
    for pieces in PIECES:
        finer = _finer(bench, own, best, pieces)
        if finer is None or not _told(finer, best):
            break
        after = left_out_errors(finer.fitted, chunks)
        gain = compare(errors, after)
        if not gain.value > gain.std:
            break
        best, errors = finer, after
    return replace(chosen, candidate=best)


def _told(curve: Candidate, coarser: Candidate) -> bool:
    """Return whether each height is known to better than the coarser curve's range."""
    fitted, own = curve.fitted, curve.hypothesis.strengths
    problem = fitted.problem
    names = problem.free_names
    stds = uncertainty(problem, fitted.optimum).std[np.isin(names, own)]
    heights = [coarser.fitted.values[name] for name in coarser.hypothesis.strengths]
    return bool(np.all(stds <= np.ptp(heights)))


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
