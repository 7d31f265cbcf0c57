"""An element as a place: where the element's own law may be another one."""

from dataclasses import dataclass

import sympy

from bondgraph.physics.places.base import Coefficient, E, F, Place, Q
from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.edits import ReplaceRelation, SignalState
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    Gyrator,
    Inertance,
    OneJunction,
    Resistance,
    Transformer,
    ZeroJunction,
)
from bondgraph.structure.nodes import WithLaw, is_linear
from bondgraph.structure.signals import e, f, p, parameter_symbol, q


@dataclass(frozen=True, slots=True)
class ElementPlace(Place):
    """An I, C, R, TF or GY."""

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain of its (first) port."""
        return self.graph.domain_at(self.name)

    @property
    def element(self) -> WithLaw:
        """The element."""
        node = self.graph.node(self.name)
        assert isinstance(node, WithLaw)
        return node

    @property
    def usual_law(self) -> sympy.Expr:
        """The law: as written, or of a linear I in p, a C in q, an R in f."""
        element = self.element
        if isinstance(element, Transformer | Gyrator):
            return element.modulus
        if element.law is not None:
            return element.law
        constant = parameter_symbol(self.name)
        match element:
            case Inertance():
                return p / constant
            case Compliance():
                return q / constant
        return constant * f

    @property
    def flow_law(self) -> sympy.Expr | None:
        """The flow of an R as a law of e; None where its effort follows a flow."""
        (junction, *others) = self.junctions
        if others or not isinstance(self.element, Resistance):
            return None
        ends = self.graph.bonds_at(junction)
        near = (self.graph.node(bond.other(junction)) for bond in ends)
        sets = ZeroJunction | EffortSource
        given = all(isinstance(node, sets) for node in near if node.name != self.name)
        if not self.is_one_junction(junction) or not given:
            return None
        law = self.element.law
        if law is None:
            return e / parameter_symbol(self.name)
        return law if e in law.free_symbols and f not in law.free_symbols else None

    @property
    def linear_value(self) -> float | None:
        """The value of a linear element's parameter, None where it has a law."""
        if not is_linear(self.element):
            return None
        return self.graph.parameters[self.name].value

    @property
    def junctions(self) -> tuple[str, ...]:
        """The junctions (or two-ports) at the other ends of its bonds."""
        bonds = self.graph.bonds_at(self.name)
        return tuple(bond.other(self.name) for bond in bonds)

    @property
    def dampers_beside(self) -> tuple[str, ...]:
        """Linear resistances that share its flow, where nothing else does.

        Together they are one part: a shaft that gives way, a rubber, a contact.
        """
        (junction, *others) = self.junctions
        if others or not isinstance(self.graph.node(junction), OneJunction):
            return ()
        ends = (b.other(junction) for b in self.graph.bonds_at(junction))
        beside = [self.graph.node(name) for name in ends if name != self.name]
        losses = [node for node in beside if isinstance(node, Resistance)]
        dampers = [node.name for node in losses if node.law is None]
        ties = [node for node in beside if isinstance(node, ZeroJunction)]
        alone = len(ties) == 1 and len(beside) == 1 + len(dampers)
        return tuple(dampers) if alone else ()

    @property
    def flow(self) -> float:
        """Typical flow of the (first) bond."""
        default = self.scales.at(F, self.junctions[0])
        return self.scales.at(F, self.graph.bonds_at(self.name)[0].name, default)

    @property
    def effort(self) -> float:
        """Typical effort of the (first) bond."""
        default = self.scales.at(E, self.junctions[0])
        return self.scales.at(E, self.graph.bonds_at(self.name)[0].name, default)

    @property
    def content(self) -> float:
        """Typical momentum of a linear I, displacement of a linear C."""
        value = self.linear_value
        if isinstance(self.element, Inertance):
            return (value or 1.0) * self.flow
        if isinstance(self.element, Compliance) and value:
            return value * self.effort
        default = 0.1 * self.flow * self.scales.stretch
        return self.scales.at(Q, self.name, default)

    def replace(
        self,
        law: sympy.Expr,
        *coefficients: Coefficient,
        states: tuple[SignalState, ...] = (),
        nested: bool = True,
    ) -> ReplaceRelation:
        """Return the edit that gives the element another law."""
        parameters = tuple(c.parameter for c in coefficients)
        return ReplaceRelation(self.name, law, parameters, states, nested)
