"""Columns and rows of the skeleton: where its nodes sit and which way its bonds take.

Each connected piece is drawn by itself (order around nodes, then shape, then smallest
grid), turned so that its spine runs to the right, and put below the one before.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from bondgraph.reporting.layout.compaction import compact, tighten
from bondgraph.reporting.layout.shape import square_off
from bondgraph.reporting.layout.skeleton import Piece, Skeleton, pieces
from bondgraph.reporting.layout.topology import PlainGraph, Topology, topology_of
from bondgraph.structure.graph import FinishedGraph

Cell = tuple[int, int]

TRIALS = 10
TALL = 1.6  # rows per column at which a drawing is laid on its side
FEW = 80  # nodes; larger pieces are drawn once


@dataclass(frozen=True, slots=True)
class Route:
    """The way of a bond over the grid, from its tail to its head.

    Attributes
    ----------
    cells
        Its ends and bends. An end beside its node, where the node has many bonds, is a
        place next to it in its row or column.
    lean
        Whether the tail, the head lies in such a place.
    """

    cells: tuple[Cell, ...]
    lean: tuple[bool, bool] = (False, False)


@dataclass(frozen=True, slots=True)
class Grid:
    """Cells (column, row from the top) by node, and routes by index of the bond."""

    cells: dict[str, Cell]
    routes: dict[int, Route]


def grid_of(graph: FinishedGraph, skeleton: Skeleton) -> Grid:
    """Return the grid of a graph's skeleton."""
    cells: dict[str, Cell] = {}
    routes: dict[int, Route] = {}
    top = 0
    for piece in pieces(graph, skeleton):
        own = _piece_grid(graph, piece, skeleton)
        used = [*own.cells.values(), *(c for r in own.routes.values() for c in r.cells)]
        left, upper = min(c for c, _ in used), min(r for _, r in used)

        def moved(cell: Cell, dx: int = -left, dy: int = top - upper) -> Cell:
            return cell[0] + dx, cell[1] + dy

        cells.update({name: moved(cell) for name, cell in own.cells.items()})
        routes.update(
            {
                k: Route(tuple(moved(cell) for cell in route.cells), route.lean)
                for k, route in own.routes.items()
            }
        )
        top += max(r for _, r in used) - upper + 1
    return Grid(cells, routes)


def _piece_grid(graph: FinishedGraph, piece: Piece, skeleton: Skeleton) -> Grid:
    """Return the grid of one connected piece."""
    if len(piece.names) == 1:
        return Grid({piece.names[0]: (0, 0)}, {})
    number = {name: k for k, name in enumerate(piece.names)}
    edges: list[tuple[int, int]] = []
    part_of: list[int] = []
    size = len(piece.names)
    seen: set[frozenset[int]] = set()
    for k in piece.bonds:
        bond = graph.bonds[k]
        ends = number[bond.tail], number[bond.head]
        if frozenset(ends) in seen:  # beside another bond: through a point of its own
            edges += [(ends[0], size), (size, ends[1])]
            part_of += [k, k]
            size += 1
        else:
            edges.append(ends)
            part_of.append(k)
            seen.add(frozenset(ends))
    load = [len(skeleton.hung[name]) for name in piece.names]
    plain = PlainGraph(
        size=size,
        edges=edges,
        spine=[number[name] for name in piece.spine],
        load=load + [0] * (size - len(load)),
    )
    topology, places = _best(plain)
    places = _turned(places, plain.spine)
    if topology.ambiguous:
        places = _flat(places)
    cells = {name: places[k] for k, name in enumerate(piece.names)}
    routes = {}
    for k, lines in _ways(topology, part_of).items():
        bond = graph.bonds[k]
        nodes = number[bond.tail], number[bond.head]
        routes[k] = _route(topology, lines, nodes, places)
    return Grid(cells, routes)


