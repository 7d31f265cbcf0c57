"""A curve without a name, drawn as smooth as the data tell.

Few knots are enough to find the place, and leave little freedom to mislead. Once a
curve has been chosen it is drawn finely, smooth first and then rougher and rougher as
long as that predicts left-out data better.
"""

from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.evidence.decision import Judged
from bondgraph.diagnosis.evidence.gain import compare
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors, left_out_errors
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.bench import Bench
from bondgraph.diagnosis.search.candidates import CURVE, Candidate
from bondgraph.diagnosis.search.trying import Start, Trial, fit_fully
from bondgraph.physics.curves import Smooth
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.unknown import UnknownRelation

PIECES = 8
"""Into how many each stretch of the first curve is divided."""

ROUGHNESS = (1.0, 3.0, 10.0, 30.0, 100.0)
"""How rough a curve may be, in heights per range, one after the other."""


def as_fine_as_told(bench: Bench, chosen: Judged, before: LeftOutErrors) -> Judged:
    """Return the chosen candidate; a curve as the smooth one that predicts best.

    Left-out data decide how smooth, by the mean log error of the chunks: one chunk that
    alone reaches an end of the curve would decide a sum. Where no smooth curve predicts
    them as well as the first one, that stays.

    Parameters
    ----------
    before
        Errors without it: what the smooth curve gains is told of it.
    """
    if chosen.physics != CURVE:
        return chosen
    first = start = chosen.candidate
    chunks = len(chosen.errors.chunks)
    best, errors = first, left_out_errors(first.fitted, chunks)
    for roughness in ROUGHNESS:
        drawn = _drawn(bench, first, start, roughness)
        if drawn is None:
            continue
        left = left_out_errors(drawn.fitted, chunks)
        if _typical(left) > _typical(errors) and best is not first:
            break
        if _typical(left) <= _typical(errors):
            best, errors = drawn, left
        start = drawn
    if best is first:
        return chosen
    errors = replace(errors, noise=chosen.errors.noise)
    gain = compare(before, errors)
    reason = f"reduces the left-out error by {gain}"
    return replace(chosen, candidate=best, errors=errors, gain=gain, reason=reason)


def _typical(errors: LeftOutErrors) -> float:
    """Return the mean log of the squared errors on left-out chunks."""
    chunks = errors.chunks
    return float(np.mean(np.log(np.maximum(chunks, 1e-12 * chunks.max()))))


def _drawn(
    bench: Bench, first: Candidate, start: Candidate, roughness: float
) -> Candidate | None:
    """Return the first curve drawn finely, fitted from where another fit has ended."""
    values = first.fitted.values
    heights = tuple(values[name] for name in first.hypothesis.strengths)
    physics = UnknownRelation(Smooth(heights, PIECES, roughness))
    hypothesis = _proposed(bench, first.hypothesis, physics)
    if hypothesis is None:
        return None
    begin = Start.where_ended(start.fitted)
    known = {**hypothesis.starts[0], **begin.values}
    trial = Trial(hypothesis, (replace(begin, values=known),))
    found = bench.candidates([trial], bench.run(fit_fully, [trial], "a smooth curve"))
    return found[0] if found else None


def _proposed(
    bench: Bench, first: Hypothesis, physics: UnknownRelation
) -> Hypothesis | None:
    """Return the same curve as another form of the physics proposes it."""
    plain = UnknownRelation()
    same = [
        finer
        for place in all_places(bench.base.graph, measure_scales(bench.base))
        if place.name == first.place
        for form, finer in zip(plain.forms(place), physics.forms(place), strict=True)
        if form().words == first.words
    ]
    return same[0]() if len(same) == 1 else None
