"""Readings that are held: of a slow sensor, a frozen one, a logger held up.

Between two of its updates the log repeats what was read last. That is told from a
sensor that merely does not resolve a change: it then changes by a step or two of its
grid, in any row; what is held changes by many, and hardly ever in two rows running.

A machine may come to rest, and a reading with it; but it starts again as smoothly as it
moves. What stands still and then jumps to where the machine is by now was frozen.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.noise import estimate_noise, quantisation
from bondgraph.recordings.windows import SURE_GAP

UPDATES = 20
"""Fewer changes say nothing of how they come."""

AT_ONCE = 0.05
"""Two changes in neighbouring rows are rarer than this where readings are held."""

STEPS = 4.0
"""Changes of fewer steps of the grid are what a sensor does not resolve."""

FROZEN = 15
"""By noise as large as the grid's step so many readings in a row are not the same."""

JUMPS = 4.0
"""A change so many times as large as 95 of 100 others is a jump."""

NOISE = 8.0
"""And so many standard deviations of the noise."""


@dataclass(frozen=True, slots=True, eq=False)
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


def frozen(time: FloatArray, values: FloatArray) -> list[range]:
    """Return the stretches of rows in which a sensor has frozen.

    Parameters
    ----------
    time
        Seconds, strictly increasing.
    values
        Samples of one channel; nan where nothing was measured.
    """
    there = np.flatnonzero(np.isfinite(values))
    told = values[there]
    edges = np.flatnonzero(np.diff(told, prepend=np.nan, append=np.nan) != 0.0)
    long = np.flatnonzero(np.diff(edges) >= FROZEN)
    if not long.size:
        return []
    noise = estimate_noise(time, values)
    if noise.std < (noise.quantisation or 0.0) or noise.std == 0.0:
        return []
    changes = np.abs(np.diff(told))
    usual = JUMPS * float(np.quantile(changes[changes > 0.0], 0.95))
    stretches = [(int(edges[k]), int(edges[k + 1])) for k in long]
    return [
        range(int(there[begin]), int(there[end - 1]) + 1)
        for begin, end in stretches
        if end < told.size and changes[end - 1] > usual
    ]


def stale(time: FloatArray, values: FloatArray) -> NDArray[np.intp]:
    """Return the rows that end a gap in time with what was read before it.

    A logger that was held up writes its clock of now beside a reading of then: the next
    row jumps to where the machine is by now, from which it goes on smoothly.

    Parameters
    ----------
    time
        Seconds, strictly increasing.
    values
        Samples of one channel; nan where nothing was measured.
    """
    there = np.flatnonzero(np.isfinite(values))
    late, told = time[there], values[there]
    if late.size < UPDATES:
        return np.empty(0, dtype=np.intp)
    steps, changes = np.diff(late), np.abs(np.diff(told))
    gap = steps > SURE_GAP * np.median(steps)
    moving = changes[~gap & (changes > 0.0)]
    if not gap.any() or moving.size < UPDATES:
        return np.empty(0, dtype=np.intp)
    usual = JUMPS * float(np.quantile(moving, 0.95))
    jump = max(usual, NOISE * estimate_noise(time, values).std)
    ends = gap[:-2] & ~gap[1:-1] & ~gap[2:]
    goes_on = changes[2:] < changes[1:-1] / JUMPS
    rows: NDArray[np.intp] = there[1:-2][ends & (changes[1:-1] > jump) & goes_on]
    return rows
