"""What a graph's laws and measurements read, as sensors and signals to draw."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import sympy

from bondgraph.reporting.picture.activated import Activated
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import Junction, Node, letter
from bondgraph.structure.graph import FinishedGraph, Measurement
from bondgraph.structure.nodes import written_laws
from bondgraph.structure.signals import Signal, signals_in

_LETTERS = {
    Quantity.EFFORT: "De",
    Quantity.FLOW: "Df",
    Quantity.MOMENTUM: "Dp",
    Quantity.DISPLACEMENT: "Dq",
}
_SHORT = {
    Quantity.EFFORT: "e",
    Quantity.FLOW: "f",
    Quantity.MOMENTUM: "p",
    Quantity.DISPLACEMENT: "q",
}
_READ = re.compile(r'(effort|flow|momentum|displacement)\("([^"]*)"\)')
_POWERS = {"**2": "²", "**3": "³", "*": "·"}


@dataclass(frozen=True, slots=True)
class Sensor:
    """A measurement as it is drawn.

    Attributes
    ----------
    key
        Its name among the boxes of the picture, which no node has.
    letter
        De, Df, Dp or Dq; ``y`` for an expression.
    on
        The junction or element that it is put on.
    reads
        The places it reads.
    """

    key: str
    letter: str
    measurement: Measurement
    on: str
    reads: tuple[str, ...]


def sensors_of(graph: FinishedGraph) -> tuple[Sensor, ...]:
    """Return the measurements that read a place of the graph."""
    return tuple(
        _sensor(graph, measurement, signals)
        for measurement in graph.measurements
        if (signals := signals_in(measurement.expression))
    )


def _sensor(
    graph: FinishedGraph, measurement: Measurement, signals: tuple[Signal, ...]
) -> Sensor:
    alone = measurement.expression == signals[0]
    return Sensor(
        key=f"→{measurement.name}",
        letter=_LETTERS[signals[0].quantity] if alone else "y",
        measurement=measurement,
        on=_carrier(graph, signals[0].place),
        reads=tuple(dict.fromkeys(signal.place for signal in signals)),
    )


def _carrier(graph: FinishedGraph, place: str) -> str:
    """Return the node that a sensor of a node or bond is put on."""
    nodes = graph.by_name
    if place in nodes:
        return place
    bond = next(bond for bond in graph.bonds if bond.name == place)
    ends = [bond.tail, bond.head]
    single = [end for end in ends if len(graph.bonds_at(end)) == 1]
    junctions = [end for end in ends if isinstance(nodes[end], Junction)]
    return [*single, *junctions, *ends][0]


def modulations(graph: FinishedGraph) -> Iterator[Activated]:
    """Yield a signal from every place that a law reads to the element of the law."""
    for node in graph.nodes:
        read = {s for law in written_laws(node) for s in signals_in(law)}
        for place in sorted({s.place for s in read}):
            variables = [_SHORT[s.quantity] for s in read if s.place == place]
            words = f"{node.name} reads {' and '.join(sorted(variables))} of {place}"
            if place != node.name:
                yield Activated(place, node.name, words)


def drawn_letter(node: Node) -> str:
    """Return the letter of a node, with the M of one that reads a signal."""
    plain = letter(node)
    reads = any(signals_in(law) for law in written_laws(node))
    return f"M{plain}" if reads and not plain.startswith("M") else plain


def law_text(law: sympy.Expr) -> str:
    """Return a law as short as a picture wants it: ``l·cos(q(crank))``."""
    text = _READ.sub(lambda m: f"{_SHORT[Quantity(m[1])]}({m[2]})", str(law))
    for written, read in _POWERS.items():
        text = text.replace(written, read)
    return text
