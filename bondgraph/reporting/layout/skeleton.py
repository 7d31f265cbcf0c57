"""What carries a bond graph on paper, and what hangs on it.

Junctions, two-ports and fields are the skeleton; an element with one bond hangs on its
neighbour. In each connected piece the longest path is the spine, which is drawn as a
straight row with the source at its left end.
"""

from collections import defaultdict, deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from bondgraph.structure.elements import EffortSource, FlowSource, Junction, Node
from bondgraph.structure.graph import Bond, FinishedGraph

MOST_BONDS = 4  # of a node whose elements still fit between its other bonds,
MOST_HUNG = 8  # and the most elements that do


@dataclass(frozen=True, slots=True)
class Skeleton:
    """The nodes that are placed first, and their bonds.

    Attributes
    ----------
    names
        The nodes of the skeleton, in the author's order.
    bonds
        Indices of the graph's bonds between two of them.
    hung
        By node of the skeleton, the elements that hang on it.
    driven
        The nodes of the skeleton with a source on them.
    """

    names: tuple[str, ...]
    bonds: tuple[int, ...]
    hung: Mapping[str, tuple[str, ...]]
    driven: frozenset[str]


def skeleton_of(graph: FinishedGraph) -> Skeleton:
    """Return the skeleton of a graph."""
    partners = _partners(graph.bonds)
    nodes = graph.by_name
    host = {
        node.name: partners[node.name][0]
        for node in graph.nodes
        if _hangs(node, nodes, partners)
    }
    crowded = set()
    for name in nodes:
        hanging = sum(n in host for n in partners[name])
        bonds = len(partners[name]) - hanging
        if name not in host and (bonds > MOST_BONDS or hanging > MOST_HUNG):
            crowded.add(name)
    host = {name: on for name, on in host.items() if on not in crowded}
    hung: dict[str, list[str]] = {n.name: [] for n in graph.nodes if n.name not in host}
    for node in graph.nodes:
        if node.name in host:
            hung[host[node.name]].append(node.name)
    sources = {n.name for n in graph.nodes if isinstance(n, EffortSource | FlowSource)}
    return Skeleton(
        tuple(hung),
        tuple(
            k for k, b in enumerate(graph.bonds) if b.tail in hung and b.head in hung
        ),
        {name: tuple(elements) for name, elements in hung.items()},
        frozenset(n for n in hung if n in sources or sources.intersection(hung[n])),
    )


def _partners(bonds: Sequence[Bond]) -> Mapping[str, list[str]]:
    partners: defaultdict[str, list[str]] = defaultdict(list)
    for bond in bonds:
        partners[bond.tail].append(bond.head)
        partners[bond.head].append(bond.tail)
    return partners


def _hangs(
    node: Node, nodes: Mapping[str, Node], partners: Mapping[str, Sequence[str]]
) -> bool:
    """Return whether a node hangs on its neighbour.

    Of two one-ports bonded to each other, the first by name carries the second.
    """
    if isinstance(node, Junction) or len(partners[node.name]) != 1:
        return False
    (partner,) = partners[node.name]
    alone = not isinstance(nodes[partner], Junction) and len(partners[partner]) == 1
    return not alone or node.name > partner


@dataclass(frozen=True, slots=True)
class Piece:
    """A connected piece of the skeleton.

    Attributes
    ----------
    names, bonds
        Its nodes and bonds.
    spine
        Its longest path, the source at the start.
    """

    names: tuple[str, ...]
    bonds: tuple[int, ...]
    spine: tuple[str, ...]


def pieces(graph: FinishedGraph, skeleton: Skeleton) -> list[Piece]:
    """Return the connected pieces of the skeleton, in the author's order."""
    bonds = [graph.bonds[k] for k in skeleton.bonds]
    neighbours = _partners(bonds)
    forward = {(b.tail, b.head) for b in bonds}
    found: list[Piece] = []
    piece_of: dict[str, int] = {}
    for seed in skeleton.names:
        if seed in piece_of:
            continue
        reached, _ = _reach(seed, neighbours)
        piece_of.update(dict.fromkeys(reached, len(found)))
        names = tuple(n for n in skeleton.names if n in reached)
        spine = _spine(seed, neighbours, skeleton.driven, forward)
        found.append(Piece(names, (), spine))
    own: list[list[int]] = [[] for _ in found]
    for k, bond in zip(skeleton.bonds, bonds, strict=True):
        own[piece_of[bond.tail]].append(k)
    return [
        Piece(p.names, tuple(bonds), p.spine)
        for p, bonds in zip(found, own, strict=True)
    ]


def _reach(
    start: str, neighbours: Mapping[str, Sequence[str]]
) -> tuple[dict[str, int], dict[str, str]]:
    """Return distances and predecessors from `start`, breadth first."""
    distance, parent = {start: 0}, {}
    queue = deque([start])
    while queue:
        name = queue.popleft()
        for other in neighbours.get(name, ()):
            if other not in distance:
                distance[other] = distance[name] + 1
                parent[other] = name
                queue.append(other)
    return distance, parent


def _spine(
    seed: str,
    neighbours: Mapping[str, Sequence[str]],
    driven: frozenset[str],
    forward: set[tuple[str, str]],
) -> tuple[str, ...]:
    """Return the longest shortest path, from its better left end."""

    def farthest(distance: Mapping[str, int]) -> str:
        # Of equally far ends one with nothing beyond it.
        return max(distance, key=lambda n: (distance[n], -len(neighbours.get(n, ()))))

    distance, _ = _reach(seed, neighbours)
    distance, parent = _reach(farthest(distance), neighbours)
    path = [farthest(distance)]
    while path[-1] in parent:
        path.append(parent[path[-1]])

    def as_start(path: Iterable[str]) -> tuple[bool, int]:
        # A source counts most, then how many bonds carry power rightwards.
        rightwards = sum(step in forward for step in pairwise(path))
        return next(iter(path)) in driven, rightwards

    return tuple(max(path[::-1], path, key=as_start))
