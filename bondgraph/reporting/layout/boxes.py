"""Rectangles and lines on paper: pixels, x to the right, y downwards."""

import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle by its centre and full size."""

    x: float
    y: float
    width: float
    height: float

    @property
    def left(self) -> float:
        """The x of the left side."""
        return self.x - self.width / 2

    @property
    def right(self) -> float:
        """The x of the right side."""
        return self.x + self.width / 2

    @property
    def top(self) -> float:
        """The y of the upper side."""
        return self.y - self.height / 2

    @property
    def bottom(self) -> float:
        """The y of the lower side."""
        return self.y + self.height / 2

    def overlaps(self, other: "Box") -> bool:
        """Return whether the two rectangles share area."""
        return (
            abs(self.x - other.x) < (self.width + other.width) / 2
            and abs(self.y - other.y) < (self.height + other.height) / 2
        )

    def grown(self, margin: float) -> "Box":
        """Return the box with a margin on every side."""
        return Box(self.x, self.y, self.width + 2 * margin, self.height + 2 * margin)

    def moved(self, dx: float, dy: float) -> "Box":
        """Return the box somewhere else."""
        return Box(self.x + dx, self.y + dy, self.width, self.height)

    def meets(self, one: Point, other: Point) -> bool:
        """Return whether a straight line goes through the inside of the box."""
        enter, leave = 0.0, 1.0
        for start, step, low, high in (
            (one[0], other[0] - one[0], self.left, self.right),
            (one[1], other[1] - one[1], self.top, self.bottom),
        ):
            if abs(step) < 1e-9:
                if not low < start < high:
                    return False
                continue
            first, second = sorted(((low - start) / step, (high - start) / step))
            enter, leave = max(enter, first), min(leave, second)
        return enter < leave - 1e-9


class Side(StrEnum):
    """Where an element hangs on its node, and with it how its label is set.

    Labels above and below are in two lines, those left and right in one, the letter
    always nearest to the bond.
    """

    CENTRE = "centre"
    ABOVE = "above"
    BELOW = "below"
    LEFT = "left"
    RIGHT = "right"


@dataclass(frozen=True, slots=True)
class LabelSize:
    """Width and height of a label set in lines, and set in one line."""

    stacked: tuple[float, float]
    inline: tuple[float, float]

    def on(self, side: Side) -> tuple[float, float]:
        """Return the size on one side."""
        return self.inline if side in (Side.LEFT, Side.RIGHT) else self.stacked


@dataclass(frozen=True, slots=True)
class Layout:
    """A graph on paper.

    Attributes
    ----------
    boxes
        The box of every node and sensor, by name.
    sides
        The side of its node that each of them hangs on.
    paths
        The line of every bond, in the order of the graph's bonds: from the border of
        its tail to the border of its head, over its bends.
    width, height
        The size of the sheet.
    """

    boxes: Mapping[str, Box]
    sides: Mapping[str, Side]
    paths: tuple[tuple[Point, ...], ...]
    width: float
    height: float


def text_width(text: str, size: float) -> float:
    """Return a width in pixels that `text` surely fits in at font size `size`."""
    wide = sum(unicodedata.east_asian_width(c) in "WF" for c in text)
    capitals = sum(c.isupper() or c in "mw%@" for c in text)
    return size * (0.56 * len(text) + 0.44 * wide + 0.16 * capitals)


def around(boxes: Iterable[Box]) -> Box:
    """Return the smallest box that holds all others."""
    every = list(boxes)
    left, right = min(b.left for b in every), max(b.right for b in every)
    top, bottom = min(b.top for b in every), max(b.bottom for b in every)
    return Box((left + right) / 2, (top + bottom) / 2, right - left, bottom - top)
