"""Smooth curves, drawn finely: how fast a slope may change is limited by a prior.

A curve bends at knots that are many and close; what a broken line through few knots has
found is where it starts. It may be held to go the same both ways about zero, which
halves what the recordings have to tell. Where a flow turns it may also jump, as
friction does.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import pairwise

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.physics.bends import WEAKLY, Knots, Part, odd_parts, parts, ramp
from bondgraph.physics.places.base import Coefficient, Place

FloatArray = NDArray[np.float64]

BOTH = 0.3
"""How far the shorter way goes, of the longer one, where both may be the same."""

CLOSE = 0.05
"""Of the range: knots about zero that are closer together mark where a flow turns."""

GRID = 401
"""Points at which a curve is held against a line."""

KEPT = 16
"""Of how many curves the bends are kept, written out."""


@dataclass(frozen=True, slots=True)
class Smooth:
    """How smooth a finely drawn curve is.

    Parameters
    ----------
    heights
        Of the first curve at its knots: where a fit starts, and the size of the curve.
    pieces
        Into how many a stretch between two knots of the first curve is divided, in the
        mean.
    roughness
        How much its slope wanders over the range, in heights per range: the changes of
        slope are independent and as large as their distance allows (an integrated
        Wiener process, whose mean is a cubic smoothing spline; Wahba, J. R. Statist.
        Soc. B 40, 1978).
    odd
        Whether it is the same both ways, where it goes enough of both.
    without
        Of its `LINES` those that stay zero: others in the model take them.
    corners
        How much more than elsewhere its slope may change at a knot, by the name of the
        bend there; empty where it may as much at each.
    """

    heights: tuple[float, ...]
    pieces: int
    roughness: float
    odd: bool = False
    without: frozenset[str] = frozenset()
    corners: tuple[tuple[str, float], ...] = ()

    @property
    def size(self) -> float:
        """Return how far the first curve goes up and down."""
        return (max(self.heights) - min(self.heights)) or 1.0

    def begin(self, at: FloatArray, first: Knots) -> FloatArray:
        """Return the broken line of the first curve, or its odd part."""
        heights = self.heights[: len(first)]
        there = np.asarray(np.interp(at, first, heights))
        if self.is_odd_over(first):
            return (there - np.interp(-at, first, heights)) / 2.0
        return there

    def is_odd_over(self, knots: Knots) -> bool:
        """Return whether it is the same both ways, and `knots` go enough of both."""
        ways = (-knots[0], knots[-1])
        return self.odd and min(ways) > BOTH * max(ways)


def smooth_curve(
    place: Place, stem: str, unit: str, x: sympy.Expr, first: Knots, smooth: Smooth
) -> tuple[sympy.Expr, tuple[Coefficient, ...]]:
    """Return a smooth curve through divided knots, and its coefficients.

    Its level and slope are those of the line that is nearest, over the range, to all of
    it but its jump: where another law takes what is proportional, it takes that line.
    The curve goes on straight beyond its ends. One that is odd bends at the divided
    knots of the side that reaches further, and at their mirror images as much the other
    way.
    """
    odd = smooth.is_odd_over(first)
    knots = _divided(_one_way(first) if odd else first, smooth.pieces)
    lines, bends = (odd_parts if odd else parts)(knots)
    grid = np.linspace(knots[0], knots[-1], GRID)
    rest, own, terms = smooth.begin(np.array(knots), first), [], []
    on_grid = smooth.begin(grid, first)

    def free(part: Part, start: float, std: float = smooth.size) -> sympy.Symbol:
        coefficient = place.strength(f"{stem}_{part.name}", unit)
        parameter = replace(coefficient.parameter, std=std * part.share)
        own.append(replace(coefficient, parameter=parameter, starts=(float(start),)))
        return coefficient.symbol

    taken = None
    if edge := _edge(first):
        # The jump bends where it ends: there it takes the place of a bend.
        jump, taken = Part("jump", partial(ramp, edge=edge), WEAKLY), _at(knots, edge)
        height = -edge * float(_changes(knots, rest)[taken])
        rest = rest - height * jump.curve(np.array(knots))
        on_grid = on_grid - height * jump.curve(grid)
        terms.append(free(jump, height) * jump.curve(x))
    straight, bent = _drawn(x, knots, odd)
    starts = _nearest(lines, grid) @ on_grid
    for line, start, curve in zip(lines, starts, straight, strict=True):
        if line.name not in smooth.without:
            terms.append(free(line, start) * curve)
    each = zip(bends, _changes(knots, rest), bent, strict=True)
    corners, rough = dict(smooth.corners), smooth.roughness * smooth.size
    for i, (bend, change, curve) in enumerate(each):
        if i != taken:
            symbol = free(bend, change, rough * corners.get(bend.name, 1.0))
            terms.append(symbol * curve)
    return sympy.Add(*terms), tuple(own)


@lru_cache(maxsize=KEPT)
def _drawn(
    x: sympy.Expr, knots: Knots, odd: bool
) -> tuple[tuple[sympy.Expr, ...], tuple[sympy.Expr, ...]]:
    """Return the lines of `x`, and its bends, each less the line that is nearest to it.

    The same at every roughness, and so many that they take long to write.
    """
    lines, bends = (odd_parts if odd else parts)(knots)
    grid = np.linspace(knots[0], knots[-1], GRID)
    near = _nearest(lines, grid)
    straight, bent = [line.curve(x) for line in lines], []
    for bend in bends:
        along = near @ bend.curve(grid)
        line = sum(float(c) * one for c, one in zip(along, straight, strict=True))
        bent.append(bend.curve(x) - line)
    return tuple(straight), tuple(bent)


def _nearest(lines: Sequence[Part], grid: FloatArray) -> FloatArray:
    """Return what gives, of a curve on a grid, the sizes of the lines nearest to it."""
    return np.linalg.pinv(np.column_stack([line.curve(grid) for line in lines]))


def _changes(knots: Knots, heights: FloatArray) -> FloatArray:
    """Return by how much the slope changes at each knot that has two neighbours."""
    changes: FloatArray = np.diff(np.diff(heights) / np.diff(knots))
    return changes


def _at(knots: Knots, x: float) -> int:
    """Return which of the knots that have two neighbours is nearest to `x`."""
    return int(np.argmin(np.abs(np.array(knots[1:-1]) - x)))


def _one_way(knots: Knots) -> Knots:
    """Return zero and the knots of the side that reaches further."""
    side = knots if knots[-1] >= -knots[0] else tuple(-knot for knot in knots[::-1])
    return (0.0, *(knot for knot in side if knot > 0))


def _edge(knots: Knots) -> float:
    """Return how far from zero the knots are that stand close about it; else 0."""
    about = min(knots, key=abs), min(knots[::-1], key=abs)
    low, high = sorted(about)
    close = low < 0.0 < high <= CLOSE * (knots[-1] - knots[0])
    return high if close else 0.0


def _divided(knots: Knots, pieces: int) -> Knots:
    """Return the knots with others evenly between each two of them.

    In the mean so many pieces; where the first are far apart more than where they are
    close, as the square root of the distance: a curve may bend anywhere.
    """
    roots = np.sqrt(np.diff(knots))
    counts = np.maximum(np.rint(pieces * roots / roots.mean()), 1).astype(int)
    between = [
        low + (high - low) * i / count
        for (low, high), count in zip(pairwise(knots), counts.tolist(), strict=True)
        for i in range(count)
    ]
    return (*between, knots[-1])
