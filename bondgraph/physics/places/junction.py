"""A junction as a place: where an element may hang that the model does not have."""

import math
from dataclasses import dataclass

import sympy

from bondgraph.physics.places.base import Coefficient, E, F, P, Place, Q
from bondgraph.physics.places.displacements import known_displacement
from bondgraph.physics.places.scales import Scales
from bondgraph.structure.domains import EnergyDomain, Quantity
from bondgraph.structure.edits import InsertElement, SignalState
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Inertance,
    Node,
    OneJunction,
    OnePort,
    Resistance,
    ZeroJunction,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.nodes import is_linear
from bondgraph.structure.signals import (
    displacement,
    flow,
    parameters_in,
    signals_in,
)


@dataclass(frozen=True, slots=True)
class JunctionPlace(Place):
    """A 1- or 0-junction; the kind is the type."""

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain there."""
        return self.graph.domain_at(self.name)

    @property
    def neighbours(self) -> tuple[Node, ...]:
        """The nodes that a bond joins to this place."""
        bonds = self.graph.bonds_at(self.name)
        return tuple(self.graph.node(bond.other(self.name)) for bond in bonds)

    @property
    def displacement_signal(self) -> sympy.Expr | None:
        """The displacement here, where its origin is known; None elsewhere."""
        return None

    @property
    def displacement_known(self) -> bool:
        """Whether there is a displacement here that is no other's in proportion.

        What a spring or a stop does to a motion it does to all that goes rigidly with
        it, so that these are looked for at one of them.
        """
        return False

    @property
    def has_free_bias(self) -> bool:
        """Whether a constant source with a fitted value sits here."""
        for node in self.neighbours:
            if isinstance(node, EffortSource | FlowSource) and node.value is not None:
                names = parameters_in(node.value)
                constant = names and not signals_in(node.value)
                if constant and any(not self.graph.parameters[n].exact for n in names):
                    return True
        return False

    def has_free_linear(self, kind: type) -> bool:
        """Return whether a linear element of `kind` with a fitted value sits here."""
        return any(
            isinstance(node, kind)
            and getattr(node, "law", None) is None
            and self.graph.parameters[node.name].std is None
            for node in self.neighbours
        )

    @property
    def flow(self) -> float:
        """Typical flow."""
        return self.scales.at(Quantity.FLOW, self.name)

    @property
    def is_steady(self) -> bool:
        """Whether a table of operating points tells how slow it has been here."""
        return math.isfinite(self.least_flow)

    @property
    def least_flow(self) -> float:
        """The least flow other than none in a steady table; infinite without one."""
        name = flow(self.name).name
        return self.scales.least.get(name, math.inf)

    @property
    def effort(self) -> float:
        """Typical effort of the bonds there."""
        return self.scales.at(Quantity.EFFORT, self.name)

    @property
    def momentum(self) -> float:
        """Typical momentum: of the linear inertias here, or of an effort for a while.

        That is amid the times that a recording shows, as all of them are evenly.
        """
        inertia = sum(
            self.scales.fitted.get(node.name)
            or self.graph.parameters[node.name].value
            or 0.0
            for node in self.neighbours
            if isinstance(node, Inertance) and is_linear(node)
        )
        pushed = self.effort * math.sqrt(self.scales.step * self.scales.stretch)
        return self.scales.at(P, self.name, abs(inertia) * self.flow or pushed)

    @property
    def displacement(self) -> float:
        """Typical displacement; where not known, that of a C here, or of a swing."""
        default = 0.1 * self.flow * self.scales.stretch
        for node in self.neighbours:
            if isinstance(node, Compliance):
                default = self.scales.at(Q, node.name, default)
                if is_linear(node):
                    compliance = self.graph.parameters[node.name].value or 1.0
                    default = compliance * self.effort
        return self.scales.at(Q, self.name, default)

    @property
    def displacement_range(self) -> tuple[float, float]:
        """Least and largest displacement, here or of a C."""
        size = self.displacement
        names = (self.name, *(n.name for n in self.neighbours))
        for name in names:
            if f"{Q}({name})" in self.scales.ranges:
                return self.scales.range_of(f"{Q}({name})", size)
        return self.scales.range_of(f"{Q}({self.name})", size)

    def insert(
        self,
        element: OnePort,
        *coefficients: Coefficient,
        states: tuple[SignalState, ...] = (),
    ) -> InsertElement:
        """Return the edit that hangs `element` here, with the states its law reads."""
        parameters = tuple(c.parameter for c in coefficients)
        return InsertElement(self.name, element, parameters, states)


@dataclass(frozen=True, slots=True)
class OneJunctionPlace(JunctionPlace):
    """A 1-junction: what hangs there shares its flow and adds an effort."""

    @property
    def displacement_signal(self) -> sympy.Expr | None:
        """The displacement here: measured, that of a C, or made of such."""
        parts = known_displacement(self.graph, self.name)
        if parts is None:
            return None
        return sympy.Add(*(k * displacement(name) for name, k in parts.items()))

    @property
    def displacement_known(self) -> bool:
        """Whether there is a displacement here that is no other's in proportion."""
        parts = known_displacement(self.graph, self.name)
        return parts is not None and (len(parts) > 1 or self.name in parts)

    @property
    def gives(self) -> bool:
        """Whether its motion is how far a spring between two motions is stretched.

        There are springs, and what follows that motion, and else only what it lies
        between.
        """
        springs = any(isinstance(node, Compliance) for node in self.neighbours)
        ties = [node for node in self.neighbours if not self._follows(node)]
        return springs and bool(ties) and all(isinstance(n, ZeroJunction) for n in ties)

    def _follows(self, node: Node) -> bool:
        """Return whether a node gives an effort by the motion here alone."""
        if isinstance(node, EffortSource) and node.value is not None:
            read = signals_in(node.value)
            return bool(read) and all(signal.place == self.name for signal in read)
        return isinstance(node, Compliance | Resistance)

    @property
    def reverses(self) -> bool:
        """Whether its motion goes both ways, as far as is known."""
        return self.scales.reverses(f"{F}({self.name})")


@dataclass(frozen=True, slots=True)
class ZeroJunctionPlace(JunctionPlace):
    """A 0-junction: what hangs there shares its effort and takes a flow."""

    @property
    def effort_range(self) -> tuple[float, float]:
        """The least and the largest effort here; about ± 1.5 sizes where unknown."""
        return self.scales.range_of(f"{E}({self.name})", self.effort)


def junction_place(graph: FinishedGraph, name: str, scales: Scales) -> JunctionPlace:
    """Return the junction called `name` as a place of its kind."""
    one = isinstance(graph.node(name), OneJunction)
    return (OneJunctionPlace if one else ZeroJunctionPlace)(graph, name, scales)
