"""Free curves: a broken line between knots, or a smooth one drawn finely.

A broken line through few knots of free height finds a place. To be shown it is drawn
finely, and how much its slope may change from knot to knot is then limited by a prior.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import sympy

from bondgraph.physics.places.base import Coefficient, Place

Knots = tuple[float, ...]

TURNING = (-1.0, -0.3, -0.03, 0.03, 0.3, 1.0)
"""Knots of a law of flow, in typical flows: close about zero, where friction turns."""

EVEN = 6
"""Knots of any other law of one variable."""

ALONG = 8
"""Knots of a size that changes along the way, no fewer than a law of flow has: a law of
two variables is not the plainer one.
"""

WEAKLY = 3.0
"""Standard deviation of a smooth curve's level and slope amid, in its own size: told by
the recordings where these tell them, and not wholly open where another law shares them.
"""


@dataclass(frozen=True, slots=True)
class Smooth:
    """How smooth a finely drawn curve is.

    Parameters
    ----------
    heights
        Of the first curve at its knots: where a fit starts, and the size of the curve.
    pieces
        Into how many each stretch between two knots of the first curve is divided.
    roughness
        How much its slope wanders over the range, in heights per range: the changes of
        slope are independent and as large as their distance allows (an integrated
        Wiener process, whose mean is a cubic smoothing spline; Wahba, J. R. Statist.
        Soc. B 40, 1978).
    """

    heights: tuple[float, ...]
    pieces: int
    roughness: float

    @property
    def size(self) -> float:
        """Return how far the first curve goes up and down."""
        return (max(self.heights) - min(self.heights)) or 1.0


def even(visited: tuple[float, float], size: float, count: int = EVEN) -> Knots:
    """Return knots over the range visited, in typical sizes.

    Beyond it they would stand where nothing tells how high.
    """
    low, high = (end / size for end in visited)
    return tuple(low + (high - low) * i / (count - 1) for i in range(count))


def turning(visited: tuple[float, float], size: float) -> Knots:
    """Return knots close about zero where the flow turns, else even ones."""
    low, high = (end / size for end in visited)
    if not low < TURNING[0] < TURNING[-1] < high:
        return even(visited, size)
    return (low, *TURNING, high)


def drawn(
    place: Place,
    stem: str,
    unit: str,
    x: sympy.Expr,
    knots: Knots,
    smooth: Smooth | None,
    level: float = 0.0,
) -> tuple[sympy.Expr, tuple[Coefficient, ...]]:
    """Return the curve of `x` through knots, and what is fitted of it.

    Parameters
    ----------
    stem, unit
        Of the names of its heights at `place`, and what they are measured in.
    smooth
        None for a broken line with a free height at every knot.
    level
        Of a second start of a broken line, the same at every knot.
    """
    if smooth is not None:
        return _bending(place, stem, unit, x, knots, smooth)
    starts = (0.0, level) if level else (0.0,)
    heights = tuple(
        place.strength(f"{stem}_{i}", unit, starts) for i in range(len(knots))
    )
    return _interpolation(x, knots, heights), heights


def _bending(
    place: Place, stem: str, unit: str, x: sympy.Expr, first: Knots, smooth: Smooth
) -> tuple[sympy.Expr, tuple[Coefficient, ...]]:
    """Return a smooth curve through divided knots, and its coefficients.

    From a middle knot, with the slope after it, the curve bends outwards at each other,
    and goes on straight beyond its ends.
    """
    knots = _divided(first, smooth.pieces)
    known = np.arange(len(smooth.heights))
    values = np.interp(np.arange(len(knots)) / smooth.pieces, known, smooth.heights)
    slopes = np.diff(values) / np.diff(knots)
    span, middle = knots[-1] - knots[0], (len(knots) - 1) // 2

    def about_zero(what: str, std: float, start: float) -> Coefficient:
        free = place.strength(f"{stem}_{what}", unit)
        parameter = replace(free.parameter, std=std)
        return replace(free, parameter=parameter, starts=(float(start),))

    level = about_zero("level", WEAKLY * smooth.size, values[middle])
    slope = about_zero("slope", WEAKLY * smooth.size / span, slopes[middle])
    terms = [level.symbol, slope.symbol * (x - knots[middle])]
    bends = []
    for i in range(1, len(knots) - 1):
        share = (knots[i + 1] - knots[i - 1]) / 2.0 / span
        std = smooth.roughness * smooth.size / span * share**0.5
        bend = about_zero(f"bend_{i}", std, slopes[i] - slopes[i - 1])
        away = x - knots[i]
        outwards = sympy.Abs(away) + (away if i > middle else -away)
        terms.append(bend.symbol * outwards / 2)
        bends.append(bend)
    return sympy.Add(*terms), (level, slope, *bends)


def _divided(knots: Knots, pieces: int) -> Knots:
    """Return the knots with others evenly between them."""
    between = [
        low + (high - low) * i / pieces
        for low, high in pairwise(knots)
        for i in range(pieces)
    ]
    return (*between, knots[-1])


def _interpolation(
    x: sympy.Expr, knots: Knots, heights: tuple[Coefficient, ...]
) -> sympy.Expr:
    """Return the broken line through (knot, height), constant beyond the ends.

    A sum of ``|x - knot|``, each with half the change of slope at its knot.
    """
    values = [height.symbol for height in heights]
    slopes = [
        (b - a) / (high - low)
        for (low, high), (a, b) in zip(pairwise(knots), pairwise(values), strict=True)
    ]
    bends = pairwise((sympy.S.Zero, *slopes, sympy.S.Zero))
    kinks = (
        sympy.Mul(after - before, sympy.Abs(x - knot), sympy.S.Half)
        for knot, (before, after) in zip(knots, bends, strict=True)
    )
    return sympy.Add((values[0] + values[-1]) / 2, *kinks)
