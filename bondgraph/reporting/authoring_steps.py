"""The calls an author would make to write a graph, read off the finished graph.

`BondGraph` appends nodes and bonds call by call, so the order of a finished graph
tells the calls: a junction with the one-ports that follow it, a one-port put on later
(as an edit does), a join through a two-port, a plain bond.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from bondgraph.errors import StructureError
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Gyrator,
    Junction,
    Node,
    OneJunction,
    OnePort,
    Transformer,
    TwoPort,
    ZeroJunction,
    is_one_port,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.nodes import port_count


@dataclass(frozen=True, slots=True)
class AddJunction:
    """``one(name, *elements)`` or ``zero(name, *elements)``."""

    junction: Junction
    elements: tuple[OnePort, ...]


@dataclass(frozen=True, slots=True)
class PutElement:
    """``put(element, on=junction)``, or on several junctions for a field."""

    element: OnePort | MultiPort
    junctions: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class JoinJunctions:
    """``join(tail, two_port, head)``, or ``join(tail, head)`` without a two-port."""

    tail: str
    two_port: TwoPort | None
    head: str


AuthoringStep = AddJunction | PutElement | JoinJunctions


def authoring_steps(graph: FinishedGraph) -> tuple[AuthoringStep, ...]:
    """Return the calls that write `graph`, in its own order.

    Raises
    ------
    StructureError
        If no calls would, because the graph was put together by hand: a half arrow
        out of an I, or an order of bonds that no calls give.
    """
    return tuple(_steps(graph))


def _steps(graph: FinishedGraph) -> Iterator[AuthoringStep]:
    nodes, bonds = deque(graph.nodes), deque(graph.bonds)
    known: set[str] = set()
    while nodes or bonds:
        if bonds and {bonds[0].tail, bonds[0].head} <= known:
            plain = bonds.popleft()
            yield JoinJunctions(plain.tail, None, plain.head)
            continue
        if not nodes:
            raise _unwritable(graph, bonds[0].name)
        node = nodes.popleft()
        match node:
            case ZeroJunction() | OneJunction():
                known.add(node.name)
                yield AddJunction(node, tuple(_hung(node.name, nodes, bonds)))
            case Transformer() | Gyrator():
                yield _join(graph, node, bonds, known)
            case _:
                assert isinstance(node, OnePort | MultiPort)
                junctions = _junctions_of(node, bonds)
                if not known.issuperset(junctions):
                    raise _unwritable(graph, node.name)
                yield PutElement(node, junctions)


def _usual_bond(element: Node, junction: str) -> Bond:
    """Return the bond ``put`` makes: power out of a source, into an I, C or R."""
    if isinstance(element, EffortSource | FlowSource):
        return Bond(element.name, junction)
    return Bond(junction, element.name)


def _hung(junction: str, nodes: deque[Node], bonds: deque[Bond]) -> Iterator[OnePort]:
    """Take the one-ports that were written together with their junction."""
    while nodes and bonds:
        node = nodes[0]
        if not is_one_port(node) or bonds[0] != _usual_bond(node, junction):
            return
        nodes.popleft()
        bonds.popleft()
        yield node


def _junctions_of(element: OnePort | MultiPort, bonds: deque[Bond]) -> tuple[str, ...]:
    """Take the bonds of a one-port or field; return its junctions, none if unusual."""
    junctions = []
    for _ in range(min(port_count(element) or 0, len(bonds))):
        bond = bonds.popleft()
        junction = bond.other(element.name)
        junctions.append(junction if bond == _usual_bond(element, junction) else "")
    return tuple(junctions) or ("",)


def _join(
    graph: FinishedGraph, two_port: TwoPort, bonds: deque[Bond], known: set[str]
) -> JoinJunctions:
    if len(bonds) >= 2:
        first, second = bonds.popleft(), bonds.popleft()
        through = first.head == second.tail == two_port.name
        if through and {first.tail, second.head} <= known:
            return JoinJunctions(first.tail, two_port, second.head)
    raise _unwritable(graph, two_port.name)


def _unwritable(graph: FinishedGraph, name: str) -> StructureError:
    return StructureError(
        f"{graph.name!r} cannot be written as calls of BondGraph: the bonds at "
        f"{name!r} have a direction or an order that no call makes.",
        (name,),
        "Write it with BondGraph: power out of sources, into I, C and R, and through "
        "a TF or GY.",
    )
