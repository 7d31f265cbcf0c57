"""Convex shapes on paper: whether they touch, and a quick search for those nearby."""

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence

from bondgraph.reporting.layout.boxes import Box, Point

Shape = tuple[Point, ...]
_CELL = 90.0
_Reach = tuple[float, float, float, float]


def rectangle(centre: Point, width: float, height: float, angle: float = 0.0) -> Shape:
    """Return the corners of a rectangle turned by `angle` (radians)."""
    c, s = math.cos(angle), math.sin(angle)
    half = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return tuple(
        (
            centre[0] + c * a * width / 2 - s * b * height / 2,
            centre[1] + s * a * width / 2 + c * b * height / 2,
        )
        for a, b in half
    )


def strip(one: Point, other: Point, width: float) -> Shape:
    """Return a line with a width."""
    middle = ((one[0] + other[0]) / 2, (one[1] + other[1]) / 2)
    angle = math.atan2(other[1] - one[1], other[0] - one[0])
    return rectangle(middle, math.dist(one, other), width, angle)


def corners(box: Box) -> Shape:
    """Return the corners of a box."""
    return rectangle((box.x, box.y), box.width, box.height)


def touch(one: Shape, other: Shape) -> bool:
    """Return whether two convex shapes (a line has two corners) share area or cross."""
    for a, b in (*_sides(one), *_sides(other)):
        normal = (a[1] - b[1], b[0] - a[0])
        if normal == (0.0, 0.0):
            continue
        first = [normal[0] * x + normal[1] * y for x, y in one]
        second = [normal[0] * x + normal[1] * y for x, y in other]
        if max(first) <= min(second) + 1e-9 or max(second) <= min(first) + 1e-9:
            return False
    return True


def _sides(shape: Shape) -> Iterator[tuple[Point, Point]]:
    for k, corner in enumerate(shape):
        yield shape[k - 1], corner
    if len(shape) == 2:  # the direction along a line separates as well
        (ax, ay), (bx, by) = shape
        yield (ax, ay), (ax - (by - ay), ay + (bx - ax))


class Crowd:
    """Shapes that something new must not touch."""

    def __init__(self, shapes: Sequence[Shape] = ()) -> None:
        self.shapes: list[Shape] = []
        self._reaches: list[_Reach] = []
        self._cells: defaultdict[tuple[int, int], list[int]] = defaultdict(list)
        for shape in shapes:
            self.add(shape)

    def add(self, shape: Shape) -> None:
        """Add a shape."""
        reach = _reach(shape)
        for cell in _cells(reach):
            self._cells[cell].append(len(self.shapes))
        self.shapes.append(shape)
        self._reaches.append(reach)

    def touches(self, shape: Shape) -> int:
        """Return how many of the shapes `shape` touches."""
        reach = _reach(shape)
        near = {k for cell in _cells(reach) for k in self._cells.get(cell, ())}
        return sum(
            touch(shape, self.shapes[k])
            for k in near
            if not _apart(reach, self._reaches[k])
        )


def _reach(shape: Shape) -> _Reach:
    """Return the least and the greatest x and y."""
    xs, ys = zip(*shape, strict=True)
    return min(xs), max(xs), min(ys), max(ys)


def _apart(one: _Reach, other: _Reach) -> bool:
    """Return whether an upright or a level line lies between."""
    left, right, top, bottom = one
    return right < other[0] or other[1] < left or bottom < other[2] or other[3] < top


def _cells(reach: _Reach) -> Iterator[tuple[int, int]]:
    left, right, top, bottom = reach
    for i in range(int(left // _CELL), int(right // _CELL) + 1):
        for j in range(int(top // _CELL), int(bottom // _CELL) + 1):
            yield i, j
