"""Mirror images: places of a graph that may change over without changing the model.

Two branches with the same elements, of which no value is stated and no sensor reads
one, are the same model with left and right changed over. Whatever is found in one of
them could as well be in the other, with the other's values: no recording tells which.
That is a property of the graph alone, an automorphism of it that leaves inputs,
measurements and stated values as they are.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Any

import sympy

from bondgraph.structure.elements import Gyrator, Junction, Node, Transformer
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.nodes import (
    laws_of,
    modulations,
    parameters_of,
    port_count,
    written_laws,
)
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import parameters_in, signals_in

MOST = 500
"""So many images are looked at: of many equal branches any two change over."""


@dataclass(frozen=True, slots=True)
class Image:
    """One way to change places over that leaves the model as it is.

    Parameters
    ----------
    node
        The name that each node has in the image.
    parameter
        The number that stands where each stood.
    """

    node: Mapping[str, str]
    parameter: Mapping[str, str]

    def of(self, place: str) -> str:
        """Return what is where a node or bond was; any other place stays."""
        tail, arrow, head = place.partition(">")
        if arrow and tail in self.node and head in self.node:
            return Bond(self.node[tail], self.node[head]).name
        return self.node.get(place, place)


def mirror_images(graph: FinishedGraph) -> tuple[Image, ...]:
    """Return the ways to change places over, the one that leaves all there among them.

    Values that are only begun from (no standard deviation) may change over; stated ones
    have to be equal. What inputs, measurements and modulated elements name stays.
    """
    return tuple(
        Image(
            node,
            {
                old: new
                for name, other in node.items()
                for old, new in zip(
                    parameters_of(graph.node(name)),
                    parameters_of(graph.node(other)),
                    strict=True,
                )
            },
        )
        for node in _isomorphisms(graph)
    )


def _isomorphisms(graph: FinishedGraph) -> Iterator[dict[str, str]]:
    import networkx  # noqa: PLC0415  (0.2 s, needed where something was found only)

    net: Any = networkx.DiGraph()
    known, users = _known(graph), _users(graph)
    for node in graph.nodes:
        net.add_node(node.name, kind=_kind(graph, node, known, users))
    for bond, domain in zip(graph.bonds, graph.domains, strict=True):
        ports = (_port(graph, bond.tail, bond), _port(graph, bond.head, bond))
        net.add_edge(bond.tail, bond.head, kind=(domain.name, *ports))
    matcher = networkx.algorithms.isomorphism.DiGraphMatcher(
        net, net, _same_kind, _same_kind
    )
    return islice(matcher.isomorphisms_iter(), MOST)


def _same_kind(one: Mapping[str, object], other: Mapping[str, object]) -> bool:
    return one["kind"] == other["kind"]


def _known(graph: FinishedGraph) -> frozenset[str]:
    """Return the nodes that are no others': what is read, what reads, what comes in.

    And whose numbers a reading is made with.
    """
    read = {s.place for m in graph.measurements for s in signals_in(m.expression)}
    for place, reader in modulations(graph.nodes):
        read |= {place, reader}
    ends = {end for place in read for end in place.partition(">")[::2]}
    told = {name for m in graph.measurements for name in parameters_in(m.expression)}
    special = {
        node.name
        for node in graph.nodes
        if isinstance(node, MultiPort)
        or (port_count(node) == 1 and not laws_of(node))
        or told & set(parameters_of(node))
    }
    return frozenset(ends | special)


def _users(graph: FinishedGraph) -> Counter[str]:
    """Return how many nodes use each number."""
    return Counter(name for node in graph.nodes for name in set(parameters_of(node)))


def _kind(
    graph: FinishedGraph, node: Node, known: frozenset[str], users: Counter[str]
) -> object:
    """Return what has to be equal of two nodes that may change over."""
    bonds = len(graph.bonds_at(node.name))
    if node.name in known:
        return node.name, bonds
    if isinstance(node, Junction):
        return type(node), bonds
    own = dict.fromkeys(parameters_of(node))
    numbers = {name: sympy.Symbol(f"_{k}") for k, name in enumerate(own)}
    laws = tuple(
        law.subs({s: numbers[s.name] for s in law.free_symbols if s.name in numbers})
        for law in laws_of(node)
    )
    shared = tuple(name for name in own if users[name] > 1)
    stated = tuple(_stated(graph.parameters.get(name)) for name in own)
    return type(node), bonds, bool(written_laws(node)), laws, shared, stated


def _stated(parameter: Parameter | None) -> object:
    """Return what is known of a number before any fit."""
    if parameter is None:
        return None
    value = None if parameter.std is None else (parameter.value, parameter.std)
    return parameter.unit, parameter.bounds, value


def _port(graph: FinishedGraph, name: str, bond: Bond) -> int:
    """Return which port of an element with two a bond is at, 0 elsewhere."""
    if isinstance(graph.node(name), Transformer | Gyrator):
        return 1 + graph.bonds_at(name).index(bond)
    return 0
