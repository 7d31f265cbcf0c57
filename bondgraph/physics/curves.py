"""Free curves: a broken line between knots, or a smooth one drawn finely.

A broken line through few knots of free height finds a place. To be shown it is drawn
finely.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import sympy

from bondgraph.physics.bends import Knots
from bondgraph.physics.places.base import Coefficient, Place
from bondgraph.physics.smooth import Smooth, smooth_curve

TURNING = (-1.0, -0.3, -0.03, 0.03, 0.3, 1.0)
"""Knots of a law of flow, in typical flows: close about zero, where friction turns."""

BOTH_WAYS = ", the same both ways"
"""What is said of a curve that is odd."""

EVEN = 6
"""Knots of any other law of one variable."""

ALONG = 8
"""Knots of a size that changes along the way, no fewer than a law of flow has: a law of
two variables is not the plainer one.
"""


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
    *,
    odd: bool = False,
    bent: bool = False,
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
    odd
        Whether a smooth curve is the same both ways.
    bent
        Whether few heights are joined by a natural cubic spline instead: what is known
        to be smooth, and steep at its ends, no broken line through few knots follows.
    """
    if smooth is not None:
        smooth = replace(smooth, odd=odd)
        return smooth_curve(place, stem, unit, x, knots, smooth)
    starts = (0.0, level) if level else (0.0,)
    heights = tuple(
        place.strength(f"{stem}_{i}", unit, starts) for i in range(len(knots))
    )
    between = _spline if bent else _interpolation
    return between(x, knots, heights), heights


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
        sympy.Mul(after - before, _distance(x, knot), sympy.S.Half)
        for knot, (before, after) in zip(knots, bends, strict=True)
    )
    return sympy.Add((values[0] + values[-1]) / 2, *kinks)


def _distance(x: sympy.Expr, knot: float) -> sympy.Expr:
    """Return ``|x - knot|``, which sympy is not asked to simplify in vain.

    It looks for a sign, and for long. A quotient of real symbols has none where theirs
    are unknown, and no number beside it gives it one.
    """
    difference = x - knot
    powers = x.as_powers_dict().items()
    real = all(base.is_Symbol and base.is_real and n.is_Integer for base, n in powers)
    unsigned = real and x.is_nonnegative is None and x.is_nonpositive is None
    if not (unsigned and difference.is_Add):
        return sympy.Abs(difference)
    # Of a difference and its opposite, of the same distance, sympy keeps this one.
    turned = difference.could_extract_minus_sign()
    return sympy.Abs(-difference if turned else difference, evaluate=False)


def _spline(
    x: sympy.Expr, knots: Knots, heights: tuple[Coefficient, ...]
) -> sympy.Expr:
    """Return the natural cubic spline through (knot, height), straight beyond the ends.

    A line and a sum of ``|x - knot|^3``, whose sizes follow from the heights.
    """
    at, n = np.array(knots), len(knots)
    line = np.column_stack([np.ones(n), at])
    cubes = np.abs(at[:, None] - at) ** 3
    known = np.block([[cubes, line], [line.T, np.zeros((2, 2))]])
    sizes = np.linalg.inv(known)[:, :n]

    def size(row: int) -> sympy.Expr:
        terms = zip(sizes[row], heights, strict=True)
        return sympy.Add(*(float(share) * height.symbol for share, height in terms))

    bends = (size(i) * _distance(x, knot) ** 3 for i, knot in enumerate(knots))
    return sympy.Add(size(n), size(n + 1) * x, *bends)
