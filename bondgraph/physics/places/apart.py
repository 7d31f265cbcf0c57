"""Which motions nothing joins: those of two axes, of two loops, on one frame."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import combinations

import networkx as nx

from bondgraph.structure.domains import ELECTRICAL, ROTATION, TRANSLATION
from bondgraph.structure.elements import Inertance, OneJunction, Transformer
from bondgraph.structure.graph import FinishedGraph

MOVING = frozenset({TRANSLATION, ROTATION, ELECTRICAL})
"""Domains in which two inertias may act on each other past all bonds."""


def motions_apart(
    graph: FinishedGraph, junctions: Collection[str]
) -> Iterator[tuple[str, str]]:
    """Yield pairs of 1-junctions with inertia that no bonds of their domain join.

    Two motors on one supply are apart, two ends of a shaft are not. Of motions that
    gears tie to each other the last one stands for all.

    Parameters
    ----------
    junctions
        Those of the machine.
    """
    crossing = [n.name for n in graph.nodes if _crosses(graph, n.name)]
    part = _groups(graph, crossing)
    rigid = (OneJunction, Transformer)
    giving = (n.name for n in graph.nodes if not isinstance(n, rigid))
    body = _groups(graph, (*giving, *crossing))
    stands: dict[int, str] = {}
    for name in junctions:
        if _has_inertia(graph, name) and graph.domain_at(name) in MOVING:
            stands[body[name]] = name
    for one, other in combinations(stands.values(), 2):
        alike = graph.domain_at(one) == graph.domain_at(other)
        if alike and part[one] != part[other]:
            yield one, other


def _groups(graph: FinishedGraph, without: Iterable[str]) -> Mapping[str, int]:
    """Return the number of the group that every other node is in."""
    joined: nx.Graph[str] = nx.Graph()
    joined.add_edges_from((bond.tail, bond.head) for bond in graph.bonds)
    joined.remove_nodes_from(without)
    found = enumerate(nx.connected_components(joined))
    return {name: number for number, names in found for name in names}


def _crosses(graph: FinishedGraph, name: str) -> bool:
    """Return whether a node has bonds of two domains."""
    return len({graph.domain_at(bond.name) for bond in graph.bonds_at(name)}) > 1


def _has_inertia(graph: FinishedGraph, name: str) -> bool:
    ends = (graph.node(bond.other(name)) for bond in graph.bonds_at(name))
    is_motion = isinstance(graph.node(name), OneJunction)
    return is_motion and any(isinstance(end, Inertance) for end in ends)


def moving_apart_from(graph: FinishedGraph, junction: str) -> tuple[str, ...]:
    """Return the motions of one domain with a 1-junction's that nothing joins to it."""
    ones = [n.name for n in graph.junctions if isinstance(n, OneJunction)]
    pairs = (pair for pair in motions_apart(graph, ones) if junction in pair)
    return tuple(b if a == junction else a for a, b in pairs)


def inputs_apart_from(graph: FinishedGraph, junction: str) -> tuple[str, ...]:
    """Return the inputs that drive another machine: one that no bond joins to this."""
    machine = _groups(graph, ())
    own = machine[junction]
    return tuple(s.name for s in graph.inputs if machine[s.name] != own)
