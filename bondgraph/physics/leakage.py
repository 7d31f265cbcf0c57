"""Flows lost or gained at a 0-junction: leaks, orifices, constant flows."""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.place import E, F, Place, symbols
from bondgraph.structure import signals
from bondgraph.structure.domains import ANALOGUE, HYDRAULIC
from bondgraph.structure.edits import ReplaceRelation
from bondgraph.structure.elements import FlowSource, Resistance
from bondgraph.structure.parameters import Parameter


class Leak(AbstractPhysics):
    """A flow out of the junction proportional to its effort."""

    word = "leak"
    reference = "laminar leakage; insulation resistance; heat loss"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions without a freely fitted linear R."""
        if not place.is_zero_junction or place.has_free_linear(Resistance):
            return
        g = place.parameter("leak", place.unit(F, E), low=0.0)
        (conductance,) = symbols(g)
        law = conductance * signals.e
        name = place.name_of("leak")
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(Resistance(name, law=law), g),
            law=law,
            words=f"{place.a(F)} lost in proportion to {place.domain.effort}",
            depends_on=("effort",),
            starts=({g.name: 0.0}, {g.name: 0.2 * place.flow / place.effort}),
        )


class SquareRootOrifice(AbstractPhysics):
    """A flow out of the junction with the square root of its effort."""

    word = "square_root_orifice"
    reference = "Torricelli 1643"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions; smooth within 0.1 % of the typical effort."""
        if not place.is_zero_junction:
            return
        k = place.parameter("orifice", place.unit(F), low=0.0)
        at = place.parameter("orifice_effort", place.unit(E), exact=place.effort)
        coefficient, typical = symbols(k, at)
        law = coefficient * _smooth_root(signals.e / typical)
        name = place.name_of("square_root_orifice")
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(Resistance(name, law=law), k, at),
            law=law,
            words=f"{place.a(F)} lost with the root of {place.domain.effort}",
            depends_on=("effort",),
            starts=({k.name: 0.0}, {k.name: 0.3 * place.flow}),
        )


class SquareLaw(AbstractPhysics):
    """A linear resistance that is a square law: effort grows with the flow squared.

    The outlet of a tank, a turbulent pipe, a fan: the linear law is replaced, since the
    two do not act side by side.
    """

    word = "square_root_orifice"
    reference = "Torricelli 1643; turbulent pressure loss"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every fitted linear R of a hydraulic or analogue junction."""
        graph = place.graph
        if place.domain not in (HYDRAULIC, ANALOGUE):
            return
        for bond in graph.bonds_at(place.name):
            node = graph.node(bond.other(place.name))
            linear = isinstance(node, Resistance) and node.law is None
            if linear and not graph.parameters[node.name].exact:
                yield self._replaced(place, node.name)

    def _replaced(self, place: Place, resistance: str) -> Hypothesis:
        """Write the law in the variable that the junction gives."""
        linear = place.graph.parameters[resistance].value or 1.0
        if place.is_one_junction:
            k = place.parameter(f"{resistance}_square", place.unit(E, F, 2), low=0.0)
            (coefficient,) = symbols(k)
            law = coefficient * signals.f * sympy.Abs(signals.f)
            start = linear / place.flow
            parameters: tuple[Parameter, ...] = (k,)
        else:
            k = place.parameter(f"{resistance}_flow", place.unit(F), low=0.0)
            at = place.parameter(
                f"{resistance}_effort", place.unit(E), exact=place.effort
            )
            coefficient, typical = symbols(k, at)
            law = coefficient * _smooth_root(signals.e / typical)
            start = place.effort / linear
            parameters = (k, at)
        return Hypothesis(
            physics=self.word,
            place=place.name,
            element=resistance,
            edit=ReplaceRelation(resistance, law, parameters),
            law=law,
            words=(
                f"{resistance} passes {place.a(F)} that grows with the root of "
                f"{place.domain.effort}, not in proportion to it"
            ),
            depends_on=("effort",),
            starts=({k.name: start},),
        )


def _smooth_root(x: sympy.Expr) -> sympy.Expr:
    """Return the signed square root of x, smooth within 0.1 % of its range."""
    return x / (x**2 + sympy.Float(1e-6)) ** sympy.Rational(1, 4)


class ConstantFlow(AbstractPhysics):
    """A constant flow into the junction."""

    word = "constant_bias"
    reference = "offset of a source; ambient gain"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions that have no fitted constant source."""
        if not place.is_zero_junction or place.has_free_bias:
            return
        b = place.parameter("bias", place.unit(F))
        (size,) = symbols(b)
        name = place.name_of("constant_bias")
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(FlowSource(name, value=size), b),
            law=size,
            words=f"a constant {place.domain.flow}",
            depends_on=(),
            starts=({b.name: 0.0},),
        )
