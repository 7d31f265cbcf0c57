"""Edits: a hypothesis about a graph as data, which can be printed and compared.

Each edit is a frozen record with ``apply(graph) -> FinishedGraph`` and ``describe()``.
The family is closed: diagnosis composes these and nothing else.
"""

from dataclasses import dataclass, replace

import sympy

from bondgraph.errors import StructureError
from bondgraph.structure.draft import in_si
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Inertance,
    Node,
    OneJunction,
    OnePort,
    Resistance,
    ZeroJunction,
    letter,
)
from bondgraph.structure.graph import (
    Bond,
    FinishedGraph,
    Measurement,
    used_parameters,
)
from bondgraph.structure.parameters import Parameter, ParameterSet
from bondgraph.structure.signals import canonical


@dataclass(frozen=True, slots=True)
class InsertElement:
    """Hang a one-port on a junction."""

    junction: str
    element: OnePort
    parameters: tuple[Parameter, ...] = ()

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the element on the junction."""
        junction = graph.node(self.junction)
        if not isinstance(junction, ZeroJunction | OneJunction):
            raise StructureError(
                f"{self.junction!r} is not a junction.",
                (self.junction,),
                "Insert elements at a junction.",
            )
        name = self.element.name
        source = isinstance(self.element, EffortSource | FlowSource)
        bond = Bond(name, self.junction) if source else Bond(self.junction, name)
        return replace(
            graph,
            nodes=(*graph.nodes, self.element),
            bonds=(*graph.bonds, bond),
            domains=(*graph.domains, graph.domain_at(self.junction)),
            parameters=graph.parameters.merged(map(in_si, self.parameters)),
        )

    def describe(self) -> str:
        """Return the edit in words."""
        return f"one {letter(self.element)} added at {self.junction}"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.element.name

    @property
    def nested(self) -> bool:
        """Whether the first values of its parameters give the graph before."""
        return True


@dataclass(frozen=True, slots=True)
class ReplaceRelation:
    """Give a one-port of the graph another constitutive relation."""

    element: str
    law: sympy.Expr
    parameters: tuple[Parameter, ...] = ()

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the element's law replaced."""
        node = graph.node(self.element)
        if not isinstance(node, Inertance | Compliance | Resistance):
            raise StructureError(
                f"{letter(node)} {self.element!r} has no constitutive relation.",
                (self.element,),
                "Replace the relation of an I, C or R.",
            )
        new: Node = replace(node, law=canonical(self.law))
        nodes = tuple(new if n.name == self.element else n for n in graph.nodes)
        return _with_nodes(graph, nodes, graph.measurements, self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        return f"the law of {self.element} replaced by {self.law}"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.element

    @property
    def nested(self) -> bool:
        """Whether the first values of its parameters give the graph before."""
        return False


@dataclass(frozen=True, slots=True)
class ReplaceMeasurement:
    """Let a sensor read another expression (scale, bias, nonlinearity)."""

    measurement: str
    expression: sympy.Expr
    parameters: tuple[Parameter, ...] = ()

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the sensor's expression replaced."""
        names = [m.name for m in graph.measurements]
        if self.measurement not in names:
            raise StructureError(
                f"There is no measurement {self.measurement!r}.",
                (self.measurement,),
                f"Measured here: {', '.join(names)}.",
            )
        measurements = tuple(
            Measurement(m.name, canonical(self.expression), m.unit)
            if m.name == self.measurement
            else m
            for m in graph.measurements
        )
        return _with_nodes(graph, graph.nodes, measurements, self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        return f"sensor {self.measurement} reads {self.expression}"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.measurement

    @property
    def nested(self) -> bool:
        """Whether the first values of its parameters give the graph before."""
        return False


GraphEdit = InsertElement | ReplaceRelation | ReplaceMeasurement


def _with_nodes(
    graph: FinishedGraph,
    nodes: tuple[Node, ...],
    measurements: tuple[Measurement, ...],
    added: tuple[Parameter, ...],
) -> FinishedGraph:
    """Return the graph with other nodes; parameters no longer used are dropped."""
    used = used_parameters(nodes, measurements)
    merged: ParameterSet = graph.parameters.merged(map(in_si, added))
    return replace(
        graph,
        nodes=nodes,
        measurements=measurements,
        parameters=merged.restricted(used),
    )
