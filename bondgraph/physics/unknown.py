"""A relation without a name: a curve in one local variable.

Piecewise linear between knots over the range visited. It competes like any other
physics, with few knots and free heights; where it explains clearly more than every
named law, the honest answer is the curve. To be shown it is drawn finely, and how much
its slope may change from knot to knot is then limited by a prior.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.places.base import Coefficient, E, F, Place, Q
from bondgraph.physics.places.channels import InputPlace
from bondgraph.physics.places.junction import JunctionPlace, OneJunctionPlace
from bondgraph.physics.position import restoring
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import OnePort, Resistance
from bondgraph.structure.signals import e, effort, f, flow, q

Knots = tuple[float, ...]

TURNING = (-1.0, -0.3, -0.03, 0.03, 0.3, 1.0)
"""Knots of a law of flow, in typical flows: close about zero, where friction turns."""

EVEN = 6
"""Knots of any other law."""

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


@dataclass(frozen=True)
class UnknownRelation(AbstractPhysics):
    """A free curve of a local variable: flow, effort, displacement, or a command.

    Parameters
    ----------
    smooth
        None for few knots of free height, which find the place.
    """

    smooth: Smooth | None = None

    word = "unknown_relation"
    reference = "piecewise linear interpolation"
    signature = "whatever no named law gives"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield a curve of each local variable of a junction, two of an input."""
        if isinstance(place, OneJunctionPlace):
            yield self._curve(place, f, F)
            if place.displacement_known:
                yield self._curve(place, q, Q)
        elif isinstance(place, JunctionPlace):
            yield self._curve(place, e, E)
        elif isinstance(place, InputPlace):
            yield self._of_input(place)
            yield self._gain(place)

    def _drawn(
        self, place: Place, stem: str, unit: str, x: sympy.Expr, knots: Knots
    ) -> tuple[sympy.Expr, tuple[Coefficient, ...]]:
        """Return a curve of `x` through knots, and what is fitted of it."""
        if self.smooth is None:
            heights = tuple(
                place.strength(f"{stem}_{i}", unit) for i in range(len(knots))
            )
            return _interpolation(x, knots, heights), heights
        return _bending(place, stem, unit, x, knots, self.smooth)

    def _of_input(self, place: InputPlace) -> Hypothesis:
        """Apply a free curve of what is commanded."""
        half = place.peak / 2.0
        size = place.constant("curve_input", place.channel_unit, half)
        knots = _even(place.scales.range_of(place.name, half), half)
        unit, x = place.channel_unit, place.signal / size.symbol
        curve, heights = self._drawn(place, "curve", unit, x, knots)
        law = place.signal + curve
        words = f"{place.name} acts along an unnamed curve of what is commanded"
        edit = place.become(law, *heights, size)
        return self.hypothesis(place, edit, law, heights, words)

    def _gain(self, place: InputPlace) -> Hypothesis:
        """Make the gain a free curve of what the input meets, its flow or effort."""
        met = flow if place.is_one_junction(place.junction) else effort
        other = met(place.junction)
        unit, typical = place.unit(other.quantity), place.scales.of(other.name)
        size = place.constant("curve_met", unit, typical)
        visited = place.scales.range_of(other.name, typical)
        knots, x = _even(visited, typical), other / size.symbol
        curve, heights = self._drawn(place, "gain", "1", x, knots)
        law = place.signal * (1 + curve)
        words = f"{place.name} acts with a gain that changes with what it meets"
        edit = place.become(law, *heights, size)
        return self.hypothesis(place, edit, law, heights, words)

    def _curve(
        self, place: JunctionPlace, variable: sympy.Symbol, quantity: Quantity
    ) -> Hypothesis:
        answer = E if isinstance(place, OneJunctionPlace) else F
        size = _typical(place, quantity)
        knots = tuple(knot / size for knot in knots_at(place, quantity))
        width = place.constant(f"curve_{quantity}", place.unit(quantity), size)
        unit, x = place.unit(answer), variable / width.symbol
        law, heights = self._drawn(place, "curve", unit, x, knots)
        name = place.name_of(f"unknown_{quantity}")
        element: OnePort
        if quantity is Q:
            element = restoring(place, name, law)
        else:
            element = Resistance(name, law=law)
        words = (
            f"{place.a(answer)} that is an unnamed function of "
            f"{place.domain.word(quantity)}"
        )
        edit = place.insert(element, *heights, width)
        return self.hypothesis(place, edit, law, heights, words)


def knots_at(place: JunctionPlace, quantity: Quantity) -> Knots:
    """Return where a curve of a local variable has its knots, in the variable's unit.

    In the order of its heights.
    """
    size = _typical(place, quantity)
    visited = place.scales.range_of(f"{quantity}({place.name})", size)
    knots = (_turning if quantity is F else _even)(visited, size)
    return tuple(size * knot for knot in knots)


def _typical(place: JunctionPlace, quantity: Quantity) -> float:
    return {F: place.flow, Q: place.displacement}.get(quantity, place.effort)


def _even(visited: tuple[float, float], size: float) -> Knots:
    """Return knots over the range visited, in typical sizes.

    Beyond it they would stand where nothing tells how high.
    """
    low, high = (end / size for end in visited)
    return tuple(low + (high - low) * i / (EVEN - 1) for i in range(EVEN))


def _turning(visited: tuple[float, float], size: float) -> Knots:
    """Return knots close about zero where the flow turns, else even ones."""
    low, high = (end / size for end in visited)
    if not low < TURNING[0] < TURNING[-1] < high:
        return _even(visited, size)
    return (low, *TURNING, high)


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
    law = level.symbol + slope.symbol * (x - knots[middle])
    bends = []
    for i in range(1, len(knots) - 1):
        share = (knots[i + 1] - knots[i - 1]) / 2.0 / span
        std = smooth.roughness * smooth.size / span * share**0.5
        bend = about_zero(f"bend_{i}", std, slopes[i] - slopes[i - 1])
        away = x - knots[i]
        law += bend.symbol * (sympy.Abs(away) + (away if i > middle else -away)) / 2
        bends.append(bend)
    return law, (level, slope, *bends)


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
