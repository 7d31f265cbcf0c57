"""Edits of channels: what a sensor reads, and what an input does."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import sympy

from bondgraph.errors import StructureError
from bondgraph.structure.edits.rebuilding import Pieces, usual_bond
from bondgraph.structure.edits.signal_states import SignalState
from bondgraph.structure.elements import (
    EffortSource,
    OneJunction,
    ZeroJunction,
)
from bondgraph.structure.graph import FinishedGraph, Measurement
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.renaming import Renaming
from bondgraph.structure.signals import canonical


def _measured(graph: FinishedGraph, *wanted: str) -> None:
    """Refuse what is not measured."""
    _among([m.name for m in graph.measurements], wanted, "measurement", "Measured")


def _driven(graph: FinishedGraph, *wanted: str) -> None:
    """Refuse what no recording drives."""
    _among([source.name for source in graph.inputs], wanted, "input", "Inputs")


def _among(
    names: Sequence[str], wanted: Sequence[str], kind: str, heading: str
) -> None:
    for name in wanted:
        if name not in names:
            raise StructureError(
                f"There is no {kind} {name!r}.",
                (name,),
                f"{heading} here: {', '.join(names)}.",
            )


@dataclass(frozen=True, slots=True)
class ReplaceMeasurement:
    """Let a sensor read another expression (scale, bias, nonlinearity, lag).

    Parameters
    ----------
    reads
        What the sensor reads before. Of a graph in which it reads something else,
        because an earlier edit is not there any more, that is meant.
    """

    measurement: str
    expression: sympy.Expr
    parameters: tuple[Parameter, ...] = ()
    states: tuple[SignalState, ...] = ()
    nested: bool = False
    reads: sympy.Expr | None = None

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the sensor's expression replaced."""
        _measured(graph, self.measurement)
        (before,) = (m for m in graph.measurements if m.name == self.measurement)

        def meant(told: sympy.Expr) -> sympy.Expr:
            read, now = self.reads, before.expression
            return told if read is None or read == now else told.subs(read, now)

        expression = canonical(meant(self.expression))
        pieces = Pieces.of(graph)
        pieces.measurements = [
            Measurement(m.name, expression, m.unit) if m is before else m
            for m in graph.measurements
        ]
        pieces.remember(tuple(replace(z, rate=meant(z.rate)) for z in self.states))
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        return f"sensor {self.measurement} reads {self.expression}"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.measurement


@dataclass(frozen=True, slots=True)
class SwapMeasurements:
    """Let two sensors read what the other one read.

    At once: between two single edits a parameter that only one of them uses would be
    used by nothing, and go.
    """

    first: str
    second: str
    parameters: tuple[Parameter, ...] = ()
    nested: bool = False

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the expressions of both exchanged."""
        read = {m.name: m.expression for m in graph.measurements}
        _measured(graph, self.first, self.second)
        other = {self.first: self.second, self.second: self.first}
        pieces = Pieces.of(graph)
        pieces.measurements = [
            Measurement(m.name, read[other.get(m.name, m.name)], m.unit)
            for m in graph.measurements
        ]
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        return f"sensors {self.first} and {self.second} read each other's"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.first


@dataclass(frozen=True, slots=True)
class WrapInput:
    """Let an input act through an expression (scale, saturation, dead zone, delay).

    The input itself moves to a junction of its own, where it does nothing; in its
    place stands the source `applied`, whose `value` reads it. What read the input in
    the machine reads what is applied.

    Parameters
    ----------
    input
        The recorded input.
    value
        What is applied, an expression of ``effort(input)`` (or ``flow(input)``).
    applied
        The name of the new source.
    """

    input: str
    value: sympy.Expr
    applied: str
    parameters: tuple[Parameter, ...] = ()
    states: tuple[SignalState, ...] = ()
    nested: bool = False

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the input acting through the expression."""
        _driven(graph, self.input)
        (source,) = (s for s in graph.inputs if s.name == self.input)
        (bond,) = graph.bonds_at(self.input)
        domain = graph.domain_at(self.input)
        pieces = Pieces.of(graph)
        pieces.read_elsewhere(
            {self.input: self.applied, bond.name: f"{self.applied}>{bond.head}"}
        )
        value = canonical(self.value)
        pieces.swap(self.input, type(source)(self.applied, value=value))
        aside = f"{self.applied}_command"
        effort = isinstance(source, EffortSource)
        junction = ZeroJunction(aside) if effort else OneJunction(aside)
        # Right behind what is applied, so that the inputs keep their order.
        at = 1 + [node.name for node in pieces.nodes].index(self.applied)
        pieces.nodes[at:at] = [junction, source]
        at = 1 + [b.tail for b, _ in pieces.bonds].index(self.applied)
        pieces.bonds.insert(at, (usual_bond(source, aside), domain))
        pieces.remember(self.states)
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        return f"input {self.input} acts as {self.value}"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.applied


@dataclass(frozen=True, slots=True)
class SwapInputs:
    """Let two sources of one kind drive each the other's place.

    The machine stays: what read the one that drives a place reads the one that drives
    it now. The recorded channels keep their names and their order.
    """

    first: str
    second: str
    parameters: tuple[Parameter, ...] = ()
    nested: bool = False

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the two sources in each other's places."""
        _driven(graph, self.first, self.second)
        moved = Renaming({self.first: self.second, self.second: self.first})
        pieces = Pieces.of(graph)
        pieces.nodes = list(map(moved.node, graph.nodes))
        pieces.bonds = [(moved.bond(bond), domain) for bond, domain in pieces.bonds]
        pieces.measurements = [
            Measurement(m.name, moved.expression(m.expression), m.unit)
            for m in graph.measurements
        ]
        for source in graph.inputs:
            pieces.to_the_end(source.name)
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        return f"inputs {self.first} and {self.second} drive each other's place"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.first
