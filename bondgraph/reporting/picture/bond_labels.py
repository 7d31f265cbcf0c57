"""What is written at bonds: numbers, names, or the letters of effort and flow.

A label takes the first free place beside its bond: in the middle before the ends, on
the effort side before the flow side. Names run along the bond.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from xml.sax.saxutils import escape

from bondgraph.reporting.layout.boxes import Point, text_width
from bondgraph.reporting.picture.half_arrows import Line, along, flow_side
from bondgraph.reporting.picture.shapes import Crowd, Shape, rectangle

SIZE = 11.0
INDEX_SIZE = 8.5
HEIGHT = 12.0
GAP = 4.0
BARB_GAP = 7.0
_PLACES = (0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.18, 0.82)


class BondLabels(StrEnum):
    """What is written at every bond."""

    NONE = "none"
    NUMBERS = "numbers"
    NAMES = "names"
    VARIABLES = "variables"


@dataclass(frozen=True, slots=True)
class BondLabel:
    """One text at a bond, with an index below the line.

    ``effort`` asks for that side or the other (None: whichever is free); ``turned``
    text runs along the bond.
    """

    text: str
    effort: bool | None = None
    turned: bool = False
    index: str = ""

    @property
    def width(self) -> float:
        """The width of the text with its index."""
        return text_width(self.text, SIZE) + text_width(self.index, INDEX_SIZE)


def labels_of(kind: BondLabels, name: str, number: int) -> tuple[BondLabel, ...]:
    """Return what is written at a bond."""
    match kind:
        case BondLabels.NONE:
            return ()
        case BondLabels.NUMBERS:
            return (BondLabel(str(number)),)
        case BondLabels.NAMES:
            return (BondLabel(name, turned=True),)
        case BondLabels.VARIABLES:
            return (
                BondLabel("e", effort=True, index=str(number)),
                BondLabel("f", effort=False, index=str(number)),
            )


def length_for(labels: Sequence[BondLabel]) -> float:
    """Return how long a bond must be to carry its labels."""
    turned = (label.width + 22 for label in labels if label.turned)
    return max(turned, default=0.0)


def width_beside(labels: Sequence[BondLabel]) -> float:
    """Return how much room labels take beside an upright bond."""
    widths = (HEIGHT if label.turned else label.width for label in labels)
    return max((GAP + width for width in widths), default=0.0)


@dataclass(frozen=True, slots=True)
class PlacedLabel:
    """A text on paper: its middle, its angle in degrees, and the room it takes."""

    label: BondLabel
    middle: Point
    angle: float
    room: Shape

    def svg(self) -> str:
        """Return the text."""
        x, y = self.middle
        turn = f' transform="rotate({self.angle:.1f} {x:.1f} {y:.1f})"'
        index = ""
        if self.label.index:
            digits = escape(self.label.index)
            index = f'<tspan dy="3" font-size="{INDEX_SIZE:g}">{digits}</tspan>'
        css = "number" if self.label.effort is None else "number variable"
        return (
            f'<text class="{css}" x="{x:.1f}" y="{y + 0.36 * SIZE:.1f}" '
            f'font-size="{SIZE:g}"{turn if self.angle else ""}>'
            f"{escape(self.label.text)}{index}</text>"
        )


def place(label: BondLabel, path: Line, crowd: Crowd) -> PlacedLabel:
    """Return a label at its best place, and add it to the crowd."""
    best, fewest = None, math.inf
    for placed in _candidates(label, path):
        touched = crowd.touches(placed.room)
        if touched < fewest:
            best, fewest = placed, touched
        if not touched:
            break
    assert best is not None
    crowd.add(best.room)
    return best


def _candidates(label: BondLabel, path: Line) -> Iterator[PlacedLabel]:
    width = label.width
    segments = sorted(itertools.pairwise(path), key=lambda s: -math.dist(*s))
    for away in (0.0, 3.0, 7.0, 12.0, 18.0):
        for one, other in segments:
            direction = along(one, other)
            angle = _reading_angle(direction) if label.turned else 0.0
            for side in _sides(label, flow_side(direction)):
                gap = away + (GAP if side != flow_side(direction) else BARB_GAP)
                reach = gap + _half_width(side, width, angle)
                for part in _PLACES:
                    x = one[0] + part * (other[0] - one[0]) + reach * side[0]
                    y = one[1] + part * (other[1] - one[1]) + reach * side[1]
                    room = rectangle((x, y), width, HEIGHT, math.radians(angle))
                    yield PlacedLabel(label, (x, y), angle, room)


def _reading_angle(direction: Point) -> float:
    """Return the angle of text along a line, never upside down."""
    angle = math.degrees(math.atan2(direction[1], direction[0]))
    if angle > 90 - 1e-6:
        return angle - 180
    return angle + 180 if angle < -90 - 1e-6 else angle


def _sides(label: BondLabel, flow: Point) -> list[Point]:
    effort = (-flow[0], -flow[1])
    if label.effort is None:
        return [effort, flow]
    return [effort if label.effort else flow]


def _half_width(side: Point, width: float, angle: float) -> float:
    """Return half the extent of a turned text towards one side."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    across = abs(side[0] * c + side[1] * s)
    upright = abs(-side[0] * s + side[1] * c)
    return (across * width + upright * HEIGHT) / 2
