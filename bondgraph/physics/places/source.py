"""A source inside of a loop as a place: what it gives need not be what it is asked."""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy

from bondgraph.physics.places.base import PROPOSED, Coefficient, E, F, Place
from bondgraph.structure.domains import EnergyDomain, Quantity
from bondgraph.structure.edits import ReplaceRelation
from bondgraph.structure.elements import EffortSource, Source
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import parameters_in, signals_in


@dataclass(frozen=True, slots=True)
class SourcePlace(Place):
    """A source steered by an input and by what the machine does: a loop's actuator."""

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain of its bond."""
        return self.graph.domain_at(self.name)

    @property
    def quantity(self) -> Quantity:
        """What it imposes: effort or flow."""
        return E if isinstance(self.graph.node(self.name), EffortSource) else F

    @property
    def value(self) -> sympy.Expr:
        """What the model asks of it."""
        node = self.graph.node(self.name)
        assert isinstance(node, Source)
        assert node.value is not None
        return node.value

    @property
    def peak(self) -> float:
        """The largest size of what it was asked for."""
        (bond,) = self.graph.bonds_at(self.name)
        usual = self.scales.at(self.quantity, bond.other(self.name))
        return max(
            map(abs, self.scales.range_of(f"{self.quantity}({bond.name})", usual))
        )

    def replace(self, value: sympy.Expr, *coefficients: Coefficient) -> ReplaceRelation:
        """Return the edit that lets it give something else."""
        parameters = tuple(c.parameter for c in coefficients)
        return ReplaceRelation(self.name, value, parameters)


def steered_sources(graph: FinishedGraph) -> Iterator[str]:
    """Yield the sources that an input and the machine steer together.

    What an input alone steers has the limits of that input, and what a finding has put
    there is no source of the author's.
    """
    commanding = {
        near
        for source in graph.inputs
        for near in (
            source.name,
            *(b.other(source.name) for b in graph.bonds_at(source.name)),
        )
    }
    for node in graph.elements:
        if not isinstance(node, Source) or node.value is None:
            continue
        numbers = (graph.parameters[name] for name in parameters_in(node.value))
        authored = all(number.source != PROPOSED for number in numbers)
        commanded = [s.place in commanding for s in signals_in(node.value)]
        if authored and any(commanded) and not all(commanded):
            yield node.name
