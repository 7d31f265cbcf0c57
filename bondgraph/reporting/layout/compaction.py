"""The smallest grid on which a drawing with a given shape fits.

Every face is cut into rectangles: where an outline turns away, the line before the turn
is extended to the side it must meet. Then each side of a rectangle only has to be one
unit long, which for columns and for rows is a linear programme of differences
(Di Battista, Eades, Tamassia, Tollis, "Graph Drawing", 1999, chapter 5).
"""

from collections import defaultdict, deque
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from bondgraph.reporting.layout.planar import PlanarMap
from bondgraph.reporting.layout.programme import Values, whole_minimum

HELPER = 0.05  # cost of length of a line that is not drawn
FRAME = 0.0
TIGHTENINGS = 2


@dataclass(frozen=True, slots=True)
class _Line:
    """A straight line from one point to another in one of four directions."""

    tail: int
    head: int
    direction: int


class _Lines:
    """The lines to fit on a grid, drawn and not drawn, and their points."""

    def __init__(self, points: int) -> None:
        self.points = points
        self.lines: list[_Line] = []
        self.costs: list[float] = []

    def point(self) -> int:
        self.points += 1
        return self.points - 1

    def add(self, tail: int, head: int, direction: int, cost: float) -> _Line:
        line = _Line(tail, head, direction % 4)
        self.lines.append(line)
        self.costs.append(cost)
        return line


def compact(
    graph: PlanarMap, direction: Sequence[int], outer: int
) -> list[tuple[int, int]]:
    """Return whole-number coordinates (x east, y north) of every node.

    Parameters
    ----------
    graph, direction
        A map whose edges are straight, and the direction of every dart.
    outer
        A dart with the outside on its left.
    """
    lines = _Lines(len(graph.around))
    for dart in range(0, len(direction), 2):
        lines.add(graph.origin[dart], graph.head(dart), direction[dart], 1.0)
    for face in graph.faces():
        outline = _outline(graph, direction, face, lines)
        if outer in face:
            outline = _framed(outline, lines)
        _cut_into_rectangles(outline, lines)
    size = len(graph.around)
    x, y = (_coordinates(lines, axis)[:size].tolist() for axis in (0, 1))
    return list(zip(x, y, strict=True))


def tighten(
    graph: PlanarMap, direction: Sequence[int], places: Sequence[tuple[int, int]]
) -> list[tuple[int, int]]:
    """Return the coordinates again, without what only the helper lines asked for."""
    drawn = [
        _Line(graph.origin[dart], graph.head(dart), direction[dart])
        for dart in range(0, len(direction), 2)
    ]
    axes = [np.array(values) for values in zip(*places, strict=True)]
    for axis in (0, 1) * TIGHTENINGS:
        axes[axis] = _tightened(drawn, axes, axis)
    x, y = (_ranks(values) for values in axes)
    return list(zip(x, y, strict=True))


def _tightened(drawn: Sequence[_Line], places: Sequence[Values], axis: int) -> Values:
    """Return one coordinate again, with nothing between what now sees each other.

    The helper lines were a guess at what will lie beside what; now it is known.
    """
    along, level = places[axis], places[1 - axis]
    on_level: defaultdict[int, dict[int, int]] = defaultdict(dict)
    for point, (at, value) in enumerate(zip(along, level, strict=True)):
        on_level[value][at] = point
    for line in drawn:
        if line.direction % 2 != axis:
            low, high = sorted((level[line.tail], level[line.head]))
            for value in range(low, high):
                on_level[value].setdefault(along[line.tail], line.tail)
    lines = _Lines(len(along))
    for line in drawn:
        lines.add(line.tail, line.head, line.direction, 1.0)
    for seen in on_level.values():
        ordered = [seen[at] for at in sorted(seen)]
        for one, other in pairwise(ordered):
            lines.add(one, other, axis, HELPER)
    return _coordinates(lines, axis)


def _outline(
    graph: PlanarMap, direction: Sequence[int], face: Sequence[int], lines: _Lines
) -> list[_Line]:
    """Return a face's lines in order; at a node with one bond, with a cap on it."""
    outline = []
    for k, dart in enumerate(face):
        here = direction[dart]
        after = face[(k + 1) % len(face)]
        if len(face) > 1 and after == dart ^ 1:
            tip, cap = graph.head(dart), lines.point()
            outline.append(_Line(graph.origin[dart], tip, here))
            outline.append(lines.add(tip, cap, here + 3, HELPER))
        else:
            outline.append(_Line(graph.origin[dart], graph.head(dart), here))
    for k, line in enumerate(outline):
        before = outline[k - 1]
        if before.head != line.tail:  # the way back starts at the cap
            outline[k] = _Line(before.head, line.head, line.direction)
    return outline


