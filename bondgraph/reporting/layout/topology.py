"""The order of the bonds around every node of the skeleton, and how they should run.

What lies on rings is drawn as a planar graph; trees then hang on it. A path should run
straight through its nodes, the deepest branch of a tree being its continuation; a long
side branch should turn and run beside the path it leaves, a short one stand upright on
it. A single ring should be a rectangle with its busiest nodes at the corners. A node
with more than four bonds becomes a row of nodes with up to four.
"""

import random
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from bondgraph.reporting.layout.planar import PlanarMap, planar_map
from bondgraph.reporting.layout.shape import Wishes
from bondgraph.reporting.layout.trees import (
    EAST,
    NORTH,
    SOUTH,
    WEST,
    Forest,
    hanging_trees,
)

BEND = 1.5
SPINE_BEND = 6.0
SPINE = 2.0  # cost of a quarter turn on the spine,
PATH = 0.5  # on any other path,
FORCED = 50.0  # and where it must not be


@dataclass(slots=True)
class Topology:
    """A map of a piece of the skeleton, with the wishes for its shape.

    Attributes
    ----------
    graph
        The map; its first nodes are those of the piece.
    wishes
        What its shape should be.
    outer
        A dart with the outside on its left; -1 for a single node.
    belongs
        For an added node of a row, the node that it is part of.
    ambiguous
        Whether rings share bonds, so that many shapes are equally good.
    """

    graph: PlanarMap
    wishes: Wishes = field(default_factory=Wishes)
    outer: int = -1
    belongs: dict[int, int] = field(default_factory=dict)
    ambiguous: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class PlainGraph:
    """A connected simple graph of nodes 0 … size - 1, as the layout sees it.

    Attributes
    ----------
    spine
        The path to draw as a straight row.
    load
        How many elements hang on each node.
    """

    size: int
    edges: Sequence[tuple[int, int]]
    spine: Sequence[int]
    load: Sequence[int]


def topology_of(plain: PlainGraph, seed: int = 0) -> Topology:
    """Return the order of the bonds of a graph, and the wishes for its shape.

    Parameters
    ----------
    plain
        The graph.
    seed
        Where many shapes are equally good, another seed may choose another one.
    """
    forest = hanging_trees(plain.size, plain.edges, plain.spine)
    ring = [k for k, edge in enumerate(plain.edges) if not _in_tree(forest, edge)]
    plain = replace(plain, spine=_longer_way(plain, ring))
    graph = planar_map(plain.size, [plain.edges[k] for k in ring])
    graph.bond = [None if k is None else ring[k] for k in graph.bond]
    topology = Topology(graph)
    if ring:
        topology.outer = _outside(graph, plain)
    _grow(topology, plain, forest)
    topology.outer = max(topology.outer, 0) if plain.edges else -1
    _wish_for_trees(topology, plain, forest)
    if ring:
        _wish_for_rings(topology, plain, frozenset(ring))
        _vary(topology, seed)
    topology.ambiguous = len(ring) > len({n for k in ring for n in plain.edges[k]})
    for node in range(plain.size):
        if len(graph.around[node]) > 4:
            ahead = [
                dart for dart in graph.around[node] if _ahead(topology, forest, dart)
            ]
            _make_row(topology, node, ahead)
    steps = {frozenset(step) for step in pairwise(plain.spine)}
    for edge, part in enumerate(graph.bond):
        on_spine = part is not None and frozenset(plain.edges[part]) in steps
        cost = SPINE_BEND if on_spine else BEND
        topology.wishes.bend.setdefault(edge, cost)
    return topology


def _in_tree(forest: Forest, edge: tuple[int, int]) -> bool:
    tail, head = edge
    return forest.parent.get(tail) == head or forest.parent.get(head) == tail


def _longer_way(plain: PlainGraph, ring: Sequence[int]) -> Sequence[int]:
    """Return the spine, led around a single ring on its longer side."""
    ends = [plain.edges[k] for k in ring]
    nodes = {node for edge in ends for node in edge}
    inside = [node for node in plain.spine if node in nodes]
    if len(nodes) != len(ring) or len(inside) < 2:
        return plain.spine
    beside: dict[int, list[int]] = {node: [] for node in nodes}
    for tail, head in ends:
        beside[tail].append(head)
        beside[head].append(tail)
    way = [inside[0], next(n for n in beside[inside[0]] if n != inside[1])]
    while way[-1] != inside[-1]:
        way.append(next(n for n in beside[way[-1]] if n != way[-2]))
    at = plain.spine.index(inside[0])
    if len(way) <= len(inside):
        return plain.spine
    return [*plain.spine[:at], *way, *plain.spine[at + len(inside) :]]


