"""Angles that begin again after a whole turn, made to go on.

A resolver, a camera or an arctangent tells an angle within one turn: where it passes
the end it jumps by a turn, which no shaft does.
"""

import math

import numpy as np
from numpy.typing import NDArray

from bondgraph.recordings.channel import FloatArray

TURN = {"rad": 2.0 * math.pi, "deg": 360.0}
"""A whole turn, by unit."""

WITHIN = 1.02
"""What is told within one turn spans no more turns than this."""

SLOW = 0.25
"""Between jumps no step is more than this share of a turn: faster is not followed."""


def unwrapped(values: FloatArray, unit: str) -> tuple[FloatArray, int] | None:
    """Return the angle as it goes on, and how often it had jumped; None if it does not.

    Parameters
    ----------
    values
        Samples in the order of time; nan where nothing was measured.
    unit
        ``"rad"`` or ``"deg"``; of any other nothing is a turn.
    """
    turn = TURN.get(unit)
    there = np.flatnonzero(np.isfinite(values))
    if turn is None or there.size < 2:
        return None
    told = values[there]
    jumps, rest = _jumps(told, turn)
    if not jumps.any() or np.ptp(told) > WITHIN * turn:
        return None
    followed = np.diff(there) == 1
    if np.abs(rest[followed]).max(initial=0.0) > SLOW * turn:
        return None
    gone_on = values.copy()
    gone_on[there[1:]] -= turn * np.cumsum(jumps)
    return gone_on, int(np.count_nonzero(jumps))


def _jumps(told: FloatArray, turn: float) -> tuple[NDArray[np.float64], FloatArray]:
    """Return by how many turns each step jumps, and what is left of the step."""
    steps = np.diff(told)
    jumps = np.rint(steps / turn)
    return jumps, steps - turn * jumps