def _turn(before: _Line, after: _Line) -> int:
    """Return 1 for a left turn, -1 for a right turn, 0 for straight on."""
    return (after.direction - before.direction + 1) % 4 - 1


def _framed(outline: list[_Line], lines: _Lines) -> list[_Line]:
    """Return the outside as the inside of a frame, tied to one corner of the graph."""
    at = next(k for k, a in enumerate(outline) if _turn(outline[k - 1], a) == -1)
    outline = outline[at:] + outline[:at]
    corner, ahead = outline[0].tail, outline[-1].direction
    tie, *corners = (lines.point() for _ in range(5))
    frame = [lines.add(corner, tie, ahead, FRAME)]
    here, direction = tie, ahead + 1
    for point in (*corners, tie):
        frame.append(lines.add(here, point, direction, FRAME))
        here, direction = point, direction + 1
    back = _Line(tie, corner, (ahead + 2) % 4)
    return [*outline, *frame, back]


def _cut_into_rectangles(outline: list[_Line], lines: _Lines) -> None:
    """Add helper lines until no corner of the face turns away."""
    ring = deque(outline)
    idle = 0
    # Two left turns after a right one: the line before the right turn is extended to
    # the side it faces, which cuts a rectangle off.
    while idle <= len(ring):
        last = [ring[k] for k in range(-min(len(ring), 4), 0)]
        if len(ring) > 4 and _shape(last) == (-1, 1, 1):
            before, _, _, side = last
            meets = lines.point()
            lines.add(before.head, meets, before.direction, HELPER)
            lines.add(side.tail, meets, side.direction, HELPER)
            rest = lines.add(meets, side.head, side.direction, HELPER)
            new = [_Line(before.tail, meets, before.direction), rest]
            _replace_last(ring, 4, new)
            idle = 0
        elif _turn(*last[-2:]) == 0:
            before, after = last[-2:]
            new = [_Line(before.tail, after.head, after.direction)]
            _replace_last(ring, 2, new)
            idle = 0
        else:
            ring.rotate(-1)
            idle += 1


def _replace_last(ring: deque[_Line], count: int, new: Sequence[_Line]) -> None:
    for _ in range(count):
        ring.pop()
    ring.extend(new)


def _shape(lines: Sequence[_Line]) -> tuple[int, ...]:
    return tuple(_turn(a, b) for a, b in pairwise(lines))


def _coordinates(lines: _Lines, axis: int) -> Values:
    """Return one coordinate of every point; axis 0 is x, 1 is y."""
    across = [a for a in lines.lines if a.direction % 2 != axis]
    along = [k for k, a in enumerate(lines.lines) if a.direction % 2 == axis]
    group = _aligned(lines.points, across)
    tails = group[[lines.lines[k].tail for k in along]]
    heads = group[[lines.lines[k].head for k in along]]
    backward = np.array([lines.lines[k].direction >= 2 for k in along], dtype=bool)
    low, high = np.where(backward, heads, tails), np.where(backward, tails, heads)
    costs = np.array(lines.costs)[along]
    objective = np.zeros(int(group.max()) + 1)
    np.add.at(objective, high, costs)
    np.add.at(objective, low, -costs)
    row = np.arange(len(along))
    found = whole_minimum(
        objective,
        (np.repeat([1.0, -1.0], len(along)), np.tile(row, 2), np.append(low, high)),
        np.full(len(along), -1.0),
        exact=False,
    )
    coordinates: Values = found[group]
    return coordinates


def _aligned(points: int, across: Sequence[_Line]) -> Values:
    """Return a number for every point, the same for those in one line."""
    from scipy.sparse import coo_array  # noqa: PLC0415
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

    ends = np.array([(a.tail, a.head) for a in across], dtype=int).reshape(-1, 2).T
    lines: Any = coo_array((np.ones(len(across)), ends), shape=(points, points))
    group: Values = connected_components(lines, directed=False)[1]
    return group


def _ranks(values: Values) -> list[int]:
    """Return the values with the columns that hold nothing left out."""
    ranks: list[int] = np.unique(values, return_inverse=True)[1].tolist()
    return ranks
