"""A relation without a name: a curve in one local variable.

Piecewise linear between knots over the range visited. It competes like any other
physics; where it explains clearly more than every named law, the honest answer is the
curve.
"""

from collections.abc import Iterator
from itertools import pairwise

import sympy

from bondgraph.physics.fields import restoring
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.place import E, F, Place, symbols
from bondgraph.structure import signals
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import OnePort, Resistance
from bondgraph.structure.parameters import Parameter

KNOTS = (-2.0, -1.0, -0.3, -0.03, 0.03, 0.3, 1.0, 2.0)
"""Knots of a law of flow, in typical flows; close about zero, where friction turns."""

EVEN_KNOTS = (-2.0, -1.2, -0.4, 0.4, 1.2, 2.0)
"""Knots of a law of displacement, in typical displacements."""


class UnknownRelation(AbstractPhysics):
    """A free curve of the flow, or of the displacement where that is known."""

    word = "unknown_relation"
    reference = "piecewise linear interpolation"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield a curve of each local variable of a junction."""
        if place.is_one_junction:
            yield self._curve(place, signals.f, F, place.flow, KNOTS)
            if place.displacement_known:
                quantity = Quantity.DISPLACEMENT
                size = place.displacement
                yield self._curve(place, signals.q, quantity, size, EVEN_KNOTS)
        else:
            yield self._curve(place, signals.e, E, place.effort, EVEN_KNOTS)

    def _curve(
        self,
        place: Place,
        variable: sympy.Symbol,
        quantity: Quantity,
        size: float,
        knots: tuple[float, ...],
    ) -> Hypothesis:
        answer = E if place.is_one_junction else F
        width = place.parameter(f"curve_{quantity}", place.unit(quantity), exact=size)
        heights = [
            place.parameter(f"curve_{i}", place.unit(answer)) for i in range(len(knots))
        ]
        (scale,) = symbols(width)
        law = _interpolation(variable / scale, knots, heights)
        name = place.name_of(f"unknown_{quantity}")
        element: OnePort
        if quantity is Quantity.DISPLACEMENT:
            element = restoring(place, name, law)
        else:
            element = Resistance(name, law=law)
        return Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(element, *heights, width),
            law=law,
            words=(
                f"{place.a(answer)} that is an unnamed function of "
                f"{place.domain.word(quantity)}"
            ),
            depends_on=(quantity.value,),
            starts=({height.name: 0.0 for height in heights},),
        )


def _interpolation(
    x: sympy.Expr, knots: tuple[float, ...], heights: list[Parameter]
) -> sympy.Expr:
    """Return the broken line through (knot, height), constant beyond the ends."""
    values = symbols(*heights)
    law = values[0]
    for (low, high), (a, b) in zip(pairwise(knots), pairwise(values), strict=True):
        share = sympy.Min(sympy.Max((x - low) / (high - low), 0), 1)
        law = law + (b - a) * share
    return law
