"""Two junctions as a place: where a path between them may be missing."""

from dataclasses import dataclass

from bondgraph.physics.places.base import Coefficient, E, F, Place
from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.edits import ConnectJunctions
from bondgraph.structure.elements import OnePort


@dataclass(frozen=True, slots=True)
class PairPlace(Place):
    """Two 0-junctions of one domain that store and that no resistance joins."""

    second: str

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain of both."""
        return self.graph.domain_at(self.name)

    @property
    def also(self) -> tuple[str, ...]:
        """The second junction."""
        return (self.second,)

    @property
    def effort(self) -> float:
        """Typical effort, of the larger."""
        return max(self.scales.at(E, self.name), self.scales.at(E, self.second))

    @property
    def flow(self) -> float:
        """Typical flow, of the larger."""
        return max(self.scales.at(F, self.name), self.scales.at(F, self.second))

    def connect(self, element: OnePort, *coefficients: Coefficient) -> ConnectJunctions:
        """Return the edit that puts an element between them."""
        parameters = tuple(c.parameter for c in coefficients)
        name = f"{element.name}_path"
        return ConnectJunctions(self.name, self.second, name, (element,), parameters)
