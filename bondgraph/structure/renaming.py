"""Other names for the same graph: places and parameters renamed wherever they occur."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import sympy

from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Junction,
    Node,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.graph import Bond
from bondgraph.structure.nodes import WithLaw, is_linear
from bondgraph.structure.signals import (
    Signal,
    f,
    p,
    parameter_symbol,
    parameters_in,
    q,
    signals_in,
)


@dataclass(frozen=True, slots=True)
class Renaming:
    """New names of `places` (nodes) and `parameters`; others keep theirs."""

    places: Mapping[str, str]
    parameters: Mapping[str, str] = field(default_factory=dict)

    def place(self, name: str) -> str:
        """Return the new name of a node, a bond (``a>b``) or a field's port."""
        if ">" in name and name not in self.places:
            tail, head = name.split(">", 1)
            return f"{self.place(tail)}>{self.place(head)}"
        return self.places.get(name, name)

    def parameter(self, name: str) -> str:
        """Return the new name of a parameter."""
        return self.parameters.get(name, name)

    def bond(self, bond: Bond) -> Bond:
        """Return the bond between the renamed nodes."""
        return Bond(self.place(bond.tail), self.place(bond.head))

    def expression(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with its signals and parameters renamed."""
        new: dict[sympy.Symbol, sympy.Symbol] = {
            signal: Signal(signal.quantity, self.place(signal.place))
            for signal in signals_in(expression)
        }
        new.update(
            (parameter_symbol(name), parameter_symbol(self.parameter(name)))
            for name in parameters_in(expression)
        )
        return expression.xreplace(new)

    def node(self, node: Node) -> Node:
        """Return the node with its new name and its laws renamed.

        A linear element whose parameter does not follow its name gets its law written.
        """
        name = self.place(node.name)
        if isinstance(node, Junction):
            return replace(node, name=name)
        if isinstance(node, EffortSource | FlowSource):
            value = node.value
            renamed = None if value is None else self.expression(value)
            return replace(node, name=name, value=renamed)
        if isinstance(node, MultiPort):
            laws = tuple(self.expression(law) for law in node.laws)
            return replace(node, name=name, laws=laws)
        if is_linear(node):
            constant = self.parameter(node.name)
            if constant == name:
                return replace(node, name=name)
            law = _linear_law(node, parameter_symbol(constant))
            return replace(node, name=name, law=law)
        assert isinstance(node, WithLaw)
        assert node.law is not None
        return replace(node, name=name, law=self.expression(node.law))


def _linear_law(node: Node, constant: sympy.Symbol) -> sympy.Expr:
    """Return the law that a linear element understands, with its constant."""
    usual = {"I": p / constant, "C": q / constant, "R": constant * f}
    return usual.get(node.letter, constant)
