"""Which motions the model does not let act on each other.

Those of two axes, or loops, that nothing joins; and those of two bodies that hang on
the same third one, and on each other not at all: two wheels on one frame.
"""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import combinations

import networkx as nx

from bondgraph.physics.places.base import MOTION
from bondgraph.structure.domains import ELECTRICAL
from bondgraph.structure.elements import Inertance, OneJunction, Transformer
from bondgraph.structure.graph import FinishedGraph

MOVING = MOTION | {ELECTRICAL}
"""Domains in which two inertias may act on each other past all bonds."""

PAIRS = 2
"""More pairs than so many for each motion are too many to look into."""


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
    crossing = _crossing(graph)
    part = _groups(graph, crossing)
    for one, other in combinations(_bodies(graph, junctions).values(), 2):
        alike = graph.domain_at(one) == graph.domain_at(other)
        if alike and part[one] != part[other]:
            yield one, other


def motions_beside(
    graph: FinishedGraph, junctions: Collection[str]
) -> tuple[tuple[str, str], ...]:
    """Return pairs of 1-junctions with inertia that the same third one is joined to.

    And that nothing joins directly. None of more than two pairs a motion: of twenty
    rollers around one drum no two are likelier than others.

    Parameters
    ----------
    junctions
        Those of the machine.
    """
    bodies = _bodies(graph, junctions)
    group = _rigid_groups(graph)
    moving = {name: group[name] for name in group if group[name] in bodies}
    between = _groups(graph, (*moving, *_crossing(graph)))
    ends: dict[int, set[int]] = defaultdict(set)
    for bond in graph.bonds:
        for here, there in ((bond.tail, bond.head), (bond.head, bond.tail)):
            if here in moving and there in between:
                ends[between[there]].add(moving[here])
    joined: nx.Graph[int] = nx.Graph()
    for touched in ends.values():
        joined.add_edges_from(combinations(touched, 2))
    beside = [
        (bodies[one], bodies[other])
        for one, other in combinations([b for b in bodies if b in joined], 2)
        if not joined.has_edge(one, other)
        and set(joined[one]) & set(joined[other])
        and graph.domain_at(bodies[one]) in MOTION
    ]
    return tuple(beside) if len(beside) <= PAIRS * len(bodies) else ()


def _bodies(graph: FinishedGraph, junctions: Collection[str]) -> Mapping[int, str]:
    """Return the 1-junction that stands for each rigid group that has an inertia."""
    group = _rigid_groups(graph)
    stands: dict[int, str] = {}
    for name in junctions:
        if _has_inertia(graph, name) and graph.domain_at(name) in MOVING:
            stands[group[name]] = name
    return stands


def _rigid_groups(graph: FinishedGraph) -> Mapping[str, int]:
    """Return the number of the group of motions that gears tie to each other."""
    rigid = (OneJunction, Transformer)
    giving = (n.name for n in graph.nodes if not isinstance(n, rigid))
    return _groups(graph, (*giving, *_crossing(graph)))


def _crossing(graph: FinishedGraph) -> list[str]:
    """Return the nodes at which one domain ends and another begins."""
    return [n.name for n in graph.nodes if _crosses(graph, n.name)]


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
