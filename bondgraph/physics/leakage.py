"""Flows lost or gained at a 0-junction: leaks, orifices, constant flows."""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Coefficient, E, F, Place
from bondgraph.physics.places.junction import (
    JunctionPlace,
    OneJunctionPlace,
    ZeroJunctionPlace,
)
from bondgraph.structure.domains import ANALOGUE, HYDRAULIC
from bondgraph.structure.edits import ReplaceRelation
from bondgraph.structure.elements import FlowSource, Resistance
from bondgraph.structure.signals import e, f


class Leak(AbstractPhysics):
    """A flow out of the junction proportional to its effort."""

    word = "leak"
    reference = "laminar leakage; insulation resistance; heat loss"
    passivity = Passivity.DISSIPATIVE
    signature = "a stock that empties by itself; taken for a smaller source"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions without a freely fitted linear R."""
        if not isinstance(place, ZeroJunctionPlace):
            return
        if place.has_free_linear(Resistance):
            return
        some = 0.2 * place.flow / place.effort
        g = place.strength("leak", place.unit(F, E), (0.0, some), low=0.0)
        law = g.symbol * e
        element = Resistance(place.name_of(self.word), law=law)
        words = f"{place.a(F)} lost in proportion to {place.domain.effort}"
        yield self.hypothesis(place, place.insert(element, g), law, (g,), words)


class SquareRootOrifice(AbstractPhysics):
    """A flow out of the junction with the square root of its effort."""

    word = "square_root_orifice"
    reference = "Torricelli 1643"
    passivity = Passivity.DISSIPATIVE
    signature = "a stock that empties in a parabola and to the end in finite time"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions; smooth within 0.1 % of the typical effort."""
        if not isinstance(place, ZeroJunctionPlace):
            return
        k = place.strength("orifice", place.unit(F), (0.0, 0.3 * place.flow), low=0.0)
        at = place.constant("orifice_effort", place.unit(E), place.effort)
        law = k.symbol * _smooth_root(e / at.symbol)
        element = Resistance(place.name_of(self.word), law=law)
        words = f"{place.a(F)} lost with the root of {place.domain.effort}"
        edit = place.insert(element, k, at)
        yield self.hypothesis(place, edit, law, (k, at), words)


class SquareLaw(AbstractPhysics):
    """A linear resistance that is a square law: effort grows with the flow squared.

    The outlet of a tank, a turbulent pipe, a fan: the linear law is replaced, since the
    two do not act side by side.
    """

    word = "square_root_orifice"
    reference = "Torricelli 1643; turbulent pressure loss"
    passivity = Passivity.DISSIPATIVE
    signature = "a resistance that seems smaller the less flows"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every fitted linear R of a hydraulic or analogue junction."""
        if not isinstance(place, JunctionPlace):
            return
        if place.domain not in (HYDRAULIC, ANALOGUE):
            return
        graph = place.graph
        for bond in graph.bonds_at(place.name):
            node = graph.node(bond.other(place.name))
            linear = isinstance(node, Resistance) and node.law is None
            if linear and not graph.parameters[node.name].exact:
                yield self._replaced(place, node.name)

    def _replaced(self, place: JunctionPlace, resistance: str) -> Hypothesis:
        """Write the law in the variable that the junction gives."""
        linear = place.graph.parameters[resistance].value or 1.0
        if isinstance(place, OneJunctionPlace):
            start = (linear / place.flow,)
            unit = place.unit(E, F, 2)
            k = place.shape(f"{resistance}_square", unit, start, low=0.0)
            law = k.symbol * f * sympy.Abs(f)
            coefficients: tuple[Coefficient, ...] = (k,)
        else:
            start = (place.effort / linear,)
            k = place.shape(f"{resistance}_flow", place.unit(F), start, low=0.0)
            at = place.constant(f"{resistance}_effort", place.unit(E), place.effort)
            law = k.symbol * _smooth_root(e / at.symbol)
            coefficients = (k, at)
        parameters = tuple(c.parameter for c in coefficients)
        words = (
            f"{resistance} passes {place.a(F)} that grows with the root of "
            f"{place.domain.effort}, not in proportion to it"
        )
        edit = ReplaceRelation(resistance, law, parameters)
        return self.hypothesis(place, edit, law, coefficients, words)


def _smooth_root(x: sympy.Expr) -> sympy.Expr:
    """Return the signed square root of x, smooth within 0.1 % of its range."""
    return x / (x**2 + sympy.Float(1e-6)) ** sympy.Rational(1, 4)


class ConstantFlow(AbstractPhysics):
    """A constant flow into the junction."""

    word = "constant_bias"
    reference = "offset of a source; ambient gain"
    passivity = Passivity.SOURCE
    signature = "a stock that drifts by itself"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions that have no fitted constant source."""
        if not isinstance(place, ZeroJunctionPlace) or place.has_free_bias:
            return
        b = place.strength("bias", place.unit(F))
        element = FlowSource(place.name_of(self.word), value=b.symbol)
        words = f"a constant {place.domain.flow}"
        yield self.hypothesis(place, place.insert(element, b), b.symbol, (b,), words)
