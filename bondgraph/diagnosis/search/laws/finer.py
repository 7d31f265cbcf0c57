"""A curve without a name, drawn as smooth as the data tell.

Few knots are enough to find the place, and leave little freedom to mislead. Once a
curve has been chosen it is drawn finely, smooth first and then rougher and rougher as
long as that predicts left-out data better; once more with both ways the same, which has
half as much to tell; and with corners. Few knots do not follow a narrow hump; of what
only goes along with its variable a curve may do better then. So the nearest rival at
another place is drawn as well, and the nearest of another variable at the same place.
And where laws with names leave much that is no noise, curves that came as near with few
knots.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.gain import compare
from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.laws.corners import with_corners
from bondgraph.diagnosis.search.laws.drawing import Drawing, drawn_finely, told_apart
from bondgraph.diagnosis.search.laws.own_range import over_its_own_range
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start
from bondgraph.physics.smooth import Smooth

Array = NDArray[np.float64]

PIECES = 8
"""Into how many each stretch of the first curve is divided."""

NEAR = 0.5
"""A rival that takes away this share of what the chosen curve does is drawn finely."""

AS_NEAR, DRAWN = 1.5, 3
"""Curves that leave at most so many times what a law with a name leaves come as near;
so many are drawn finely.
"""

PLAIN = 2
"""Curves of one variable that are drawn beside one of two."""

ROUGHNESS = (1.0, 3.0, 10.0, 30.0, 100.0)
"""How rough a curve may be, in heights per range, one after the other."""


def as_fine_as_told(bench: Bench, chosen: Judged, before: LeftOutErrors) -> Judged:
    """Return the chosen candidate; a curve as the smooth one that predicts best.

    Left-out data decide how smooth, by the mean log error of the chunks: one chunk that
    alone reaches an end of the curve would decide a sum. Every fourth chunk is left out
    at a time; a curve that does worse where a quarter of all is left out in one piece
    has learnt by heart what lies between the others. Where no smooth curve predicts
    them as well as the first one, that stays.

    Parameters
    ----------
    before
        Errors without it: what the smooth curve gains is told of it.
    """
    if chosen.physics != CURVE:
        return chosen
    chunks = len(chosen.errors.chunks)
    first = Drawing(chosen.candidate, chunks)
    drawings = [first]
    wider = over_its_own_range(bench, chosen.candidate)
    if wider is not None:
        first = Drawing(wider, chunks)
        drawings.append(first)
    for odd in (False, True):
        drawings += _rougher_and_rougher(bench, first, odd)
    best = _that_carries_over(drawings)
    if best is drawings[0]:
        return chosen
    best = with_corners(bench, first, told_apart(bench, first, best))
    errors = replace(best.errors, noise=chosen.errors.noise)
    gain = compare(before, errors)
    reason = f"reduces the left-out error by {gain}"
    return replace(
        chosen, candidate=best.candidate, errors=errors, gain=gain, reason=reason
    )


def finest_of(
    bench: Bench,
    chosen: Judged,
    judged: Sequence[Judged],
    before: LeftOutErrors,
) -> dict[int, Judged]:
    """Return candidates that were drawn finely by the id of what they are drawn from.

    The chosen one comes first, and where that is a curve its nearest rivals; one of
    these before it where that then predicts left-out data better by more than a
    standard error, or no worse by more than that and goes along with less.
    """
    first = chosen
    drawn = {id(chosen): as_fine_as_told(bench, chosen, before)}
    for rival in _rivals(chosen, judged):
        drawn[id(rival)] = as_fine_as_told(bench, rival, before)
        if _comes_before(drawn[id(rival)], drawn[id(first)]):
            first = rival
    return {id(first): drawn[id(first)]} | drawn


def _comes_before(rival: Judged, first: Judged) -> bool:
    """Return whether a curve is told before another, by left-out data and variables."""
    lead = compare(first.errors, rival.errors)
    plainer = _variables(rival) < _variables(first)
    return lead.value > (-lead.std if plainer else lead.std)


def _variables(curve: Judged) -> int:
    """Return how many variables a curve goes along with: its own, what steers it."""
    return len(curve.candidate.hypothesis.depends_on)


def drawn_as_near(
    bench: Bench,
    chosen: Judged,
    judged: Sequence[Judged],
    before: LeftOutErrors,
) -> list[tuple[Judged, Judged]]:
    """Return curves that come as near as a law with a name, and each as drawn finely.

    The one that comes before all others then is the first, and so on.
    """
    drawn: list[tuple[Judged, Judged]] = []
    for one in _as_near(chosen, judged):
        fine = as_fine_as_told(bench, one, before)
        behind = [i for i, (_, it) in enumerate(drawn) if _comes_before(fine, it)]
        drawn.insert(min(behind, default=len(drawn)), (one, fine))
    return drawn


def _as_near(chosen: Judged, judged: Sequence[Judged]) -> list[Judged]:
    """Return the best curves that come as near, one of each place and variable.

    First those of one variable: of two there is one for whatever may steer. And that of
    the law's own place and variable, however near it comes with few knots: these pass
    by a hump that is narrower than they are apart.
    """
    most = AS_NEAR * float(chosen.errors.chunks.sum())
    own = chosen.place, chosen.candidate.hypothesis.depends_on
    near = [
        one
        for one in judged
        if one.physics == CURVE
        and one.support is Support.SUPPORTED
        and (
            float(one.errors.chunks.sum()) <= most
            or own == (one.place, one.candidate.hypothesis.depends_on)
        )
    ]
    best: dict[tuple[str, tuple[str, ...]], Judged] = {}
    for one in sorted(near, key=lambda one: -one.gain.value):
        best.setdefault((one.place, one.candidate.hypothesis.depends_on), one)
    return sorted(best.values(), key=_variables)[:DRAWN]


def _rivals(chosen: Judged, judged: Sequence[Judged]) -> list[Judged]:
    """Return the best curve elsewhere, and of something else here, that come near.

    Of something else, but of no more: what depends on two variables is not plainer.
    Where the chosen one does, the best two elsewhere that do not.
    """
    if chosen.physics != CURVE:
        return []
    near = [
        one
        for one in judged
        if one.physics == CURVE
        and one.support is Support.SUPPORTED
        and one.gain.value >= NEAR * chosen.gain.value
    ]
    near.sort(key=lambda one: -one.gain.value)
    own, most = chosen.candidate.hypothesis.depends_on, _variables(chosen)
    elsewhere = [one for one in near if one.place != chosen.place]
    plain = [one for one in elsewhere if _variables(one) < most]
    here = [
        one
        for one in near
        if one.place == chosen.place
        and one.candidate.hypothesis.depends_on != own
        and _variables(one) <= most
    ]
    return [*(plain[:PLAIN] or elsewhere[:1]), *here[:1]]


def _that_carries_over(drawings: Sequence[Drawing]) -> Drawing:
    """Return the one that predicts best of those that carry over to whole quarters.

    As well as the first one, and within a standard error as well as the one that does
    so best; of equals the last.
    """
    first = float(drawings[0].in_one.mean())
    furthest = min(drawings, key=lambda one: float(one.in_one.mean()))
    behind = [one.in_one - furthest.in_one for one in drawings]
    carry = [
        one
        for one, lag in zip(drawings, behind, strict=True)
        if one.in_one.mean() <= first and lag.mean() <= lag.std() / np.sqrt(lag.size)
    ]
    return min(reversed(carry), key=lambda one: one.typical)


def _rougher_and_rougher(bench: Bench, first: Drawing, odd: bool) -> list[Drawing]:
    """Return the curve drawn finely, rougher as long as left-out data want it so."""
    drawings: list[Drawing] = []
    start, strengths = first.candidate, first.candidate.hypothesis.strengths
    heights = tuple(start.fitted.values[name] for name in strengths)
    for roughness in ROUGHNESS:
        smooth = Smooth(heights, PIECES, roughness, odd)
        begin = Start.where_ended(start.fitted)
        found = drawn_finely(bench, first.candidate.hypothesis, smooth, begin)
        if found is None and odd:
            break  # No roughness makes a curve go both ways.
        if found is None:
            continue
        drawn = Drawing(found, first.chunks, smooth)
        best = min((one.typical for one in drawings), default=np.inf)
        drawings.append(drawn)
        if best < drawn.typical and best <= first.typical:
            break
        start = found
    return drawings
