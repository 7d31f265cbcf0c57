"""Smooth curves, drawn finely: how fast a slope may change is limited by a prior.

A curve bends at knots that are many and close; what a broken line through few knots has
found is where it starts. It may be held to go the same both ways about zero, which
halves what the recordings have to tell.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.physics.places.base import Coefficient, Place

Knots = tuple[float, ...]

WEAKLY = 3.0
"""Standard deviation of a smooth curve's level and slope amid, in its own size: told by
the recordings where these tell them, and not wholly open where another law shares them.
"""

BOTH = 0.3
"""How far the shorter way goes, of the longer one, where both may be the same."""

GRID = 401
"""Points at which a curve is held against a line."""


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
    odd
        Whether it is the same both ways, where it goes enough of both.
    """

    heights: tuple[float, ...]
    pieces: int
    roughness: float
    odd: bool = False

    @property
    def size(self) -> float:
        """Return how far the first curve goes up and down."""
        return (max(self.heights) - min(self.heights)) or 1.0

    def begin(self, at: Sequence[float], first: Knots) -> NDArray[np.float64]:
        """Return the first curve, the broken line through its knots."""
        return np.asarray(np.interp(at, first, self.heights[: len(first)]))

    def is_odd_over(self, knots: Knots) -> bool:
        """Return whether it is the same both ways, and `knots` go enough of both."""
        ways = (-knots[0], knots[-1])
        return self.odd and min(ways) > BOTH * max(ways)


@dataclass(frozen=True)
class _Pen:
    """What draws one curve: names and priors of its coefficients."""

    place: Place
    stem: str
    unit: str
    smooth: Smooth
    span: float

    def free(self, what: str, std: float, start: float) -> Coefficient:
        """Return a coefficient that is zero but for `std`, and where a fit starts."""
        free = self.place.strength(f"{self.stem}_{what}", self.unit)
        parameter = replace(free.parameter, std=std)
        return replace(free, parameter=parameter, starts=(float(start),))

    def level(self, start: float) -> Coefficient:
        """Return how high the curve is amid."""
        return self.free("level", WEAKLY * self.smooth.size, start)

    def slope(self, start: float) -> Coefficient:
        """Return how steep the curve is amid."""
        return self.free("slope", WEAKLY * self.smooth.size / self.span, start)

    def bends(self, knots: Knots, slopes: NDArray[np.float64]) -> Iterator[Coefficient]:
        """Yield how much the slope changes at each knot that has two neighbours."""
        steepness = self.smooth.roughness * self.smooth.size / self.span
        for i in range(1, len(knots) - 1):
            share = (knots[i + 1] - knots[i - 1]) / 2.0 / self.span
            change = slopes[i] - slopes[i - 1]
            yield self.free(f"bend_{i}", steepness * share**0.5, change)


def bending(
    place: Place, stem: str, unit: str, x: sympy.Expr, first: Knots, smooth: Smooth
) -> tuple[sympy.Expr, tuple[Coefficient, ...]]:
    """Return a smooth curve through divided knots, and its coefficients.

    Level and slope are those of the line that is nearest to it over the range: where
    another law takes what is proportional, it takes that line. The curve goes on
    straight beyond its ends.
    """
    knots = _divided(first, smooth.pieces)
    values = smooth.begin(knots, first)
    grid = np.linspace(knots[0], knots[-1], GRID)
    amid = float(grid.mean())
    pen = _Pen(place, stem, unit, smooth, knots[-1] - knots[0])
    steepness, height = np.polyfit(grid - amid, np.interp(grid, knots, values), 1)
    level, slope = pen.level(height), pen.slope(steepness)
    bends = tuple(pen.bends(knots, np.diff(values) / np.diff(knots)))
    terms = [level.symbol, slope.symbol * (x - amid)]
    for knot, bend in zip(knots[1:], bends, strict=False):
        part = np.polyfit(grid - amid, np.abs(grid - knot) / 2, 1)
        line = float(part[0]) * (x - amid) + float(part[1])
        terms.append(bend.symbol * (sympy.Abs(x - knot) / 2 - line))
    return sympy.Add(*terms), (level, slope, *bends)


def same_both_ways(
    place: Place, stem: str, unit: str, x: sympy.Expr, first: Knots, smooth: Smooth
) -> tuple[sympy.Expr, tuple[Coefficient, ...]]:
    """Return a smooth curve that is odd about zero, and its coefficients.

    It bends at the divided knots of the side that reaches further, and at their mirror
    images as much the other way.
    """
    side = first if first[-1] >= -first[0] else tuple(-knot for knot in first[::-1])
    knots = _divided((0.0, *(knot for knot in side if knot > 0)), smooth.pieces)
    there, back = (smooth.begin([way * at for at in knots], first) for way in (1, -1))
    values = (there - back) / 2.0
    grid = np.linspace(0.0, knots[-1], GRID)
    pen = _Pen(place, stem, unit, smooth, 2.0 * knots[-1])
    slope = pen.slope(_proportion(grid, np.interp(grid, knots, values)))
    bends = tuple(pen.bends(knots, np.diff(values) / np.diff(knots)))
    terms = [slope.symbol * x]
    for knot, bend in zip(knots[1:], bends, strict=False):
        part = _proportion(grid, np.maximum(grid - knot, 0.0))
        beyond = (sympy.Abs(x - knot) - sympy.Abs(x + knot)) / 2 + x
        terms.append(bend.symbol * (beyond - part * x))
    return sympy.Add(*terms), (slope, *bends)


def _proportion(x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    """Return the slope of the line through zero that is nearest to a curve."""
    return float(x @ y / (x @ x))


def _divided(knots: Knots, pieces: int) -> Knots:
    """Return the knots with others evenly between them."""
    between = [
        low + (high - low) * i / pieces
        for low, high in pairwise(knots)
        for i in range(pieces)
    ]
    return (*between, knots[-1])
