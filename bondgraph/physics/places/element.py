"""An element as a place: where the element's own law may be another one."""

from dataclasses import dataclass

from bondgraph.physics.places.base import Place
from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.nodes import WithLaw


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
