"""A laid out graph turned into SVG: bonds, nodes, sensors, legend, sheet."""

import itertools
import math
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from bondgraph.reporting.layout.boxes import Box, Layout, Point, around
from bondgraph.reporting.layout.placing import MARGIN, Sizes, lay_out
from bondgraph.reporting.picture.activated import Activated, draw_activated
from bondgraph.reporting.picture.bond_labels import (
    BondLabel,
    BondLabels,
    labels_of,
    length_for,
    place,
    width_beside,
)
from bondgraph.reporting.picture.causal_marks import CausalMarks
from bondgraph.reporting.picture.colouring import Colouring
from bondgraph.reporting.picture.half_arrows import (
    BondLook,
    Line,
    barb,
    draw_bond,
    stroke_ends,
)
from bondgraph.reporting.picture.legend import WORDS, legend_of, opacity
from bondgraph.reporting.picture.node_labels import NodeLabel
from bondgraph.reporting.picture.numbering import bond_numbers
from bondgraph.reporting.picture.sensors import (
    Sensor,
    drawn_letter,
    law_text,
    modulations,
    sensors_of,
)
from bondgraph.reporting.picture.shapes import Crowd, Shape, corners, strip
from bondgraph.reporting.picture.theme import Theme, style
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
from bondgraph.structure.nodes import written_laws

RADIUS = 8.0
WAY = 8.0  # room that a signal leaves to a bond


@dataclass(frozen=True, slots=True, kw_only=True)
class Content:
    """What a picture shows of its graph.

    Attributes
    ----------
    causality
        Strokes and marks.
    colouring
        A value per place.
    inserted
        Names of elements to mark.
    labels
        What is written at bonds.
    signals
        Whether sensors and signals are drawn.
    """

    causality: CausalMarks
    colouring: Colouring | None
    inserted: frozenset[str]
    labels: BondLabels
    signals: bool