def _outside(graph: PlanarMap, plain: PlainGraph) -> int:
    """Return a dart of the face to put outside: the longest, with most on it."""

    def worth(face: Sequence[int]) -> tuple[int, int]:
        nodes = {graph.origin[dart] for dart in face}
        return len(face), sum(plain.load[n] for n in nodes if n < plain.size)

    return max(graph.faces(), key=worth)[0]


def _grow(topology: Topology, plain: PlainGraph, forest: Forest) -> None:
    """Put the trees into the map, each into the roomiest corner of its node."""
    graph = topology.graph
    edge_of = {frozenset(edge): k for k, edge in enumerate(plain.edges)}
    gap = _gaps(topology) if topology.outer >= 0 else {}
    for node in forest.order:
        darts = []
        for child, _ in forest.slots[node]:
            k = edge_of[frozenset((node, child))]
            along = graph.new_edge(*plain.edges[k], k)
            darts.append(along if graph.origin[along] == node else along ^ 1)
            graph.around[child] = [darts[-1] ^ 1]
        at = gap.get(node, len(graph.around[node]))
        graph.around[node][at:at] = darts


def _gaps(topology: Topology) -> dict[int, int]:
    """Return, for each node on a ring, where in its order a tree is put.

    Outside if the node is there, else in the largest face around it.
    """
    best: dict[int, tuple[int, int]] = {}
    for face in topology.graph.faces():
        size = len(face) + (len(topology.graph.origin) if topology.outer in face else 0)
        for dart in face:
            node = topology.graph.origin[dart]
            at = topology.graph.around[node].index(dart) + 1
            best[node] = max(best.get(node, (0, 0)), (size, at))
    return {node: at for node, (_, at) in best.items()}


def _wish_for_trees(topology: Topology, plain: PlainGraph, forest: Forest) -> None:
    graph = topology.graph
    inner = set(plain.spine[1:-1])
    for node in forest.order:
        darts = graph.around[node]
        if not 1 <= len(darts) <= 4 or (
            node not in forest.parent and len(darts) != len(forest.slots[node])
        ):
            continue
        where = [direction for _, direction in forest.slots[node]]
        if node in forest.parent:
            where = [WEST, *where]
        _wish(topology, darts, where, SPINE if node in inner else PATH)


def _wish(
    topology: Topology, darts: Sequence[int], where: Sequence[int], weight: float
) -> None:
    """Wish that the bonds of a node, counterclockwise, lie in these directions."""
    wishes = topology.wishes
    for k, dart in enumerate(darts):
        wishes.quarters[dart ^ 1] = (where[k] - where[k - 1] - 1) % 4 + 1
        wishes.weight[dart ^ 1] = weight


def _wish_for_rings(
    topology: Topology, plain: PlainGraph, ring: frozenset[int]
) -> None:
    """Wish for straight paths through rings, or corners where there is one ring."""
    graph = topology.graph
    nodes = {node for k in ring for node in plain.edges[k]}
    single = len(ring) == len(nodes)
    through = not nodes & {plain.spine[0], plain.spine[-1]}
    corners = _corners(graph, plain, topology.outer) if single and not through else {}
    spine = plain.spine
    triples = zip(spine, spine[1:], spine[2:], strict=False)
    beside = {node: (before, after) for before, node, after in triples}
    for node in sorted(nodes):
        darts = graph.around[node]
        on_ring = [dart for dart in darts if graph.bond[dart >> 1] in ring]
        if len(darts) > 4:
            continue
        if node in corners:
            _wish_corner(topology, node, corners[node])
        elif single and through and node in beside:
            pair = [dart for dart in darts if graph.head(dart) in beside[node]]
            _wish(topology, *_straight(darts, pair), SPINE)
        elif len(on_ring) == 2:
            _wish(topology, *_straight(darts, on_ring), PATH)


