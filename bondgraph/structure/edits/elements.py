"""Edits of elements: one more on a junction, or another law for one that is there."""

from dataclasses import dataclass, replace

import sympy

from bondgraph.errors import StructureError
from bondgraph.structure.edits.rebuilding import Pieces
from bondgraph.structure.edits.signal_states import SignalState
from bondgraph.structure.elements import Junction, Node, OnePort, Source, letter
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.nodes import WithLaw
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import canonical


@dataclass(frozen=True, slots=True)
class InsertElement:
    """Hang a one-port on a junction, with the states that its law reads."""

    junction: str
    element: OnePort
    parameters: tuple[Parameter, ...] = ()
    states: tuple[SignalState, ...] = ()

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the element on the junction."""
        if not isinstance(graph.node(self.junction), Junction):
            raise StructureError(
                f"{self.junction!r} is not a junction.",
                (self.junction,),
                "Insert elements at a junction.",
            )
        pieces = Pieces.of(graph)
        pieces.hang(self.element, self.junction, graph.domain_at(self.junction))
        pieces.remember(self.states)
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        memory = " with memory" if self.states else ""
        return f"one {letter(self.element)}{memory} added at {self.junction}"

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
    """Give an element of the graph another law (or modulus), a source another value."""

    element: str
    law: sympy.Expr
    parameters: tuple[Parameter, ...] = ()
    states: tuple[SignalState, ...] = ()
    nested: bool = False

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the element's law replaced."""
        node, law = graph.node(self.element), canonical(self.law)
        changed: Node
        if isinstance(node, WithLaw):
            changed = replace(node, law=law)
        elif isinstance(node, Source) and node.value is not None:
            changed = replace(node, value=law)
        else:
            raise StructureError(
                f"{letter(node)} {self.element!r} has no constitutive relation.",
                (self.element,),
                "Replace the relation of an I, C, R, TF, GY or a source with a value.",
            )
        pieces = Pieces.of(graph)
        pieces.swap(self.element, changed)
        pieces.remember(self.states)
        return pieces.finished(self.parameters)

    def describe(self) -> str:
        """Return the edit in words."""
        return f"the law of {self.element} replaced by {self.law}"

    @property
    def subject(self) -> str:
        """The name of what it adds or changes."""
        return self.element
