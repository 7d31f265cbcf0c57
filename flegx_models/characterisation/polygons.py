"""Convex polygons in the plane, cut by half-planes one after the other."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Polygon = tuple[tuple[float, float], ...]


def clipped(
    box: tuple[tuple[float, float], tuple[float, float]], A: FloatArray, b: FloatArray
) -> Polygon:
    """Return the corners of the part of `box` where A z ≤ b, counter-clockwise.

    Parameters
    ----------
    box
        Intervals of both coordinates. It is widened by a part in 10⁹ of its size, so
        that the rounding of its sides cuts nothing off.
    A, b
        One half-plane per row.
    """
    (x0, x1), (y0, y1) = (_widened(*side) for side in box)
    corners = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    for normal, limit in zip(A, b, strict=True):
        corners = _cut(corners, normal, float(limit))
    return tuple((float(x), float(y)) for x, y in corners)


def _widened(low: float, high: float) -> tuple[float, float]:
    margin = 1e-9 * max(high - low, abs(low), abs(high))
    return low - margin, high + margin


def _cut(corners: FloatArray, normal: FloatArray, limit: float) -> FloatArray:
    """Return the corners of a polygon after one cut (Sutherland and Hodgman 1974)."""
    height = corners @ normal - limit
    kept: list[FloatArray] = []
    for k in range(len(corners)):
        here, there = height[k - 1], height[k]
        if (here <= 0) != (there <= 0):
            share = here / (here - there)
            kept.append(corners[k - 1] + share * (corners[k] - corners[k - 1]))
        if there <= 0:
            kept.append(corners[k])
    return np.array(kept).reshape(-1, 2)
