"""Bonds on paper: the half arrow, its barb, and the causal stroke.

The barb is on the flow side (below a bond, or to its right if it is upright), so that
effort is read above or left, as in the textbooks. The stroke crosses the end of the
bond that receives effort.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from bondgraph.reporting.layout.boxes import Point
from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.graph import Bond

BARB = 11.0
STROKE = 8.0  # half length of the causal stroke
CORNER = 9.0  # radius of a bend

Line = Sequence[Point]


@dataclass(frozen=True, slots=True, kw_only=True)
class BondLook:
    """What a bond is drawn with besides its line.

    Attributes
    ----------
    stroke
        The node at the end that receives effort, if it is known.
    marks
        Classes for the style sheet, such as ``derivative``.
    words
        What is said of the bond besides its name and domain.
    """

    stroke: str | None = None
    marks: Sequence[str] = ()
    words: Sequence[str] = ()


def draw_bond(
    bond: Bond, domain: EnergyDomain, path: Line, look: BondLook, label: str = ""
) -> str:
    """Return a bond as an SVG group."""
    css = " ".join(["bond", *look.marks])
    words = "; ".join([f"{domain.effort} and {domain.flow}", *look.words])
    if look.stroke is not None:
        words += f"; {look.stroke} receives effort"
    drawn = _arrow(path)
    if look.stroke is not None:
        drawn += _stroke(path, bond, look.stroke)
    return (
        f'<g class="{css}" data-name={quoteattr(bond.name)}>'
        f"<title>{escape(f'{bond.name}: {words}')}</title>{drawn}{label}</g>"
    )


def along(one: Point, other: Point) -> Point:
    """Return the unit vector from one point to another."""
    dx, dy = other[0] - one[0], other[1] - one[1]
    length = math.hypot(dx, dy) or 1.0
    return dx / length, dy / length


def flow_side(direction: Point) -> Point:
    """Return the unit normal towards the flow side: below, or right if upright."""
    dx, dy = direction
    normal = (-dy, dx)
    upright = abs(dx) < 1e-6
    wrong = normal[0] < 0 if upright else normal[1] < 0
    return (-normal[0], -normal[1]) if wrong else normal


def barb(path: Line) -> Point:
    """Return the end of the barb of a half arrow."""
    x, y = path[-1]
    dx, dy = along(path[-2], path[-1])
    nx, ny = flow_side((dx, dy))
    return x - BARB * (0.82 * dx - 0.57 * nx), y - BARB * (0.82 * dy - 0.57 * ny)


def stroke_ends(path: Line, *, at_head: bool) -> tuple[Point, Point]:
    """Return the ends of the causal stroke at one end of a bond."""
    (x, y), inner = (path[-1], path[-2]) if at_head else (path[0], path[1])
    dx, dy = along(inner, (x, y))
    return (
        (x - dy * STROKE, y + dx * STROKE),
        (x + dy * STROKE, y - dx * STROKE),
    )


def _arrow(path: Line) -> str:
    bx, by = barb(path)
    return f'<path class="half-arrow" d="{_rounded(path)}L{bx:.1f} {by:.1f}"/>'


def _rounded(path: Line) -> str:
    """Return the line with its bends rounded."""
    parts = [f"M{path[0][0]:.1f} {path[0][1]:.1f}"]
    for before, corner, after in zip(path, path[1:], path[2:], strict=False):
        radius = min(
            CORNER, math.dist(before, corner) / 2, math.dist(corner, after) / 2
        )
        (ax, ay), (bx, by) = along(corner, before), along(corner, after)
        x, y = corner
        parts.append(
            f"L{x + radius * ax:.1f} {y + radius * ay:.1f}"
            f"Q{x:.1f} {y:.1f} {x + radius * bx:.1f} {y + radius * by:.1f}"
        )
    return "".join([*parts, f"L{path[-1][0]:.1f} {path[-1][1]:.1f}"])


def _stroke(path: Line, bond: Bond, at: str) -> str:
    (ax, ay), (bx, by) = stroke_ends(path, at_head=at == bond.head)
    return (
        f'<path class="causal" data-at={quoteattr(at)} '
        f'd="M{ax:.1f} {ay:.1f}L{bx:.1f} {by:.1f}"/>'
    )
