"""Bonds on paper: the half arrow, its barb, and the causal stroke.

The barb is on the flow side (below a bond, or to its right if it is upright), so that
effort is read above or left, as in the textbooks. The stroke crosses the end of the
bond that receives effort.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from bondgraph.reporting.layout import Box, Layout
from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.graph import Bond, FinishedGraph

CLEARANCE = 5.0  # between a box and the bond that ends at it
BARB = 11.0
STROKE = 8.0  # half length of the causal stroke
PARALLEL = 14.0  # between parallel bonds


def draw_bonds(
    graph: FinishedGraph,
    layout: Layout,
    strokes: Mapping[str, str],
    marked: set[str],
) -> Iterable[str]:
    """Yield every bond as an SVG group; parallel bonds are drawn side by side.

    Parameters
    ----------
    graph, layout
        The graph and the boxes its bonds end at.
    strokes
        For each bond name, the node at the end that receives effort.
    marked
        Names of inserted elements, whose bonds are marked as well.
    """
    total = Counter(frozenset((b.tail, b.head)) for b in graph.bonds)
    drawn: Counter[frozenset[str]] = Counter()
    for bond, domain in zip(graph.bonds, graph.domains, strict=True):
        pair = frozenset((bond.tail, bond.head))
        shift = PARALLEL * (drawn[pair] - (total[pair] - 1) / 2)
        drawn[pair] += 1
        line = _clipped(layout.boxes[bond.tail], layout.boxes[bond.head], shift)
        inserted = " inserted" if marked & pair else ""
        yield (
            f'<g class="bond{inserted}" data-name={quoteattr(bond.name)}>'
            f"<title>{escape(_bond_words(bond, domain, strokes))}</title>"
            f"{_arrow(line)}{_stroke(line, bond, strokes)}</g>"
        )


def _bond_words(bond: Bond, domain: EnergyDomain, strokes: Mapping[str, str]) -> str:
    words = f"{bond.name}: {domain.effort} and {domain.flow}"
    if bond.name in strokes:
        words += f"; {strokes[bond.name]} receives effort"
    return words


@dataclass(frozen=True, slots=True)
class _Line:
    """A directed straight line, tail to head."""

    x1: float
    y1: float
    x2: float
    y2: float

    @property
    def along(self) -> tuple[float, float]:
        """The unit vector from tail to head."""
        length = math.hypot(self.x2 - self.x1, self.y2 - self.y1) or 1.0
        return (self.x2 - self.x1) / length, (self.y2 - self.y1) / length


def _clipped(tail: Box, head: Box, shift: float) -> _Line:
    """Return the visible part of the line between two boxes, `shift` to its side."""
    dx, dy = _Line(tail.x, tail.y, head.x, head.y).along
    # The side is counted from the lower end, so that a>b and b>a do not coincide.
    side = -shift if (dx, dy) < (0.0, 0.0) else shift
    ox, oy = -dy * side, dx * side
    start, end = _reach(tail, dx, dy), _reach(head, dx, dy)
    return _Line(
        tail.x + dx * start + ox,
        tail.y + dy * start + oy,
        head.x - dx * end + ox,
        head.y - dy * end + oy,
    )


def _reach(box: Box, dx: float, dy: float) -> float:
    """Return how far from its centre a ray leaves a box, with clearance."""
    across = (box.width / 2 + CLEARANCE) / abs(dx) if dx else math.inf
    upright = (box.height / 2 + CLEARANCE) / abs(dy) if dy else math.inf
    return min(across, upright)


def _flow_side(dx: float, dy: float) -> tuple[float, float]:
    """Return the unit normal towards the flow side: below, or right if upright."""
    normal = (-dy, dx)
    upright = abs(dx) < 1e-6
    wrong = normal[0] < 0 if upright else normal[1] < 0
    return (-normal[0], -normal[1]) if wrong else normal


def _arrow(line: _Line) -> str:
    dx, dy = line.along
    nx, ny = _flow_side(dx, dy)
    bx = line.x2 - BARB * (0.82 * dx - 0.57 * nx)
    by = line.y2 - BARB * (0.82 * dy - 0.57 * ny)
    return (
        f'<path class="half-arrow" d="M{line.x1:.1f} {line.y1:.1f}L{line.x2:.1f} '
        f'{line.y2:.1f}L{bx:.1f} {by:.1f}"/>'
    )


def _stroke(line: _Line, bond: Bond, strokes: Mapping[str, str]) -> str:
    if bond.name not in strokes:
        return ""
    at_head = strokes[bond.name] == bond.head
    x, y = (line.x2, line.y2) if at_head else (line.x1, line.y1)
    dx, dy = line.along
    return (
        f'<path class="causal" data-at={quoteattr(strokes[bond.name])} '
        f'd="M{x - dy * STROKE:.1f} {y + dx * STROKE:.1f}'
        f'L{x + dy * STROKE:.1f} {y - dx * STROKE:.1f}"/>'
    )
