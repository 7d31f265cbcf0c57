"""A bond graph as a picture: half arrows, causal strokes, names, colour by value.

The picture is SVG text made here, with no drawing program behind it: it opens in every
browser, in a report and in a notebook, follows the reader's light or dark theme, and
every node and bond carries its name, so that a picture can be searched and tested.

Drawn as in the textbooks: the half arrow points where power is positive, its barb on
the flow side (below or right, the effort being written above or left); the causal
stroke is a bar across the end of the bond that receives effort.
"""

from collections.abc import Iterable, Mapping
from enum import StrEnum
from typing import TypeVar

from bondgraph.causality.records import CausalAssignment
from bondgraph.errors import StructureError, did_you_mean
from bondgraph.reporting.picture.bond_labels import BondLabels
from bondgraph.reporting.picture.canvas import Content, Picture
from bondgraph.reporting.picture.causal_marks import causal_marks
from bondgraph.reporting.picture.colouring import (
    Colouring,
    check_places,
    colouring_of,
)
from bondgraph.reporting.picture.png import png_of
from bondgraph.reporting.picture.theme import Theme
from bondgraph.structure.graph import FinishedGraph

__all__ = ["BondLabels", "Colouring", "Theme", "draw_png", "draw_svg"]

Choice = TypeVar("Choice", bound=StrEnum)


def draw_svg(
    graph: FinishedGraph,
    *,
    assignment: CausalAssignment | Mapping[str, str] | None = None,
    blame: Mapping[str, float] | None = None,
    colour: Colouring | None = None,
    highlight: Iterable[str] = (),
    labels: BondLabels | str = BondLabels.NONE,
    signals: bool = False,
    theme: Theme | str = Theme.AUTO,
) -> str:
    """Return the picture of a graph as SVG text.

    Parameters
    ----------
    graph
        The graph to draw.
    assignment
        The causality to show: an assignment, which also marks derivative, freely
        chosen, preferred and unmet causality, or for each bond name the node at the
        end that receives effort. Bonds not named are drawn without a stroke.
    blame
        For each place (junction or element), the share 0 to 1 of the error that
        something missing there could explain; drawn as colour and in per cent.
    colour
        Any other value per place to show as colour.
    highlight
        Names of elements to mark as new, and of sensors where these are drawn.
    labels
        What is written at the bonds: ``numbers``, ``names``, ``variables`` (effort
        and flow, each on its side) or ``none``.
    signals
        Whether to draw sensors, and the signals that laws read, as activated bonds.
    theme
        ``auto`` follows the reader's screen; ``light`` and ``dark`` do not.

    Returns
    -------
    str
        A complete SVG document, which may also be placed inside HTML. All names are
        escaped.

    Raises
    ------
    StructureError
        If a place, bond or stroke end is not one of this graph, a blame is not
        between 0 and 1, or there is no such kind of label or theme.
    """
    marked = frozenset(highlight)
    check_places(graph, marked, sensors=signals)
    content = Content(
        causality=causal_marks(graph, assignment),
        colouring=colouring_of(graph, colour, blame),
        inserted=marked,
        labels=_choice(BondLabels, labels, "kind of bond label"),
        signals=signals,
    )
    return Picture(graph, content).svg(_choice(Theme, theme, "theme"))


def draw_png(
    graph: FinishedGraph,
    *,
    scale: float = 2.0,
    assignment: CausalAssignment | Mapping[str, str] | None = None,
    blame: Mapping[str, float] | None = None,
    colour: Colouring | None = None,
    highlight: Iterable[str] = (),
    labels: BondLabels | str = BondLabels.NONE,
    signals: bool = False,
    theme: Theme | str = Theme.LIGHT,
) -> bytes:
    """Return the picture of a graph as PNG; needs the extra ``png``.

    Parameters
    ----------
    graph
        The graph to draw.
    scale
        Pixels of the PNG per pixel of the SVG.
    assignment, blame, colour, highlight, labels, signals
        What is shown, as in `draw_svg`.
    theme
        ``light`` or ``dark``; ``auto`` is ``light``, for a PNG cannot follow a screen.

    Raises
    ------
    StructureError
        As `draw_svg`.
    MissingExtraError
        If resvg-py is not installed.
    BondGraphError
        If the PNG would be empty or too large to hold.
    """
    chosen = _choice(Theme, theme, "theme")
    svg = draw_svg(
        graph,
        assignment=assignment,
        blame=blame,
        colour=colour,
        highlight=highlight,
        labels=labels,
        signals=signals,
        theme=Theme.LIGHT if chosen is Theme.AUTO else chosen,
    )
    return png_of(svg, scale)


def _choice(kind: type[Choice], word: str, what: str) -> Choice:
    try:
        return kind(word)
    except ValueError:
        raise StructureError(
            f"There is no {what} {word!r}.", (word,), did_you_mean(word, kind)
        ) from None
