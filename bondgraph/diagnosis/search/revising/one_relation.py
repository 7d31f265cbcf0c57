"""One relation: a law with a name and a curve of the same variable beside it.

What a named law leaves at a place, and a curve of the law's own variable takes there,
is more of the same: a limit that is softer than it should be and a curve that mends it
are one relation, drawn in two pieces. So the curve that was tried in the law's place is
told alone, if it leaves about as much. Dry friction keeps its name: it is there in any
bearing, and what else depends on the speed comes on top of it.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.revising.curve_beside import (
    DRY,
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
        if law.physics not in {CURVE, *DRY}
        and any(_mends(curve, law) for curve in made[i + 1 :])
    ]
    for index, found in enumerate(rounds):
        for curve in found.judged:
            supported = curve.support is Support.SUPPORTED
            if found.chosen in pieces and supported and _mends(curve, found.chosen):
                return held_against(made[-1], rounds, index, curve)
    return None


def _mends(curve: Judged, law: Judged | None) -> bool:
    """Return whether a candidate is a curve of a law's own variable at its place."""
    if law is None or curve.physics != CURVE or curve.place != law.place:
        return False
    own = law.candidate.hypothesis.depends_on
    return bool(own) and curve.candidate.hypothesis.depends_on == own
