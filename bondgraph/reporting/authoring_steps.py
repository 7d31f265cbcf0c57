"""The calls an author would make to write a graph, read off the finished graph.

`BondGraph` appends nodes and bonds call by call, so the order of a finished graph
tells the calls: a junction with the one-ports that follow it, a one-port put on later
(as an edit does), a join through a two-port, a plain bond.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

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


@dataclass(frozen=True, slots=True)
class AddNode:
    """``add(node)``: a node without bonds."""

    node: Node


@dataclass(frozen=True, slots=True)
class DrawBond:
    """``bond(tail, head)``."""

    bond: Bond


AuthoringStep = AddJunction | PutElement | JoinJunctions | AddNode | DrawBond


class _UnusualError(Exception):
    """The bonds have a direction or an order that put and join do not make."""


def authoring_steps(graph: FinishedGraph) -> tuple[AuthoringStep, ...]:
    """Return the calls that write `graph`, in its own order.

    A graph that was put together bond by bond (a half arrow out of an I, a bond between
    two elements) is written so too.
    """
    try:
        return tuple(_steps(graph))
    except _UnusualError:
        nodes = (AddNode(node) for node in graph.nodes)
        return (*nodes, *map(DrawBond, graph.bonds))


def _steps(graph: FinishedGraph) -> Iterator[AuthoringStep]:
    nodes, bonds = deque(graph.nodes), deque(graph.bonds)
    known: set[str] = set()
    while nodes or bonds:
        if bonds and {bonds[0].tail, bonds[0].head} <= known:
            plain = bonds.popleft()
            yield JoinJunctions(plain.tail, None, plain.head)
            continue
        if not nodes:
            raise _UnusualError
        node = nodes.popleft()
        match node:
            case ZeroJunction() | OneJunction():
                known.add(node.name)
                yield AddJunction(node, tuple(_hung(node.name, nodes, bonds)))
            case Transformer() | Gyrator():
                yield _join(node, bonds, known)
            case _:
                assert isinstance(node, OnePort | MultiPort)
                junctions = _junctions_of(node, bonds)
                if not known.issuperset(junctions):
                    raise _UnusualError
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


def _join(two_port: TwoPort, bonds: deque[Bond], known: set[str]) -> JoinJunctions:
    if len(bonds) >= 2:
        first, second = bonds.popleft(), bonds.popleft()
        through = first.head == second.tail == two_port.name
        if through and {first.tail, second.head} <= known:
            return JoinJunctions(first.tail, two_port, second.head)
    raise _UnusualError
