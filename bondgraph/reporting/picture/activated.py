"""Activated bonds: thin lines with a full arrow, which carry a signal and no power.

One leads from every place that a law reads to the element with that law (MTF, MSe, MR),
and one to every sensor.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from bondgraph.reporting.layout.boxes import Box, Point
from bondgraph.reporting.picture.half_arrows import Line, along
from bondgraph.reporting.picture.shapes import Crowd, strip

_BOWS = (0.0, 0.12, -0.12, 0.25, -0.25, 0.4, -0.4, 0.6, -0.6, 0.9, -0.9)
_LANES = (20.0, 50.0, 95.0, 140.0)
_BEVEL = 7.0
_STEPS = 14
HEAD = 8.0
CLEARANCE = 3.0
_NODE_COST, _BOND_COST, _BOW_COST = 40.0, 6.0, 6.0


@dataclass(frozen=True, slots=True)
class Activated:
    """A signal from one place to another, in the words of the picture."""

    source: str
    target: str
    words: str


def draw_activated(
    signal: Activated, ends: tuple[Box, Box], nodes: Crowd, bonds: Crowd
) -> tuple[str, Line]:
    """Return an activated bond between two boxes, and add its line to `bonds`.

    Of the lines tried, bows between the boxes and brackets above or below them, the one
    that runs over the fewest nodes and bonds is taken; of equal ones the shortest.
    """

    def cost(curve: Sequence[Point]) -> float:
        pieces = list(itertools.pairwise(curve))
        hit = sum(nodes.touches(piece) for piece in pieces)
        crossed = sum(bonds.touches(piece) for piece in pieces)
        longer = sum(math.dist(*piece) for piece in pieces) / math.dist(
            curve[0], curve[-1]
        )
        return _NODE_COST * hit + _BOND_COST * crossed + _BOW_COST * (longer - 1)

    bows = (curve for bow in _BOWS for curve in _curves(ends, bow))
    best = min((*bows, *_brackets(ends)), key=cost)
    for piece in itertools.pairwise(best):
        bonds.add(strip(*piece, 5.0))
    line = "L".join(f"{x:.1f} {y:.1f}" for x, y in best)
    drawn = (
        f'<g class="signal" data-from={quoteattr(signal.source)} '
        f"data-to={quoteattr(signal.target)}><title>{escape(signal.words)}</title>"
        f'<path d="M{line}"/>{_head(best[-2], best[-1])}</g>'
    )
    return drawn, best


def _curves(ends: tuple[Box, Box], bow: float) -> Iterator[list[Point]]:
    """Yield the curve with one bow, cut off at the boxes."""
    one, other = ends
    (x1, y1), (x2, y2) = (one.x, one.y), (other.x, other.y)
    bend = ((x1 + x2) / 2 - bow * (y2 - y1), (y1 + y2) / 2 + bow * (x2 - x1))
    start = _border(one, bend)
    end = _border(other, bend)
    if math.dist(start, end) < 1.0:
        return
    curve = []
    for step in range(_STEPS + 1):
        t = step / _STEPS
        a, b, c = (1 - t) ** 2, 2 * t * (1 - t), t**2
        curve.append(
            (
                a * start[0] + b * bend[0] + c * end[0],
                a * start[1] + b * bend[1] + c * end[1],
            )
        )
    yield curve if bow else [start, end]


def _brackets(ends: tuple[Box, Box]) -> Iterator[list[Point]]:
    """Yield lines that leave and arrive upright, above or below both boxes."""
    one, other = ends
    for lane in _LANES:
        top = min(one.top, other.top) - lane
        bottom = max(one.bottom, other.bottom) + lane
        for aside in (0.0, 0.3, -0.3):
            x1, x2 = one.x + aside * one.width, other.x + aside * other.width
            if abs(x2 - x1) < 4 * _BEVEL:
                continue
            step = math.copysign(_BEVEL, x2 - x1)
            for y, y1, y2, turn in (
                (top, one.top - CLEARANCE, other.top - CLEARANCE, _BEVEL),
                (bottom, one.bottom + CLEARANCE, other.bottom + CLEARANCE, -_BEVEL),
            ):
                yield [
                    *((x1, y1), (x1, y + turn), (x1 + step, y)),
                    *((x2 - step, y), (x2, y + turn), (x2, y2)),
                ]


def _border(box: Box, towards: Point) -> Point:
    """Return where a line from the middle of a box leaves it, with clearance."""
    dx, dy = along((box.x, box.y), towards)
    across = (box.width / 2 + CLEARANCE) / abs(dx) if dx else math.inf
    upright = (box.height / 2 + CLEARANCE) / abs(dy) if dy else math.inf
    reach = min(across, upright)
    return box.x + dx * reach, box.y + dy * reach


def _head(before: Point, tip: Point) -> str:
    """Return an open arrow head."""
    dx, dy = along(before, tip)
    x, y = tip
    left = (x - HEAD * (0.9 * dx - 0.4 * dy), y - HEAD * (0.9 * dy + 0.4 * dx))
    right = (x - HEAD * (0.9 * dx + 0.4 * dy), y - HEAD * (0.9 * dy - 0.4 * dx))
    return (
        f'<path class="head" d="M{left[0]:.1f} {left[1]:.1f}L{x:.1f} {y:.1f}'
        f'L{right[0]:.1f} {right[1]:.1f}"/>'
    )
