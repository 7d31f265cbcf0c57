"""Readings that are held: a slow sensor in a fast log.

Between two of its updates the log repeats what was read last. That is told from a
sensor that merely does not resolve a change: it then changes by a step or two of its
grid, in any row; what is held changes by many, and hardly ever in two rows running.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.noise import quantisation

UPDATES = 20
"""Fewer changes say nothing of how they come."""

AT_ONCE = 0.05
"""Two changes in neighbouring rows are rarer than this where readings are held."""

STEPS = 4.0
"""Changes of fewer steps of the grid are what a sensor does not resolve."""


@dataclass(frozen=True, slots=True)
class Held:
    """Which rows repeat a reading, and how many rows there are to one, typically."""

    rows: NDArray[np.intp]
    every: int


def held(values: FloatArray) -> Held | None:
    """Return the rows in which a reading is merely repeated; None if it is not held.

    Parameters
    ----------
    values
        Samples of one channel in the order of time; nan where nothing was measured.
    """
    there = np.flatnonzero(np.isfinite(values))
    changes = np.diff(values[there])
    at = np.flatnonzero(changes)
    if at.size < UPDATES:
        return None
    lasting = np.diff(at)
    if np.mean(lasting == 1) > AT_ONCE:
        return None
    step = quantisation(values)
    if step is not None and np.median(np.abs(changes[at])) < STEPS * step:
        return None
    repeated = there[1:][changes == 0.0]
    return Held(repeated, int(np.median(lasting)))
