"""A bond as a place: where what the model takes for rigid may give way."""

from dataclasses import dataclass

from bondgraph.physics.places.base import Place
from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.elements import Junction
from bondgraph.structure.graph import Bond


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
