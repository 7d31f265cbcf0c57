"""A finished graph taken apart and put together again, checked, with other pieces."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.draft import in_si
from bondgraph.structure.edits.signal_states import SignalState
from bondgraph.structure.elements import EffortSource, FlowSource, Node, OnePort
from bondgraph.structure.graph import (
    Bond,
    CausalPreference,
    FinishedGraph,
    Measurement,
    used_parameters,
)
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.renaming import Renaming


def usual_bond(element: OnePort, junction: str) -> Bond:
    """Return the bond that hangs an element on a junction; power leaves a source."""
    if isinstance(element, EffortSource | FlowSource):
        return Bond(element.name, junction)
    return Bond(junction, element.name)


@dataclass(slots=True)
class Pieces:
    """The nodes, bonds and measurements of a graph while an edit moves them about."""

    graph: FinishedGraph
    nodes: list[Node]
    bonds: list[tuple[Bond, EnergyDomain]]
    measurements: list[Measurement]
    preferences: list[CausalPreference]

    @classmethod
    def of(cls, graph: FinishedGraph) -> "Pieces":
        """Return the pieces of `graph`."""
        bonds = list(zip(graph.bonds, graph.domains, strict=True))
        return cls(
            graph,
            list(graph.nodes),
            bonds,
            list(graph.measurements),
            list(graph.preferences),
        )

    def hang(self, element: OnePort, junction: str, domain: EnergyDomain) -> None:
        """Add an element on a junction."""
        self.nodes.append(element)
        self.bonds.append((usual_bond(element, junction), domain))

    def swap(self, old: str, new: Node) -> None:
        """Put `new` where the node called `old` was; its bonds follow."""
        self.nodes = [new if node.name == old else node for node in self.nodes]
        moved = Renaming({old: new.name})
        self.bonds = [(moved.bond(bond), domain) for bond, domain in self.bonds]

    def to_the_end(self, name: str) -> None:
        """Move a node with its bonds behind all others.

        An element stands after its junctions: so a graph reads as its author's calls.
        """
        self.nodes.sort(key=lambda node: node.name == name)
        self.bonds.sort(key=lambda pair: name in (pair[0].tail, pair[0].head))

    def remember(self, states: Iterable[SignalState]) -> None:
        """Add the pieces of states of signals."""
        for state in states:
            junction, *elements = state.nodes
            self.nodes.append(junction)
            for element in elements:
                self.hang(element, junction.name, state.domain)

    def read_elsewhere(self, places: Mapping[str, str]) -> None:
        """Let laws and measurements that read a place read another one.

        Only what they read changes: nodes keep their names.
        """
        moved = Renaming(places)
        self.nodes = [_reading(node, moved) for node in self.nodes]
        self.measurements = [
            Measurement(m.name, moved.expression(m.expression), m.unit)
            for m in self.measurements
        ]

    def finished(self, added: Iterable[Parameter]) -> FinishedGraph:
        """Return the checked graph; parameters that nothing uses any more are gone."""
        parameters = self.graph.parameters.merged(map(in_si, added))
        return replace(
            self.graph,
            nodes=tuple(self.nodes),
            bonds=tuple(bond for bond, _ in self.bonds),
            domains=tuple(domain for _, domain in self.bonds),
            measurements=tuple(self.measurements),
            preferences=tuple(self.preferences),
            parameters=parameters.restricted(
                used_parameters(self.nodes, self.measurements)
            ),
        )


def _reading(node: Node, moved: Renaming) -> Node:
    """Return the node with its laws reading the moved places, under its own name."""
    own = {name: new for name, new in moved.places.items() if name != node.name}
    return Renaming(own).node(node)
