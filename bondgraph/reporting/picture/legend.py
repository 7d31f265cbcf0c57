"""The legend under a picture: only what the picture has on it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape

from bondgraph.reporting.layout.boxes import text_width

SIZE = 11.0
LINE = 22.0
LEAST_WIDTH = 440.0
MARGIN = 26.0
STEPS = 6
WORDS: Mapping[str, str] = {
    "inserted": "new or changed",
    "derivative": "derivative causality",
    "chosen": "causality chosen freely",
    "preferred": "causality as preferred",
    "unmet": "preferred causality not possible",
    "signal": "signal (activated bond)",
}


@dataclass(frozen=True, slots=True)
class Legend:
    """The parts of a legend, and the room they take."""

    svg: str = ""
    width: float = 0.0
    height: float = 0.0


def legend_of(
    marks: Sequence[str], scale: str, *, left: float, top: float, width: float
) -> Legend:
    """Return the legend for the marks on a picture and the words of its colours.

    Parameters
    ----------
    marks
        Classes of the style sheet, of those in `WORDS`.
    scale
        What the colours from none to full mean; empty if there are none.
    left, top, width
        Where it is put and how wide the picture is.
    """
    if not marks and not scale:
        return Legend()
    width = max(width, LEAST_WIDTH)
    parts: list[str] = []
    x, y = left, top
    entries = [("scale", scale)] if scale else []
    entries += [(mark, WORDS[mark]) for mark in WORDS if mark in marks]
    for mark, words in entries:
        swatch = 18.0 * STEPS + 8 if mark == "scale" else 34.0
        room = swatch + text_width(words, SIZE) + 20
        if x > left and x + room > left + width - MARGIN:
            x, y = left, y + LINE
        parts.append(_swatch(mark, x, y))
        parts.append(
            f'<text class="small start" x="{x + swatch:.1f}" y="{y + 4:.1f}" '
            f'font-size="{SIZE:g}">{escape(words)}</text>'
        )
        x += room
    svg = f'<g class="legend">{"".join(parts)}</g>'
    return Legend(svg, width, y - top + LINE)


def _swatch(mark: str, x: float, y: float) -> str:
    if mark == "scale":
        return "".join(
            f'<rect class="blame" x="{x + 18 * k:.1f}" y="{y - 6:.1f}" width="18" '
            f'height="12" fill-opacity="{opacity(k / (STEPS - 1)):.2f}"/>'
            for k in range(STEPS)
        )
    if mark == "inserted":
        return (
            f'<rect class="mark" x="{x:.1f}" y="{y - 7:.1f}" width="24" height="14" '
            f'rx="4"/>'
        )
    line = f'<path d="M{x:.1f} {y:.1f}h24"/>'
    if mark == "signal":
        line += f'<path class="head" d="M{x + 17:.1f} {y - 3:.1f}l7 3l-7 3"/>'
    else:
        line += f'<path class="causal" d="M{x + 24:.1f} {y - 6:.1f}v12"/>'
    return f'<g class="{mark}">{line}</g>'


FULL = 0.6  # opacity of the colour at its strongest: the text on it stays readable


def opacity(share: float) -> float:
    """Return the opacity of the colour for a share from 0 to 1."""
    return FULL * share
