"""One relation: a law with a name and a curve of the same variable beside it.

What a named law leaves at a place, and a curve of the law's own variable takes there,
is more of the same: a limit that is softer than it should be and a curve that mends it
are one relation, drawn in two pieces. So the curve that was tried in the law's place is
told alone, if it leaves about as much.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.laws.mending import mends
from bondgraph.diagnosis.search.revising.curve_beside import (
    BetterCurve,
    held_against,
)
from bondgraph.diagnosis.search.round_found import Round, made_in

AS_MUCH = 0.8
"""The share of what the curve leaves alone that both pieces leave at least."""


def one_relation(rounds: Sequence[Round]) -> BetterCurve | None:
    """Return the curve that was tried where a law and a curve were found, if any."""
    made = made_in(rounds)
    pieces = [
        law
        for i, law in enumerate(made)
        if any(_mends(curve, law) for curve in made[i + 1 :])
    ]
    for index, found in enumerate(rounds):
        for curve in found.judged if found.chosen in pieces else ():
            assert found.chosen is not None
            if curve.support is Support.SUPPORTED and _mends(curve, found.chosen):
                return held_against(made[-1], rounds, index, curve)
    return None


def _mends(curve: Judged, law: Judged) -> bool:
    return mends(curve.candidate.hypothesis, law.candidate.hypothesis)
