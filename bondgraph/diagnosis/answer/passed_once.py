"""Curves whose argument passes each value once: they may as well be curves of time.

What cools down in one go has each temperature at one time. A loss that changes with the
temperature, a second store that lags behind, and whatever else changes meanwhile look
the same there, and a free curve draws all of them.
"""

import numpy as np

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.drawn_laws import argument_of
from bondgraph.diagnosis.probing import probe

ONCE = 1.5
"""Who travels less than so many times his range comes hardly anywhere twice."""

MAY_BE_TIME = 0.5
"""What is left of the probability of a curve that may be one of time: a judgement."""

AS_OF_TIME = (
    " Its argument passes each value once here: what changes with time, or a store "
    "that is not in the model, would look the same. A recording that comes back would "
    "tell."
)


def passes_once(candidate: Candidate) -> bool:
    """Return whether a curve goes along something that comes to no value twice."""
    if candidate.hypothesis.physics != CURVE:
        return False
    shots, argument = candidate.fitted.problem.shots, argument_of(candidate)
    if argument is None or shots.timeless:
        return False
    along = probe(candidate.fitted, (argument,))[argument]
    parts = [along[a:b] for a, b in zip(shots.edges, shots.edges[1:], strict=False)]
    way = sum(float(np.nansum(np.abs(np.diff(part)))) for part in parts)
    return way < ONCE * float(np.nanmax(along) - np.nanmin(along))
