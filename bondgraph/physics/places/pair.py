"""Two junctions as a place: where something between them may be missing."""

from dataclasses import dataclass

import sympy

from bondgraph.physics.places.base import Coefficient, E, F, P, Place, Q
from bondgraph.physics.places.displacements import known_displacement
from bondgraph.structure.domains import EnergyDomain, Quantity
from bondgraph.structure.edits import ConnectJunctions, CoupleJunctions
from bondgraph.structure.elements import OnePort, TwoPort
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import displacement


@dataclass(frozen=True, slots=True)
class PairPlace(Place):
    """Two junctions of one kind and one domain; the kind of pair is the type."""

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
        return self._larger(E)

    @property
    def flow(self) -> float:
        """Typical flow, of the larger."""
        return self._larger(F)

    def _larger(self, quantity: Quantity, default: float = 1.0) -> float:
        ends = (self.name, self.second)
        return max(self.scales.at(quantity, end, default) for end in ends)

    def connect(
        self, element: OnePort, *coefficients: Coefficient, summed: bool = False
    ) -> ConnectJunctions:
        """Return the edit that puts an element between them."""
        own, name = _parameters(coefficients), f"{element.name}_path"
        return ConnectJunctions(self.name, self.second, name, (element,), own, summed)


class StockPair(PairPlace):
    """Two 0-junctions that no resistance joins: the first stores.

    The second stores as well, or a source holds its effort: a room, a supply.
    """

    __slots__ = ()


class MotionPair(PairPlace):
    """Two 1-junctions with inertia that hang on a third one, and not on each other."""

    __slots__ = ()

    @property
    def way(self) -> sympy.Expr | None:
        """The displacement of the first less that of the second, where both are known.

        A storage of its own would have an origin of its own in every window.
        """
        both = [known_displacement(self.graph, end) for end in (self.name, self.second)]
        signs = zip((1, -1), both, strict=True)
        if None in both:
            return None
        return sympy.Add(
            *(
                sign * own * displacement(name)
                for sign, parts in signs
                for name, own in (parts or {}).items()
            )
        )

    @property
    def displacement(self) -> float:
        """Typical displacement, of the larger."""
        return self._larger(Q, 0.1 * self.flow * self.scales.stretch)

    @property
    def momentum(self) -> float:
        """Typical momentum, of an effort for a while."""
        pushed = self.effort * (self.scales.step * self.scales.stretch) ** 0.5
        return self._larger(P, pushed)

    def couple(self, element: TwoPort, *coefficients: Coefficient) -> CoupleJunctions:
        """Return the edit that joins them by a two-port."""
        own = _parameters(coefficients)
        return CoupleJunctions(self.name, self.second, element, own)


class ApartPair(MotionPair):
    """Two 1-junctions with inertia, in parts of the machine that no bond joins."""

    __slots__ = ()


def _parameters(coefficients: tuple[Coefficient, ...]) -> tuple[Parameter, ...]:
    return tuple(one.parameter for one in coefficients)
