"""A bond graph as SVG: half arrows, causal strokes, names, and colour by blame.

The picture is text made here, with no drawing program behind it: it opens in every
browser, in a report and in a notebook, follows the reader's light or dark theme, and
every node and bond carries its name, so that a picture can be searched and tested.

Drawn as in the textbooks: the half arrow points where power is positive, its barb on
the flow side (below or right, the effort being written above or left); the causal
stroke is a bar across the end of the bond that receives effort.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from bondgraph.errors import StructureError, did_you_mean
from bondgraph.reporting.half_arrows import draw_bonds
from bondgraph.reporting.layout import MARGIN, Box, Layout, lay_out, text_width
from bondgraph.structure.elements import (
    Gyrator,
    Junction,
    Node,
    OneJunction,
    Transformer,
    ZeroJunction,
    letter,
)
from bondgraph.structure.graph import FinishedGraph

LETTER_SIZE = 17.0
NAME_SIZE = 12.5
SMALL_SIZE = 11.0
LEGEND_HEIGHT = 30.0
LONGEST_LABEL = 34
FULL_BLAME = 0.6  # opacity of the colour at 100 %: the text on it stays readable

STYLE = """
.bondgraph text{font-family:system-ui,-apple-system,"Segoe UI","DejaVu Sans",sans-serif;
text-anchor:middle;fill:#1f2328}
.bondgraph .sheet{fill:#ffffff}
.bondgraph .letter{font-weight:700}
.bondgraph .two-port .letter{font-weight:600}
.bondgraph .two-port .small,.bondgraph .legend text{fill:#4d5761}
.bondgraph .junction rect.body{fill:#eef2f7;stroke:#7b8896;stroke-width:1.2}
.bondgraph rect.blame{fill:#e8590c}
.bondgraph .bond path{fill:none;stroke:#1f2328;stroke-width:1.5;stroke-linecap:round;
stroke-linejoin:round}
.bondgraph .bond path.causal{stroke-width:3;stroke-linecap:butt}
.bondgraph .inserted.bond path{stroke:#0757ad;stroke-width:2}
.bondgraph .inserted.bond path.causal{stroke-width:3}
.bondgraph .inserted text{fill:#0757ad}
.bondgraph rect.mark{fill:none;stroke:#0757ad;stroke-width:2;stroke-dasharray:5 3}
@media (prefers-color-scheme:dark){
.bondgraph text{fill:#e8ebef}
.bondgraph .sheet{fill:#171b21}
.bondgraph .two-port .small,.bondgraph .legend text{fill:#aeb8c4}
.bondgraph .junction rect.body{fill:#242c36;stroke:#7d8b9b}
.bondgraph rect.blame{fill:#ff7a2f}
.bondgraph .bond path{stroke:#e8ebef}
.bondgraph .inserted.bond path{stroke:#7cbcff}
.bondgraph .inserted text{fill:#7cbcff}
.bondgraph rect.mark{stroke:#7cbcff}}
@media print{.bondgraph .sheet{fill:none}}
"""


@dataclass(frozen=True, slots=True)
class _Label:
    """What is written in a node's box: kind, name, and a line in small print."""

    kind: str
    name: str
    small: str = ""

    @property
    def size(self) -> tuple[float, float]:
        width = max(
            text_width(self.kind, LETTER_SIZE),
            text_width(self.name, NAME_SIZE),
            text_width(self.small, SMALL_SIZE),
        )
        return max(width + 14, 34), 58.0 if self.small else 44.0


def draw_svg(
    graph: FinishedGraph,
    *,
    assignment: Mapping[str, str] | None = None,
    blame: Mapping[str, float] | None = None,
    highlight: Iterable[str] = (),
) -> str:
    """Return the picture of a graph as SVG text.

    Parameters
    ----------
    graph
        The graph to draw.
    assignment
        The causal strokes: for each bond name, the node at the end that receives
        effort. Bonds not named are drawn without a stroke.
    blame
        For each place (junction or element), the share 0 to 1 of the error that
        something missing there could explain; drawn as colour and in per cent.
    highlight
        Names of elements to mark as inserted.

    Returns
    -------
    str
        A complete SVG document, which may also be placed inside HTML. All names are
        escaped.

    Raises
    ------
    StructureError
        If a place, bond or stroke end is not one of this graph, or a blame is not
        between 0 and 1.
    """
    strokes, shares, marked = dict(assignment or {}), dict(blame or {}), set(highlight)
    _check_places(graph, shares, marked)
    _check_strokes(graph, strokes)
    labels = {node.name: _label(node, shares.get(node.name)) for node in graph.nodes}
    layout = lay_out(graph, {name: label.size for name, label in labels.items()})
    parts = [
        *draw_bonds(graph, layout, strokes, marked),
        *(
            _node(n, layout.boxes[n.name], labels[n.name], shares, marked)
            for n in graph.nodes
        ),
    ]
    legend = _legend(layout, bool(shares), bool(marked))
    return _sheet(graph, layout, parts, legend)


def _check_places(
    graph: FinishedGraph, shares: Mapping[str, float], marked: Iterable[str]
) -> None:
    known = graph.by_name
    for name in (*shares, *sorted(marked)):
        if name not in known:
            raise StructureError(
                f"There is no {name!r} in {graph.name!r} to colour or mark.",
                (name,),
                did_you_mean(name, known),
            )
    for name, share in shares.items():
        if not 0.0 <= share <= 1.0:
            raise StructureError(
                f"The blame of {name!r} is {share}.", (name,), "Give a share, 0 to 1."
            )


def _check_strokes(graph: FinishedGraph, strokes: Mapping[str, str]) -> None:
    ends = {bond.name: (bond.tail, bond.head) for bond in graph.bonds}
    for name, end in strokes.items():
        if name not in ends:
            raise StructureError(
                f"There is no bond {name!r} in {graph.name!r} to put a stroke on.",
                (name,),
                did_you_mean(name, ends),
            )
        if end not in ends[name]:
            raise StructureError(
                f"The stroke of bond {name!r} is put at {end!r}.",
                (name, end),
                f"Put it at {ends[name][0]!r} or {ends[name][1]!r}.",
            )


def _label(node: Node, share: float | None) -> _Label:
    small = ""
    if isinstance(node, Transformer | Gyrator) and node.law is not None:
        small = _shortened(str(node.law))
    if share is not None:
        small = f"{small} {share:.0%}".strip()
    return _Label(letter(node), _shortened(node.name), small)


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_LABEL else text[: LONGEST_LABEL - 1] + "…"


def _node(
    node: Node,
    box: Box,
    label: _Label,
    shares: Mapping[str, float],
    marked: set[str],
) -> str:
    """Return one node: box, colour, mark and its lines of text."""
    kind = "junction" if isinstance(node, Junction) else "element"
    if isinstance(node, Transformer | Gyrator):
        kind = "two-port"
    inserted = " inserted" if node.name in marked else ""
    parts = [f"<title>{escape(_words(node, shares))}</title>"]
    if kind == "junction":
        parts.append(_rectangle(box, "body"))
    if node.name in shares:
        parts.append(_rectangle(box, "blame", opacity=shares[node.name]))
    if inserted:
        parts.append(_rectangle(box, "mark"))
    top = box.y - box.height / 2
    parts.append(_text(box.x, top + 19, LETTER_SIZE, label.kind, "letter"))
    parts.append(_text(box.x, top + 36, NAME_SIZE, label.name, "name"))
    if label.small:
        parts.append(_text(box.x, top + 51, SMALL_SIZE, label.small, "small"))
    return (
        f'<g class="node {kind}{inserted}" data-name={quoteattr(node.name)}>'
        f"{''.join(parts)}</g>"
    )


def _words(node: Node, shares: Mapping[str, float]) -> str:
    """Return the tooltip of a node."""
    names = {ZeroJunction: "0-junction", OneJunction: "1-junction"}
    words = f"{names.get(type(node), letter(node))} {node.name}"
    law = getattr(node, "law", None) or getattr(node, "value", None)
    if law is not None:
        words += f": {law}"
    if node.name in shares:
        words += f" ({shares[node.name]:.0%} of the error)"
    return words


def _rectangle(
    box: Box, css: str, *, opacity: float | None = None, corner: float = 8
) -> str:
    fill = "" if opacity is None else f' fill-opacity="{FULL_BLAME * opacity:.2f}"'
    return (
        f'<rect class="{css}" x="{box.x - box.width / 2:.1f}" '
        f'y="{box.y - box.height / 2:.1f}" width="{box.width:.1f}" '
        f'height="{box.height:.1f}" rx="{corner:g}"{fill}/>'
    )


def _text(x: float, y: float, size: float, text: str, css: str) -> str:
    return (
        f'<text class="{css}" x="{x:.1f}" y="{y:.1f}" font-size="{size:g}">'
        f"{escape(text)}</text>"
    )


def _legend(layout: Layout, coloured: bool, marked: bool) -> list[str]:
    """Return the legend's parts, placed left to right under the graph."""
    parts: list[str] = []
    x, y = MARGIN, layout.height + 4
    if coloured:
        for step in range(6):
            swatch = Box(x + 9, y, 18, 12)
            parts.append(_rectangle(swatch, "blame", opacity=step / 5, corner=0))
            x += 18
        parts.append(_note(x + 8, y, "0 to 100 % of the error could arise there"))
        x += 8 + text_width("0 to 100 % of the error could arise there", SMALL_SIZE)
        x += 24
    if marked:
        parts.append(_rectangle(Box(x + 12, y, 24, 14), "mark", corner=4))
        parts.append(_note(x + 32, y, "inserted"))
    return parts


def _note(x: float, y: float, text: str) -> str:
    return (
        f'<text class="small" x="{x:.1f}" y="{y + 4:.1f}" font-size="{SMALL_SIZE:g}" '
        f'style="text-anchor:start">{escape(text)}</text>'
    )


def _sheet(
    graph: FinishedGraph, layout: Layout, parts: list[str], legend: list[str]
) -> str:
    height = layout.height + (LEGEND_HEIGHT if legend else 0)
    width = max(layout.width, 440.0 if legend else 0.0)
    size = f'width="{width:.0f}" height="{height:.0f}"'
    below = f'<g class="legend">{"".join(legend)}</g>' if legend else ""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="bondgraph" {size} '
        f'viewBox="0 0 {width:.0f} {height:.0f}" role="img" '
        f"aria-label={quoteattr(f'Bond graph of {graph.name}')}>"
        f"<style>{STYLE}</style>"
        f'<rect class="sheet" width="100%" height="100%" rx="10"/>'
        f"{''.join(parts)}{below}</svg>\n"
    )
