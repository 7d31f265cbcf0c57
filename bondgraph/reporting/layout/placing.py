"""From the grid to paper: how wide columns are, how high rows, and every line.

A row has three levels: what hangs above its nodes, the nodes with what is beside them,
and what hangs below. Within a level neighbours may not touch; rows are as far apart as
what hangs between them needs. Columns and rows are then as tight as that allows.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from bondgraph.reporting.layout.boxes import (
    Box,
    LabelSize,
    Layout,
    Point,
    Side,
    around,
)
from bondgraph.reporting.layout.clearing import clear_sensors
from bondgraph.reporting.layout.fans import (
    CLEARANCE,
    PASSING,
    SLOT_GAP,
    UPRIGHT,
    Fan,
    Hanging,
    fan_of,
)
from bondgraph.reporting.layout.grid import Cell, Grid, Route, grid_of
from bondgraph.reporting.layout.skeleton import Skeleton, skeleton_of
from bondgraph.structure.elements import EffortSource, FlowSource
from bondgraph.structure.graph import FinishedGraph

BOND = 46.0  # shortest visible bond along a row
ROW_GAP = 18.0  # between what hangs below one row and above the next
SLANT = 34.0  # from a crowded node to where its bonds straighten
MARGIN = 26.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Sizes:
    """How much room everything needs.

    Attributes
    ----------
    labels
        By node and sensor, the size of its label.
    bonds
        By bond, in the order of the graph's, the length that its own label needs.
    beside
        The width of what is written beside an upright bond.
    """

    labels: Mapping[str, LabelSize]
    bonds: Sequence[float]
    beside: float = 0.0


def lay_out(
    graph: FinishedGraph, sizes: Sizes, sensors: Mapping[str, str] | None = None
) -> Layout:
    """Return the place of everything.

    Parameters
    ----------
    graph
        Any finished graph: a chain, a tree, with rings, or in several pieces.
    sizes
        The room that labels need, in pixels.
    sensors
        Names of sensors with the node or element that each is put on.
    """
    skeleton = skeleton_of(graph)
    grid = grid_of(graph, skeleton)
    fans = _fans(graph, skeleton, grid, sizes, sensors or {})
    paper = _Paper(skeleton, grid, fans, sizes)
    boxes: dict[str, Box] = {}
    sides: dict[str, Side] = {}
    for name in skeleton.names:
        x, y = paper.at(grid.cells[name])
        boxes[name] = Box(x, y, *sizes.labels[name].stacked)
        sides[name] = Side.CENTRE
        boxes.update({n: b.moved(x, y) for n, b in fans[name].boxes.items()})
        sides.update(fans[name].sides)
    paths = []
    for k, bond in enumerate(graph.bonds):
        if k in grid.routes:
            ends = boxes[bond.tail], boxes[bond.head]
            paths.append(paper.line(grid.routes[k], ends))
            continue
        host = bond.tail if bond.tail in fans else bond.head
        outwards = fans[host].paths[bond.other(host)]
        x, y = boxes[host].x, boxes[host].y
        line = tuple((a + x, b + y) for a, b in outwards)
        paths.append(line if host == bond.tail else line[::-1])
    clear_sensors(boxes, sides, paths, sensors or {})
    return _on_sheet(boxes, sides, paths)


def _fans(
    graph: FinishedGraph,
    skeleton: Skeleton,
    grid: Grid,
    sizes: Sizes,
    sensors: Mapping[str, str],
) -> dict[str, Fan]:
    """Return the fan of every node of the skeleton."""
    on: defaultdict[str, list[str]] = defaultdict(list)
    for sensor, place in sensors.items():
        on[place].append(sensor)
    sources = frozenset(
        n.name for n in graph.nodes if isinstance(n, EffortSource | FlowSource)
    )
    room = {}
    for bond, length in zip(graph.bonds, sizes.bonds, strict=True):
        room[bond.tail] = room[bond.head] = length
    taken = _taken(graph, grid)
    outward = _outward(grid)
    return {
        name: fan_of(
            sizes.labels[name].stacked,
            frozenset(taken[name]),
            Hanging(
                elements=[*skeleton.hung[name], *on[name]],
                sources=sources,
                sensors=on,
                sizes=sizes.labels,
                room=lambda element: room.get(element, 0.0),
                outward=outward[name],
                beside=sizes.beside,
            ),
        )
        for name in skeleton.names
    }


def _taken(graph: FinishedGraph, grid: Grid) -> Mapping[str, set[Side]]:
    """Return the sides of every node on which bonds of the skeleton leave."""
    taken: defaultdict[str, set[Side]] = defaultdict(set)
    for k, route in grid.routes.items():
        bond = graph.bonds[k]
        taken[bond.tail].add(_side(route.cells[0], route.cells[1]))
        taken[bond.head].add(_side(route.cells[-1], route.cells[-2]))
    return taken


def _outward(grid: Grid) -> Mapping[str, frozenset[Side]]:
    """Return the sides of every node on which it is the last of the whole grid."""
    columns, rows = zip(*grid.cells.values(), strict=True)
    edges = (
        (Side.LEFT, 0, min(columns), max(columns)),
        (Side.RIGHT, 0, max(columns), min(columns)),
        (Side.ABOVE, 1, min(rows), max(rows)),
        (Side.BELOW, 1, max(rows), min(rows)),
    )
    return {
        name: frozenset(
            side
            for side, axis, edge, other in edges
            if cell[axis] == edge and edge != other
        )
        for name, cell in grid.cells.items()
    }


def _side(here: Cell, there: Cell) -> Side:
    if here[0] == there[0]:
        return Side.BELOW if there[1] > here[1] else Side.ABOVE
    return Side.RIGHT if there[0] > here[0] else Side.LEFT


@dataclass(slots=True)
class _Level:
    """What lies on one level of one row: its column, and its reach to both sides."""

    items: list[tuple[int, float, float]] = field(default_factory=list)


class _Paper:
    """The x of every column and the y of every row."""

    def __init__(
        self,
        skeleton: Skeleton,
        grid: Grid,
        fans: Mapping[str, Fan],
        sizes: Sizes,
    ) -> None:
        self._levels: defaultdict[tuple[int, int], _Level] = defaultdict(_Level)
        self._bonded: dict[tuple[int, int], float] = {}
        self._boxes = {
            grid.cells[name]: sizes.labels[name].stacked for name in skeleton.names
        }
        for name in skeleton.names:
            column, row = grid.cells[name]
            fan = fans[name]
            reaches = (fan.above, fan.middle, fan.below)
            for level, reach in enumerate(reaches):
                if reach is not None:
                    self._put(row, level, column, *reach)
        upright = self._note_routes(grid, sizes)
        columns = 1 + max(c for c, _ in self._cells(grid))
        rows = 1 + max(r for _, r in self._cells(grid))
        self._x = self._columns(columns)
        self._y = self._rows(rows, fans, grid, upright)

    def at(self, cell: Cell) -> Point:
        """Return the centre of a cell."""
        return self._x[cell[0]], self._y[cell[1]]

    @staticmethod
    def _cells(grid: Grid) -> Iterable[Cell]:
        yield from grid.cells.values()
        for route in grid.routes.values():
            yield from route.cells

    def _put(
        self, row: int, level: int, column: int, left: float, right: float
    ) -> None:
        self._levels[row, level].items.append((column, left, right))

    def _note_routes(self, grid: Grid, sizes: Sizes) -> dict[int, float]:
        """Note what bonds take up; return what upright ones need above each row."""
        upright: dict[int, float] = {}
        for k, route in grid.routes.items():
            for cell in route.cells[1:-1]:
                self._put(cell[1], 1, cell[0], 0.0, 0.0)
            for cell, following in _beside(route):
                reach = PASSING
                if cell[1] == following[1]:  # leaves a crowded node sideways
                    reach = self._half_width(cell[0]) + SLANT + PASSING
                self._put(cell[1], 1, cell[0], reach, reach)
            for one, other in pairwise(route.cells):
                if one[1] == other[1]:
                    self._note_along(one, other, sizes.bonds[k])
                else:
                    self._note_upright(one, other, sizes.bonds[k], upright)
        return upright

    def _half_width(self, column: int) -> float:
        """Return half the width of the widest node in a column."""
        return max(w for (c, _), (w, _) in self._boxes.items() if c == column) / 2

    def _note_along(self, one: Cell, other: Cell, room: float) -> None:
        first, last = sorted((one[0], other[0]))
        for column in range(first, last):
            key = (one[1], column)
            gap = max(BOND, room) / (last - first)
            self._bonded[key] = max(self._bonded.get(key, 0.0), gap)

    def _note_upright(
        self, one: Cell, other: Cell, room: float, upright: dict[int, float]
    ) -> None:
        first, last = sorted((one[1], other[1]))
        for row in range(first, last + 1):
            if row > first:
                gap = max(UPRIGHT, room / (last - first))
                upright[row] = max(upright.get(row, 0.0), gap)
            # It passes what is above the last row and below the first.
            for level, passes in enumerate(
                (row > first, first < row < last, row < last)
            ):
                if passes:
                    self._put(row, level, one[0], PASSING, PASSING)

    def _columns(self, count: int) -> list[float]:
        """Return the x of every column, as tight as neighbours allow."""
        before: defaultdict[int, list[tuple[int, float]]] = defaultdict(list)
        for (row, level), what in self._levels.items():
            reach: dict[int, tuple[float, float]] = {}
            for column, left, right in what.items:
                old = reach.get(column, (0.0, 0.0))
                reach[column] = max(left, old[0]), max(right, old[1])
            for one, other in pairwise(sorted(reach)):
                room = reach[one][1] + reach[other][0] + SLOT_GAP
                if level == 1 and (row, one) in self._bonded:
                    lengths = (self._bonded.get((row, c), 0) for c in range(one, other))
                    room = max(room, self._between((row, one, other), sum(lengths)))
                before[other].append((one, room))
        x = [0.0] * count
        for column in range(count):
            x[column] = max((x[one] + room for one, room in before[column]), default=0)
        return x

    def _between(self, span: tuple[int, int, int], bond: float) -> float:
        row, one, other = span
        widths = (self._boxes.get((c, row), (0.0, 0.0))[0] for c in (one, other))
        return sum(widths) / 2 + bond + 2 * CLEARANCE

    def _rows(
        self,
        count: int,
        fans: Mapping[str, Fan],
        grid: Grid,
        upright: Mapping[int, float],
    ) -> list[float]:
        up, down = [0.0] * count, [0.0] * count
        high = [0.0] * count
        for name, fan in fans.items():
            row = grid.cells[name][1]
            up[row], down[row] = max(up[row], fan.up), max(down[row], fan.down)
            high[row] = max(high[row], self._boxes[grid.cells[name]][1] / 2)
        for route in grid.routes.values():
            for (_, row), _ in _beside(route):
                up[row] = max(up[row], high[row] + SLANT + PASSING)
                down[row] = max(down[row], high[row] + SLANT + PASSING)
        y = [up[0]] * count
        for row in range(1, count):
            apart = down[row - 1] + up[row] + ROW_GAP
            bonded = high[row - 1] + high[row] + upright.get(row, 0.0) + 2 * CLEARANCE
            y[row] = y[row - 1] + max(apart, bonded)
        return y

    def line(self, route: Route, ends: tuple[Box, Box]) -> tuple[Point, ...]:
        """Return the line of a bond between two boxes."""
        points = [self.at(cell) for cell in route.cells]
        tail = _end(points, ends[0], leans=route.lean[0])
        head = _end(points[::-1], ends[1], leans=route.lean[1])
        return (*tail, *points[1:-1], *head[::-1])


def _beside(route: Route) -> list[tuple[Cell, Cell]]:
    """Return the ends of a route that lie beside their node, and what follows."""
    ends = (route.cells[:2], route.cells[:-3:-1])
    return [(a, b) for lean, (a, b) in zip(route.lean, ends, strict=True) if lean]


def _end(points: Sequence[Point], box: Box, *, leans: bool) -> tuple[Point, ...]:
    """Return where a line leaves a box, and where it straightens if it leans."""
    (x, y), (to_x, to_y) = points[0], points[1]
    upright = abs(to_x - x) < abs(to_y - y)
    if upright:
        sign = 1 if to_y > y else -1
        border = sign * (box.height / 2 + CLEARANCE)
        if not leans:
            return ((x, box.y + border),)
        reach = max(-box.width / 2 + 7, min(box.width / 2 - 7, 0.4 * (x - box.x)))
        return (box.x + reach, box.y + border), (x, box.y + border + sign * SLANT)
    sign = 1 if to_x > x else -1
    border = sign * (box.width / 2 + CLEARANCE)
    if not leans:
        return ((box.x + border, y),)
    reach = max(-box.height / 2 + 6, min(box.height / 2 - 6, 0.4 * (y - box.y)))
    return (box.x + border, box.y + reach), (box.x + border + sign * SLANT, y)


def _on_sheet(
    boxes: Mapping[str, Box],
    sides: Mapping[str, Side],
    paths: Sequence[tuple[Point, ...]],
) -> Layout:
    """Return everything moved to positive coordinates with a margin."""
    points = [Box(x, y, 2.0, 2.0) for path in paths for x, y in path]
    sheet = around([*boxes.values(), *points])
    dx, dy = MARGIN - sheet.left, MARGIN - sheet.top
    return Layout(
        {name: box.moved(dx, dy) for name, box in boxes.items()},
        dict(sides),
        tuple(tuple((x + dx, y + dy) for x, y in path) for path in paths),
        sheet.width + 2 * MARGIN,
        sheet.height + 2 * MARGIN,
    )