def _vary(topology: Topology, seed: int) -> None:
    """Make equally good shapes a little different in cost."""
    if not seed:
        return
    draw = random.Random(seed)  # noqa: S311  (not a secret: the same in every run)
    factors = [1 + 0.3 * draw.random() for _ in topology.graph.around]
    for dart, weight in topology.wishes.weight.items():
        topology.wishes.weight[dart] = weight * factors[topology.graph.head(dart)]


def _straight(darts: Sequence[int], pair: Sequence[int]) -> tuple[list[int], list[int]]:
    """Return the bonds from one of a pair on, and directions with the pair in line."""
    at = darts.index(pair[0])
    turned = [*darts[at:], *darts[:at]]
    if len(turned) == 4:
        return turned, [WEST, SOUTH, EAST, NORTH]
    opposite = turned.index(pair[1])
    return turned, [WEST, *[SOUTH] * (opposite - 1), EAST, NORTH][: len(turned)]


def _corners(graph: PlanarMap, plain: PlainGraph, outer: int) -> dict[int, int]:
    """Return the corners of a single ring by their node: the dart inside that turns.

    The corners are spaced to make a flat rectangle, the busiest nodes at corners.
    """
    (inner,) = (face for face in graph.faces() if outer ^ 1 in face)
    heads = [graph.head(dart) for dart in inner]
    count = len(heads)
    upright = max(1, round(count / 5))
    flat = count // 2 - upright
    steps = (0, flat, flat + upright, count - upright)
    if count < 4:
        return dict(zip(heads, inner, strict=True))

    def busy(start: int) -> int:
        return sum(plain.load[heads[(start + step) % count]] for step in steps)

    best = max(range(count), key=busy)
    places = [(best + step) % count for step in steps]
    return {heads[k]: inner[k] for k in places}


def _wish_corner(topology: Topology, node: int, dart: int) -> None:
    """Wish for a quarter turn on the inside of `dart`'s head, at the ring's corner."""
    darts = topology.graph.around[node]
    at = darts.index(dart ^ 1)
    turned = [*darts[at:], *darts[:at]]
    # The inside lies clockwise of the arriving bond: between it and the last one.
    where = [WEST, SOUTH, EAST, NORTH]
    if len(turned) < 4:
        where = [WEST, *[SOUTH, EAST][: len(turned) - 2], NORTH]
    _wish(topology, turned, where, 2 * PATH)


def _ahead(topology: Topology, forest: Forest, dart: int) -> bool:
    """Return whether a bond continues the path that comes to its node."""
    graph = topology.graph
    node, other = graph.origin[dart], graph.head(dart)
    return (other, EAST) in forest.slots[node]


def _make_row(topology: Topology, node: int, ahead: Sequence[int]) -> None:
    """Make a node with more than four bonds a row of nodes."""
    graph, wishes = topology.graph, topology.wishes
    darts = graph.around[node]
    # The row runs from the first bond to the one ahead, or to that half way round.
    opposite = darts.index(ahead[0]) if ahead else len(darts) // 2
    if opposite == 0:
        opposite = len(darts) // 2
    below, above = darts[1:opposite], darts[:opposite:-1]
    length = max(len(below), len(above))
    middle = (length - 1) // 2
    row = [node if k == middle else graph.add_node() for k in range(length)]
    topology.belongs.update({part: node for part in row if part != node})
    sides: list[list[int]] = [[] for _ in row]
    for bonds in (below, above):
        offset = (length - len(bonds)) // 2
        for k, dart in enumerate(bonds):
            sides[offset + k].append(dart)
            graph.origin[dart] = row[offset + k]
    graph.origin[darts[0]], graph.origin[darts[opposite]] = row[0], row[-1]
    links = [graph.new_edge(a, b, None) for a, b in pairwise(row)]
    wishes.bend.update({link >> 1: FORCED for link in links})
    west = [darts[0], *(link ^ 1 for link in links)]
    east = [*links, darts[opposite]]
    for k, part in enumerate(row):
        under = [dart for dart in sides[k] if dart in below]
        over = [dart for dart in sides[k] if dart in above]
        graph.around[part] = [west[k], *under, east[k], *over]
        where = [WEST, *[SOUTH] * len(under), EAST, *[NORTH] * len(over)]
        _wish(topology, graph.around[part], where, FORCED)
