"""Edits of bonds: what was rigid gives way, and what was apart is joined.

A bond is split by a 0-junction, across which the flows may differ (a compliant shaft,
backlash), or by a 1-junction, across which the efforts may differ (a resistance in
series). Elements of either sit on a new 1-junction and see the difference.
"""

from dataclasses import dataclass

from bondgraph.errors import StructureError
from bondgraph.structure.edits.rebuilding import Pieces
from bondgraph.structure.edits.signal_states import SignalState
from bondgraph.structure.elements import (
    Junction,
    OneJunction,
    OnePort,
    Resistance,
    TwoPort,
    ZeroJunction,
    letter,
)
from bondgraph.structure.graph import Bond, CausalPreference, FinishedGraph, Wanted
from bondgraph.structure.parameters import Parameter


@dataclass(frozen=True, slots=True)
class LoosenBond:
    """Let the flows at both ends of a bond differ.

    A 0-junction splits the bond; `elements` sit on the 1-junction `name` beside it,
    whose flow is the difference, tail less head. An R among them is wished to give its
    effort: its law may vanish, and cannot be solved for the flow then.
    """

    bond: Bond
    name: str
    elements: tuple[OnePort, ...]
    parameters: tuple[Parameter, ...] = ()
    states: tuple[SignalState, ...] = ()

    @property
    def split(self) -> str:
        """The name of the 0-junction that splits the bond."""
        return f"{self.name}_split"

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the bond split."""
        split = self.split
        pieces = _split(graph, self.bond, ZeroJunction(split))
        domain = graph.domain_at(self.bond.name)
        pieces.nodes.append(OneJunction(self.name))
        for element in self.elements:
            pieces.hang(element, self.name, domain)
            if isinstance(element, Resistance):
                wish = CausalPreference(element.name, Wanted.GIVES_EFFORT)
                pieces.preferences.append(wish)
        pieces.bonds.append((Bond(split, self.name), domain))
        pieces.remember(self.states)
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        return (
            f"{_kinds(self.elements)} put between {self.bond.tail} and {self.bond.head}"
        )

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.elements[0].name

    @property
    def nested(self) -> bool:
        """Whether the first values of its parameters (nearly) give the graph before."""
        return True


@dataclass(frozen=True, slots=True)
class ObstructBond:
    """Let the efforts at both ends of a bond differ.

    A 1-junction `name` splits the bond, and `elements` on it take the difference.
    """

    bond: Bond
    name: str
    elements: tuple[OnePort, ...]
    parameters: tuple[Parameter, ...] = ()
    states: tuple[SignalState, ...] = ()

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the bond split."""
        pieces = _split(graph, self.bond, OneJunction(self.name))
        for element in self.elements:
            pieces.hang(element, self.name, graph.domain_at(self.bond.name))
        pieces.remember(self.states)
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        return (
            f"{_kinds(self.elements)} in series between {self.bond.tail} and "
            f"{self.bond.head}"
        )

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.elements[0].name

    @property
    def nested(self) -> bool:
        """Whether the first values of its parameters (nearly) give the graph before."""
        return True


@dataclass(frozen=True, slots=True)
class ConnectJunctions:
    """Join two junctions of one kind through elements.

    Between 0-junctions the elements see the difference of efforts and carry the flow
    from `first` to `second`; between 1-junctions they see the difference of flows, or
    their sum where `summed`.
    """

    first: str
    second: str
    name: str
    elements: tuple[OnePort, ...]
    parameters: tuple[Parameter, ...] = ()
    summed: bool = False

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the path between the junctions."""
        zeros = _of_one_kind(graph, self.first, self.second)
        domain = graph.domain_at(self.first)
        pieces = Pieces.of(graph)
        between = self.name
        if not zeros:
            between = f"{self.name}_split"
            pieces.nodes.append(ZeroJunction(between))
        pieces.nodes.append(OneJunction(self.name))
        for element in self.elements:
            pieces.hang(element, self.name, domain)
        pieces.bonds.append((Bond(self.first, between), domain))
        ends = (between, self.second)
        pieces.bonds.append((Bond(*(ends[::-1] if self.summed else ends)), domain))
        if between != self.name:
            pieces.bonds.append((Bond(between, self.name), domain))
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        of = " of their sum" if self.summed else ""
        kinds = _kinds(self.elements)
        return f"{self.first} and {self.second} joined through {kinds}{of}"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.elements[0].name

    @property
    def nested(self) -> bool:
        """Whether the first values of its parameters give the graph before."""
        return True


@dataclass(frozen=True, slots=True)
class CoupleJunctions:
    """Join two junctions of one kind by a two-port, from `first` to `second`."""

    first: str
    second: str
    element: TwoPort
    parameters: tuple[Parameter, ...] = ()

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the two-port between the junctions."""
        _of_one_kind(graph, self.first, self.second)
        pieces, own = Pieces.of(graph), self.element.name
        pieces.nodes.append(self.element)
        for bond in (Bond(self.first, own), Bond(own, self.second)):
            pieces.bonds.append((bond, graph.domain_at(self.first)))
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        kind = letter(self.element)
        return f"{self.first} and {self.second} joined by one {kind}"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.element.name

    @property
    def nested(self) -> bool:
        """Whether the first values of its parameters give the graph before."""
        return True


def _of_one_kind(graph: FinishedGraph, first: str, second: str) -> bool:
    """Return whether both are 0-junctions; raise where they are not of one kind."""
    ends = [graph.node(first), graph.node(second)]
    zeros = {isinstance(end, ZeroJunction) for end in ends}
    if not all(isinstance(end, Junction) for end in ends) or len(zeros) > 1:
        raise StructureError(
            f"{first!r} and {second!r} are not junctions of one kind.",
            (first, second),
            "Connect two 0-junctions or two 1-junctions.",
        )
    return zeros == {True}


def _split(graph: FinishedGraph, bond: Bond, junction: Junction) -> Pieces:
    """Return the pieces with `junction` in the bond.

    A law that read the bond reads the half at its element, or else at its tail.
    """
    if bond not in graph.bonds:
        raise StructureError(
            f"There is no bond {bond.name!r}.", (bond.name,), "Split one that exists."
        )
    domain = graph.domain_at(bond.name)
    first, second = Bond(bond.tail, junction.name), Bond(junction.name, bond.head)
    at_head = not isinstance(graph.node(bond.head), Junction)
    pieces = Pieces.of(graph)
    pieces.read_elsewhere({bond.name: (second if at_head else first).name})
    at = pieces.bonds.index((bond, domain))
    pieces.bonds[at : at + 1] = [(first, domain), (second, domain)]
    pieces.nodes.append(junction)
    for end, half in ((bond.tail, second), (bond.head, first)):
        if not isinstance(graph.node(end), Junction):
            pieces.to_the_end(end)
            at = pieces.bonds.index((half, domain))
            pieces.bonds.append(pieces.bonds.pop(at))
            break
    else:
        pieces.to_the_end(junction.name)
    return pieces


def _kinds(elements: tuple[OnePort, ...]) -> str:
    """Return ``one C and one R``."""
    return " and ".join(f"one {letter(element)}" for element in elements)
