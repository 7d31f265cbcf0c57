"""One relation: a law with a name and a curve of the same variable beside it.

What a named law leaves at a place, and a curve of the law's own variable takes there,
is more of the same: a limit that is softer than it should be and a curve that mends it
are one relation, drawn in two pieces. So the curve that was tried in the law's place is
told alone, if it leaves about as much.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.laws.drawing import is_fine
from bondgraph.diagnosis.search.laws.mending import mends
from bondgraph.diagnosis.search.revising.curve_beside import (
    BetterCurve,
    held_against,
)
from bondgraph.diagnosis.search.round_found import Round, accepted, made_in
from bondgraph.physics.hypothesis import Hypothesis

AS_MUCH = 0.8
"""The share of what the curve leaves alone that both pieces leave at least."""


def one_relation(rounds: Sequence[Round]) -> BetterCurve | None:
    """Return the curve that was tried where a law and a curve were found, if any.

    Or where a law gave way to a curve through few knots: drawn finely it is told alone.
    """
    made = made_in(rounds)
    for index, found in enumerate(rounds):
        law, curve = found.chosen, _tried_instead(found)
        if law is None or curve is None:
            continue
        if any(_takes_over(one, law, made) for one in made):
            return held_against(made[-1], rounds, index, curve)
    return None


def pieces_of(rounds: Sequence[Round]) -> tuple[Hypothesis, ...]:
    """Return the laws that were found and that a curve was tried in the place of."""
    return tuple(
        found.chosen.candidate.hypothesis
        for found in accepted(rounds)
        if found.chosen is not None and _tried_instead(found) is not None
    )


def _tried_instead(found: Round) -> Judged | None:
    """Return the curve that was tried in the place of the law of a round, if any."""
    law = found.chosen
    if law is None:
        return None
    supported = (one for one in found.judged if one.support is Support.SUPPORTED)
    return next((curve for curve in supported if _mends(curve, law)), None)


def _takes_over(curve: Judged, law: Judged, made: Sequence[Judged]) -> bool:
    """Return whether a curve that was found mends a law, or took its place as it is."""
    if not _mends(curve, law):
        return False
    order = [id(one) for one in made]
    if id(law) in order:
        return order.index(id(law)) < order.index(id(curve))
    return not is_fine(curve.candidate.hypothesis)


def _mends(curve: Judged, law: Judged) -> bool:
    return mends(curve.candidate.hypothesis, law.candidate.hypothesis)
