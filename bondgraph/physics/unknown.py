"""A relation without a name: a free curve in one local variable.

It competes like any other physics; where it explains clearly more than every named law,
the honest answer is the curve. A curve of the displacement may also tell how large a
friction is along the way, or how a ratio changes.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import sympy

from bondgraph.physics.bends import Knots
from bondgraph.physics.curves import ALONG, BOTH_WAYS, drawn, even, turning
from bondgraph.physics.dry_friction import direction
from bondgraph.physics.hypothesis import AbstractPhysics, Form, Hypothesis, Shape
from bondgraph.physics.places.base import MECHANICAL, Coefficient, E, F, Place, Q
from bondgraph.physics.places.channels import InputPlace
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import (
    JunctionPlace,
    OneJunctionPlace,
)
from bondgraph.physics.position import restoring
from bondgraph.physics.smooth import Smooth
from bondgraph.physics.unknown_elements import forms_of_element, passes
from bondgraph.physics.unknown_elsewhere import forms_of_others
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import OnePort, Resistance
from bondgraph.structure.signals import e, effort, f, flow, q


@dataclass(frozen=True)
class UnknownRelation(AbstractPhysics):
    """A free curve of what is local; of a friction's size, or a ratio, on the way.

    Or of something recorded elsewhere that steers a resistance.

    Parameters
    ----------
    smooth
        None for few knots of free height, which find the place.
    visited
        The range of a common flow or effort, or a displacement, to draw over; None for
        that which the base model goes through.
    """

    smooth: Smooth | None = None
    visited: tuple[float, float] | None = None

    word = "unknown_relation"
    reference = "piecewise linear interpolation"
    signature = "whatever no named law gives"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield curves of what is local at a junction, an input, a TF or a GY."""
        return (form() for form in self.forms(place))

    def forms(self, place: Place) -> Iterator[Form]:
        """Yield what makes each of these curves; a finely drawn one is long to write.

        In the same order however smooth they are.
        """
        if isinstance(place, OneJunctionPlace):
            if not passes(place):
                yield partial(self._curve, place, f, F)
            if place.displacement_known:
                yield partial(self._curve, place, q, Q)
                if place.domain in MECHANICAL:
                    yield partial(self._rubbing, place)
                    yield partial(self._damping, place)
            yield from forms_of_others(self.hypothesis, place, self.smooth)
        elif isinstance(place, JunctionPlace):
            yield partial(self._curve, place, e, E)
        elif isinstance(place, InputPlace):
            yield partial(self._of_input, place)
            if not place.meets_itself:
                yield partial(self._gain, place)
        elif isinstance(place, ElementPlace):
            yield from forms_of_element(self.hypothesis, place, self.smooth)

    def _odd(self, knots: Knots) -> bool:
        return self.smooth is not None and self.smooth.is_odd_over(knots)

    def _of_input(self, place: InputPlace) -> Hypothesis:
        """Apply a free curve of what is commanded."""
        half = place.peak / 2.0
        size = place.constant("curve_input", place.channel_unit, half)
        knots = even(place.range, half)
        unit, x = place.channel_unit, place.signal / size.symbol
        odd = self._odd(knots)
        curve, heights = drawn(place, "curve", unit, x, knots, self.smooth, odd=odd)
        law = place.signal + curve
        words = f"{place.name} acts along an unnamed curve of what is commanded"
        words += BOTH_WAYS if odd else ""
        edit = place.become(law, *heights, size)
        found = self.hypothesis(place, edit, law, heights, words)
        given = (place.signal, f"{place.name} as commanded", unit)
        return replace(found, shape=Shape(*given, law, "what acts", unit))

    def _gain(self, place: InputPlace) -> Hypothesis:
        """Make the gain a free curve of what the input meets, its flow or effort."""
        met = flow if place.is_one_junction(place.junction) else effort
        other = met(place.junction)
        unit, typical = place.unit(other.quantity), place.scales.of(other.name)
        size = place.constant("curve_met", unit, typical)
        visited = place.scales.range_of(other.name, typical)
        knots, x = even(visited, typical), other / size.symbol
        curve, heights = drawn(place, "gain", "1", x, knots, self.smooth)
        law = place.signal * (1 + curve)
        words = f"{place.name} acts with a gain that changes with what it meets"
        edit = place.become(law, *heights, size)
        found = self.hypothesis(place, edit, law, heights, words)
        name = place.graph.domain_at(place.junction).word(other.quantity)
        return replace(found, shape=Shape(other, name, unit, 1 + curve, "gain", "1"))

    def _curve(
        self, place: JunctionPlace, variable: sympy.Symbol, quantity: Quantity
    ) -> Hypothesis:
        """Hang a curve of a local variable at a junction."""
        answer = E if isinstance(place, OneJunctionPlace) else F
        size, visited = _typical(place, quantity), self.visited
        visited = visited or _visited(place, quantity)
        knots = tuple(knot / size for knot in knots_at(place, quantity, visited))
        width = place.constant(f"curve_{quantity}", place.unit(quantity), size)
        unit, x = place.unit(answer), variable / width.symbol
        odd = self._odd(knots)
        law, heights = drawn(place, "curve", unit, x, knots, self.smooth, odd=odd)
        name = place.name_of(f"unknown_{quantity}")
        element: OnePort
        if quantity is Q:
            element = restoring(place, name, law)
        else:
            element = Resistance(name, law=law)
        words = (
            f"{place.a(answer)} that is an unnamed function of "
            f"{place.domain.word(quantity)}{BOTH_WAYS if odd else ''}"
        )
        edit = place.insert(element, *heights, width)
        found = self.hypothesis(place, edit, law, heights, words)
        return replace(found, visited=visited)

    def _rubbing(self, place: OneJunctionPlace) -> Hypothesis:
        """Hang dry friction whose size is a curve of the way."""
        factor, edge = direction(place)
        unit, some = place.unit(E), 0.3 * place.effort
        words = f"{place.a(E)} against the motion whose size changes along the way"
        return self._along(place, "rubbing", factor, unit, some, words, edge)

    def _damping(self, place: OneJunctionPlace) -> Hypothesis:
        """Hang viscous friction whose size is a curve of the way."""
        unit, some = place.unit(E, F), 0.2 * place.effort / place.flow
        words = f"{place.a(E)} proportional to {place.domain.flow}, as the way has it"
        return self._along(place, "damping", f, unit, some, words)

    def _along(
        self,
        place: OneJunctionPlace,
        stem: str,
        factor: sympy.Expr,
        unit: str,
        some: float,
        words: str,
        *shaped: Coefficient,
    ) -> Hypothesis:
        """Hang what has a size, a curve of the displacement."""
        way = place.displacement
        knots = even(_visited(place, Q), way, ALONG)
        width = place.constant(f"curve_{Q}", place.unit(Q), way)
        x = q / width.symbol
        curve, heights = drawn(place, "curve", unit, x, knots, self.smooth, some)
        law, own = factor * curve, (*heights, *shaped)
        element = restoring(place, place.name_of(f"unknown_{stem}"), law)
        edit = place.insert(element, *own, width)
        found = self.hypothesis(place, edit, law, own, words)
        return replace(found, factor=factor)


def knots_at(
    place: JunctionPlace, quantity: Quantity, visited: tuple[float, float]
) -> Knots:
    """Return where a curve of a local variable has its knots, in the variable's unit.

    In the order of its heights.

    Parameters
    ----------
    visited
        The range to draw over.
    """
    size = _typical(place, quantity)
    knots = (turning if quantity is F else even)(visited, size)
    return tuple(size * knot for knot in knots)


def _visited(place: JunctionPlace, quantity: Quantity) -> tuple[float, float]:
    """Return the range of a local variable that the base model has gone through."""
    name = f"{quantity}({place.name})"
    return place.scales.range_of(name, _typical(place, quantity))


def _typical(place: JunctionPlace, quantity: Quantity) -> float:
    return {F: place.flow, Q: place.displacement}.get(quantity, place.effort)