def _best(plain: PlainGraph) -> tuple[Topology, list[Cell]]:
    """Return the drawing with the shortest bonds of a few that differ in chance."""
    best: tuple[float, Topology, list[int], list[Cell]] | None = None
    for seed in range(TRIALS):
        topology = topology_of(plain, seed)
        direction = square_off(topology.graph, topology.outer, topology.wishes)
        places = compact(topology.graph, direction, topology.outer)
        length = _length(topology, places)
        if best is None or length < best[0]:
            best = length, topology, direction, places
        if not topology.ambiguous or plain.size > FEW:
            break
    assert best is not None
    _, topology, direction, places = best
    return topology, tighten(topology.graph, direction, places)


def _length(topology: Topology, places: Sequence[Cell]) -> float:
    """Return the length of all bonds, a bend counted as a length of its own."""
    graph = topology.graph
    total = float(len(graph.around))
    for dart in range(0, len(graph.origin), 2):
        (x1, y1), (x2, y2) = places[graph.origin[dart]], places[graph.head(dart)]
        total += abs(x2 - x1) + abs(y2 - y1)
    return total


def _ways(
    topology: Topology, part_of: Sequence[int]
) -> dict[int, list[tuple[int, int]]]:
    """Return, by bond, the edges of the map that it is drawn with."""
    ways: dict[int, list[tuple[int, int]]] = {}
    graph = topology.graph
    for edge, part in enumerate(graph.bond):
        if part is not None:
            ends = graph.origin[2 * edge], graph.head(2 * edge)
            ways.setdefault(part_of[part], []).append(ends)
    return ways


def _turned(places: Sequence[Cell], spine: Sequence[int]) -> list[Cell]:
    """Return columns and rows, rows downwards, so that the spine runs to the right."""
    (x1, y1), (x2, y2) = places[spine[0]], places[spine[-1]]
    dx, dy = x2 - x1, y2 - y1
    if abs(dy) > abs(dx):
        sign = 1 if dy > 0 else -1
        return [(sign * y, sign * x) for x, y in places]
    sign = 1 if dx >= 0 else -1
    return [(sign * x, -sign * y) for x, y in places]


def _flat(places: list[Cell]) -> list[Cell]:
    """Return a drawing that is much higher than wide, laid on its side."""
    columns, rows = (len(set(values)) for values in zip(*places, strict=True))
    return [(y, x) for x, y in places] if rows > TALL * columns else places


def _route(
    topology: Topology,
    lines: Sequence[tuple[int, int]],
    ends: tuple[int, int],
    places: Sequence[Cell],
) -> Route:
    """Return the way along `lines` between two nodes."""
    beside: dict[int, list[int]] = {}
    for a, b in lines:
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    own = [topology.belongs.get(node, node) for node in beside]
    start = next(n for n, o in zip(beside, own, strict=True) if o == ends[0])
    path = [start]
    previous = -1
    while topology.belongs.get(path[-1], path[-1]) != ends[1]:
        following = next(n for n in beside[path[-1]] if n != previous)
        previous = path[-1]
        path.append(following)
    cells = [places[node] for node in path]
    leans = (
        _leans(cells, places[ends[0]]),
        _leans(cells[::-1], places[ends[1]]),
    )
    if not leans[0]:
        cells[0] = places[ends[0]]
    if not leans[1]:
        cells[-1] = places[ends[1]]
    corners = [
        cell
        for before, cell, after in zip(cells, cells[1:], cells[2:], strict=False)
        if not (before[0] == cell[0] == after[0] or before[1] == cell[1] == after[1])
    ]
    return Route((cells[0], *corners, cells[-1]), leans)


def _leans(cells: Sequence[Cell], node: Cell) -> bool:
    """Return whether a bond ends beside its node and not in line with it."""
    end, following = cells[0], cells[1]
    if end == node:
        return False
    in_row, in_column = end[1] == node[1], end[0] == node[0]
    along = following[1] == end[1] if in_row else following[0] == end[0]
    return not (along and (in_row or in_column))