class Picture:
    """Everything that is drawn, laid out."""

    def __init__(self, graph: FinishedGraph, content: Content) -> None:
        self.graph = graph
        self.content = content
        self.causality = content.causality
        self.colouring = content.colouring
        self.sensors = sensors_of(graph) if content.signals else ()
        self.texts = {n.name: self._label(n) for n in graph.nodes}
        for sensor in self.sensors:
            text = NodeLabel(sensor.letter, sensor.measurement.name)
            self.texts[sensor.key] = text
        numbers = bond_numbers(graph)
        self.bond_labels: list[tuple[BondLabel, ...]] = [
            labels_of(content.labels, bond.name, numbers[k])
            for k, bond in enumerate(graph.bonds)
        ]
        sizes = Sizes(
            labels={name: text.size for name, text in self.texts.items()},
            bonds=[length_for(own) for own in self.bond_labels],
            beside=max(map(width_beside, self.bond_labels), default=0.0),
        )
        on = {sensor.key: sensor.on for sensor in self.sensors}
        self.layout: Layout = lay_out(graph, sizes, on)
        self._shares = {} if self.colouring is None else self.colouring.shares()
        # Two pictures on one page differ in what they show, so they differ in this.
        said = f"{graph.name} {content}".encode()
        self._id = f"bondgraph-{zlib.crc32(said):08x}"

    def _label(self, node: Node) -> NodeLabel:
        small = ""
        if isinstance(node, Transformer | Gyrator) and node.law is not None:
            small = law_text(node.law)
        if self.colouring is not None and node.name in self.colouring.values:
            small = f"{small} {self.colouring.written(node.name)}".strip()
        return NodeLabel(drawn_letter(node), node.name, small)

    def svg(self, theme: Theme) -> str:
        """Return the whole document."""
        boxes = [corners(box) for box in self.layout.boxes.values()]
        lines = [piece for path in self.layout.paths for piece in _pieces(path)]
        activated: list[str] = []
        curves: list[Shape] = []
        if self.content.signals:
            ways = Crowd([strip(*piece, WAY) for piece in lines])
            near = [corners(box.grown(2.0)) for box in self.layout.boxes.values()]
            activated = self._activated(Crowd(near), ways)
            curves = ways.shapes[len(lines) :]
        width, height = self.layout.width, self.layout.height
        self._reach = around(
            [
                Box(width / 2, height / 2, width, height),
                *(Box(x, y, MARGIN, MARGIN) for curve in curves for x, y in curve),
            ]
        )
        bonds = self._bonds([*boxes, *lines, *curves])
        nodes = [self._node(node) for node in self.graph.nodes]
        sensors = [self._sensor(sensor) for sensor in self.sensors]
        shown = [*activated, *bonds, *nodes, *sensors]
        return self._sheet(shown, theme)

    def _activated(self, boxes: Crowd, lines: Crowd) -> list[str]:
        """Return the signals to sensors and to the elements whose laws read them."""
        arrows = [
            Activated(place, sensor.key, f"{sensor.measurement.name} reads {place}")
            for sensor in self.sensors
            for place in sensor.reads
        ]
        return [
            draw_activated(
                one, (self._at(one.source), self._at(one.target)), boxes, lines
            )[0]
            for one in (*arrows, *modulations(self.graph))
        ]

    def _at(self, place: str) -> Box:
        """Return the box of a node or sensor, or a point in the middle of a bond."""
        if place in self.layout.boxes:
            return self.layout.boxes[place]
        k = next(k for k, b in enumerate(self.graph.bonds) if b.name == place)
        longest = max(
            _pieces(self.layout.paths[k]), key=lambda piece: math.dist(*piece)
        )
        (ax, ay), (bx, by) = longest
        return Box((ax + bx) / 2, (ay + by) / 2, 0.0, 0.0)

    def _bonds(self, obstacles: Sequence[Shape]) -> list[str]:
        """Return the bonds, their labels in what room is left."""
        strokes = [
            stroke_ends(path, at_head=self.causality.strokes[bond.name] == bond.head)
            for bond, path in zip(self.graph.bonds, self.layout.paths, strict=True)
            if bond.name in self.causality.strokes
        ]
        barbs = [(barb(path), path[-1]) for path in self.layout.paths]
        labelled = any(self.bond_labels)
        crowd = Crowd([*obstacles, *strokes, *barbs] if labelled else [])
        drawn = []
        for k, bond in enumerate(self.graph.bonds):
            path = self.layout.paths[k]
            marks = _marks(self.causality.bonds.get(bond.name))
            if self.content.inserted & {bond.tail, bond.head}:
                marks.append("inserted")
            look = BondLook(
                stroke=self.causality.strokes.get(bond.name),
                marks=marks,
                words=[WORDS[mark] for mark in marks],
            )
            written = "".join(
                place(label, path, crowd).svg() for label in self.bond_labels[k]
            )
            domain = self.graph.domains[k]
            drawn.append(draw_bond(bond, domain, path, look, written))
        return drawn

    def _node(self, node: Node) -> str:
        """Return one node: box, colour, mark and its texts."""
        box, side = self.layout.boxes[node.name], self.layout.sides[node.name]
        css = ["node", _kind(node), *_marks(self.causality.nodes.get(node.name))]
        if node.name in self.content.inserted:
            css.append("inserted")
        parts = [f"<title>{escape(self._words(node))}</title>"]
        if isinstance(node, Junction):
            parts.append(_rectangle(box, "body"))
        if node.name in self._shares:
            parts.append(_rectangle(box, "blame", share=self._shares[node.name]))
        if node.name in self.content.inserted:
            parts.append(_rectangle(box, "mark"))
        parts.append(self.texts[node.name].svg(box, side))
        return (
            f'<g class="{" ".join(css)}" data-name={quoteattr(node.name)} '
            f"id={quoteattr(f'{self._id}-{node.name}')}>{''.join(parts)}</g>"
        )

    def _sensor(self, sensor: Sensor) -> str:
        box, side = self.layout.boxes[sensor.key], self.layout.sides[sensor.key]
        measured = sensor.measurement
        words = f"{measured.name} = {law_text(measured.expression)} [{measured.unit}]"
        new = measured.name in self.content.inserted
        mark = _rectangle(box, "mark") if new else ""
        return (
            f'<g class="sensor{" inserted" if new else ""}" '
            f"data-name={quoteattr(measured.name)}><title>{escape(words)}</title>"
            f"{mark}{self.texts[sensor.key].svg(box, side)}</g>"
        )

    def _words(self, node: Node) -> str:
        """Return the tooltip of a node."""
        names = {ZeroJunction: "0-junction", OneJunction: "1-junction"}
        words = f"{names.get(type(node), drawn_letter(node))} {node.name}"
        laws = written_laws(node)
        if laws:
            words += f": {'; '.join(law_text(law) for law in laws)}"
        if node.name in self.causality.nodes:
            words += f" ({WORDS[self.causality.nodes[node.name]]})"
        if self.colouring is not None and node.name in self._shares:
            words += f" ({self.colouring.tooltip(node.name)})"
        return words

    def _sheet(self, drawn: Sequence[str], theme: Theme) -> str:
        name = f"Bond graph of {self.graph.name}"
        marks = {*self.causality.nodes.values(), *self.causality.bonds.values()}
        if self.content.inserted:
            marks.add("inserted")
        if any('class="signal"' in part for part in drawn):
            marks.add("signal")
        legend = legend_of(
            sorted(marks),
            "" if self.colouring is None else self.colouring.scale(),
            left=self._reach.left + MARGIN,
            top=self._reach.bottom,
            width=self._reach.width,
        )
        left, top = self._reach.left, self._reach.top
        width = max(self._reach.width, legend.width)
        height = self._reach.height + legend.height
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" class="bondgraph" '
            f'width="{width:.0f}" height="{height:.0f}" '
            f'viewBox="{left:.0f} {top:.0f} {width:.0f} {height:.0f}" role="img" '
            f'aria-label={quoteattr(name)} aria-describedby="{self._id}-desc">'
            f"<title>{escape(name)}</title>"
            f'<desc id="{self._id}-desc">{escape(self._description())}</desc>'
            f"<style>{style(theme)}</style>"
            f'<rect class="sheet" x="{left:.0f}" y="{top:.0f}" width="{width:.0f}" '
            f'height="{height:.0f}" rx="{10 if theme is Theme.AUTO else 0}"/>'
            f"{''.join(drawn)}{legend.svg}</svg>\n"
        )

    def _description(self) -> str:
        """Return the graph in words, for who does not see it."""
        count = len(self.graph.junctions)
        parts = [f"{count} junction{'' if count == 1 else 's'}"]
        for junction in self.graph.junctions:
            around = [
                b.other(junction.name) for b in self.graph.bonds_at(junction.name)
            ]
            nodes = (self.graph.by_name[name] for name in around[:LISTED])
            listed = ", ".join(f"{drawn_letter(node)} {node.name}" for node in nodes)
            more = f" and {len(around) - LISTED} more" if len(around) > LISTED else ""
            parts.append(
                f"{letter(junction)}-junction {junction.name} joins {listed}{more}"
            )
        return f"{'; '.join(parts[: DESCRIBED + 1])}."


LISTED, DESCRIBED = 12, 40  # longer descriptions help nobody


def _pieces(path: Line) -> Iterator[tuple[Point, Point]]:
    return itertools.pairwise(path)


def _marks(mark: str | None) -> list[str]:
    return [] if mark is None else [mark]


def _kind(node: Node) -> str:
    if isinstance(node, Junction):
        return "junction"
    return "two-port" if isinstance(node, Transformer | Gyrator) else "element"


def _rectangle(box: Box, css: str, *, share: float | None = None) -> str:
    fill = "" if share is None else f' fill-opacity="{opacity(share):.2f}"'
    return (
        f'<rect class="{css}" x="{box.left:.1f}" y="{box.top:.1f}" '
        f'width="{box.width:.1f}" height="{box.height:.1f}" rx="{RADIUS:g}"{fill}/>'
    )
