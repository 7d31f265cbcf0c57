"""A bond as a place: where what the model takes for rigid may give way."""

from dataclasses import dataclass

from bondgraph.physics.places.base import Coefficient, E, F, Place, Q
from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.edits import LoosenBond
from bondgraph.structure.elements import (
    FlowSource,
    Inertance,
    Junction,
    OneJunction,
    OnePort,
    Resistance,
    Transformer,
)
from bondgraph.structure.graph import Bond, FinishedGraph


@dataclass(frozen=True, slots=True)
class BondPlace(Place):
    """A bond that may be split; it is called like the nearest thing with a name.

    That is the element at one of its ends, or else the junction it leaves.
    """

    bond: Bond

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain there."""
        return self.graph.domain_at(self.bond.name)

    @property
    def also(self) -> tuple[str, ...]:
        """The node at the other end, and what lies beyond a two-port."""
        ends = (self.bond.tail, self.bond.head)
        near = [
            bond.other(self.name)
            for bond in self.graph.bonds_at(self.name)
            if not isinstance(self.graph.node(self.name), Junction)
        ]
        return tuple(dict.fromkeys(n for n in (*ends, *near) if n != self.name))

    @property
    def both_sides_resist(self) -> bool:
        """Whether inertia, loss or an imposed flow sets the flow of either side.

        Where neither does, and what ties the sides lets go, nothing tells the flow.
        """
        return all(
            _resists(self.graph, end, self.bond)
            for end in (self.bond.tail, self.bond.head)
        )

    @property
    def _junction(self) -> str:
        """The junction at an end: its flow is that of the bond."""
        head = isinstance(self.graph.node(self.bond.head), Junction)
        return self.bond.head if head else self.bond.tail

    @property
    def flow(self) -> float:
        """Typical flow."""
        return self.scales.at(F, self._junction)

    @property
    def effort(self) -> float:
        """Typical effort that it carries."""
        default = self.scales.at(E, self._junction)
        return self.scales.at(E, self.bond.name, default)

    @property
    def displacement(self) -> float:
        """Typical displacement; where not known, that of a swing."""
        default = 0.1 * self.flow * self.scales.stretch
        return self.scales.at(Q, self._junction, default)

    def loosen(
        self, name: str, elements: tuple[OnePort, ...], *coefficients: Coefficient
    ) -> LoosenBond:
        """Return the edit that puts elements across the difference of flows."""
        parameters = tuple(c.parameter for c in coefficients)
        return LoosenBond(self.bond, name, elements, parameters)


def _resists(graph: FinishedGraph, name: str, coming: Bond) -> bool:
    """Return whether something beyond `coming`, at `name` or rigidly tied, resists."""
    node = graph.node(name)
    if isinstance(node, Inertance | Resistance | FlowSource):
        return True
    if not isinstance(node, OneJunction | Transformer):
        return False
    return any(
        _resists(graph, bond.other(name), bond)
        for bond in graph.bonds_at(name)
        if bond != coming
    )
