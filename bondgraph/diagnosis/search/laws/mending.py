"""A curve of the very variable of a law beside it: it mends the law.

Dry friction is not mended so: it is there in any bearing, and what else depends on the
speed comes on top of it.
"""

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.physics.friction import (
    CoulombFriction,
    DirectionDependentFriction,
    StribeckFriction,
)
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.load import LoadDependentFriction

DRY = frozenset({
    CoulombFriction.word, DirectionDependentFriction.word, StribeckFriction.word,
    LoadDependentFriction.word,
})  # fmt: skip


def mends(curve: Hypothesis, law: Hypothesis) -> bool:
    """Return whether one is a curve of the variable of the other, at its place."""
    return (
        curve.physics == CURVE
        and law.physics not in {CURVE, *DRY}
        and curve.place == law.place
        and bool(law.depends_on)
        and curve.depends_on == law.depends_on
    )
