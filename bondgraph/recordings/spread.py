"""How far the samples of channels spread: what their errors are relative to."""

import numpy as np
from numpy.typing import NDArray

from bondgraph.recordings.channel import FloatArray


def spread(samples: FloatArray) -> FloatArray:
    """Return the standard deviation of each column; missing samples do not count.

    Exactly 0 where all samples are equal: rounding leaves the mean of equal numbers a
    little beside them, and an error relative to that would be astronomical.
    """
    deviation: FloatArray = np.where(changes(samples), np.nanstd(samples, axis=0), 0.0)
    return deviation


def changes(samples: FloatArray) -> NDArray[np.bool_]:
    """Return for each column whether two of its samples differ."""
    differ: NDArray[np.bool_] = np.nanmax(samples, axis=0) > np.nanmin(samples, axis=0)
    return differ


def size(samples: FloatArray) -> FloatArray:
    """Return a positive size of each column: its spread, where it has one.

    Otherwise the size of what it holds; 1 where it holds nothing but zeros.
    """
    deviation, held = spread(samples), np.nanmax(np.abs(samples), axis=0)
    one: FloatArray = np.where(
        deviation > 0.0, deviation, np.where(held > 0.0, held, 1.0)
    )
    return one
