"""A relation without a name: a curve in one local variable.

Piecewise linear between knots over the range visited. It competes like any other
physics; where it explains clearly more than every named law, the honest answer is the
curve.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.places.base import Coefficient, E, F, Place, Q
from bondgraph.physics.places.channels import InputPlace
from bondgraph.physics.places.junction import JunctionPlace, OneJunctionPlace
from bondgraph.physics.position import restoring
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import OnePort, Resistance
from bondgraph.structure.signals import e, effort, f, flow, q

TURNING = (-1.0, -0.3, -0.03, 0.03, 0.3, 1.0)
"""Knots of a law of flow, in typical flows: close about zero, where friction turns."""

EVEN = 6
"""Knots of any other law."""


@dataclass(frozen=True)
class UnknownRelation(AbstractPhysics):
    """A free curve of a local variable: flow, effort, displacement, or a command.

    Parameters
    ----------
    pieces
        Into how many each stretch between two knots is divided. Few knots find the
        place; the curve that is shown has as many as the data tell.
    """

    pieces: int = 1

    word = "unknown_relation"
    reference = "piecewise linear interpolation"
    signature = "whatever no named law gives"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield a curve of each local variable of a junction, two of an input."""
        if isinstance(place, OneJunctionPlace):
            yield self._curve(place, f, F, place.flow)
            if place.displacement_known:
                yield self._curve(place, q, Q, place.displacement)
        elif isinstance(place, JunctionPlace):
            yield self._curve(place, e, E, place.effort)
        elif isinstance(place, InputPlace):
            yield self._of_input(place)
            yield self._gain(place)

    def _divided(self, knots: tuple[float, ...]) -> tuple[float, ...]:
        """Return the knots with others evenly between them."""
        parts = range(self.pieces)
        between = [
            low + (high - low) * i / self.pieces
            for low, high in pairwise(knots)
            for i in parts
        ]
        return (*between, knots[-1])

    def _of_input(self, place: InputPlace) -> Hypothesis:
        """Apply a free curve of what is commanded."""
        half = place.peak / 2.0
        size = place.constant("curve_input", place.channel_unit, half)
        knots = self._divided(_even(place.scales.range_of(place.name, half), half))
        heights = tuple(
            place.strength(f"curve_{i}", place.channel_unit) for i in range(len(knots))
        )
        curve = _interpolation(place.signal / size.symbol, knots, heights)
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
        knots = self._divided(_even(visited, typical))
        heights = tuple(place.strength(f"gain_{i}", "1") for i in range(len(knots)))
        curve = _interpolation(other / size.symbol, knots, heights)
        law = place.signal * (1 + curve)
        words = f"{place.name} acts with a gain that changes with what it meets"
        edit = place.become(law, *heights, size)
        return self.hypothesis(place, edit, law, heights, words)

    def _curve(
        self,
        place: JunctionPlace,
        variable: sympy.Symbol,
        quantity: Quantity,
        size: float,
    ) -> Hypothesis:
        answer = E if isinstance(place, OneJunctionPlace) else F
        visited = place.scales.range_of(f"{quantity}({place.name})", size)
        knots = self._divided((_turning if quantity is F else _even)(visited, size))
        width = place.constant(f"curve_{quantity}", place.unit(quantity), size)
        unit = place.unit(answer)
        heights = tuple(place.strength(f"curve_{i}", unit) for i in range(len(knots)))
        law = _interpolation(variable / width.symbol, knots, heights)
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


def _even(visited: tuple[float, float], size: float) -> tuple[float, ...]:
    """Return knots over the range visited, in typical sizes.

    Beyond it they would stand where nothing tells how high.
    """
    low, high = (end / size for end in visited)
    return tuple(low + (high - low) * i / (EVEN - 1) for i in range(EVEN))


def _turning(visited: tuple[float, float], size: float) -> tuple[float, ...]:
    """Return knots close about zero where the flow turns, else even ones."""
    low, high = (end / size for end in visited)
    if not low < TURNING[0] < TURNING[-1] < high:
        return _even(visited, size)
    return (low, *TURNING, high)


def _interpolation(
    x: sympy.Expr, knots: tuple[float, ...], heights: tuple[Coefficient, ...]
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
