"""What any node of a graph is asked: its ports, its laws, its parameters."""

from collections.abc import Iterable
from typing import TypeGuard

import sympy

from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Gyrator,
    Inertance,
    Junction,
    Node,
    Resistance,
    Transformer,
    is_one_port,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.signals import parameters_in, signals_in


def port_count(node: Node) -> int | None:
    """Return how many bonds `node` needs; None for a junction."""
    if isinstance(node, Junction):
        return None
    if isinstance(node, MultiPort):
        return node.size
    return 1 if is_one_port(node) else 2


def written_laws(node: Node) -> tuple[sympy.Expr, ...]:
    """Return the laws that the author wrote; none for a linear element or an input."""
    match node:
        case EffortSource() | FlowSource():
            return () if node.value is None else (node.value,)
        case Inertance() | Compliance() | Resistance() | Transformer() | Gyrator():
            return () if node.law is None else (node.law,)
    return node.laws if isinstance(node, MultiPort) else ()


def laws_of(node: Node) -> tuple[sympy.Expr, ...]:
    """Return the expressions that define `node`, also where they are understood."""
    match node:
        case Inertance() | Compliance() | Resistance():
            return (node.relation.expression,)
        case Transformer() | Gyrator():
            return (node.modulus,)
    return written_laws(node)


WithLaw = Inertance | Compliance | Resistance | Transformer | Gyrator


def is_linear(node: Node) -> TypeGuard[WithLaw]:
    """Return whether `node` is linear with one parameter that has its name."""
    return isinstance(node, WithLaw) and node.law is None


def parameters_of(node: Node) -> tuple[str, ...]:
    """Return the names of the parameters that define `node`."""
    if is_linear(node):
        return (node.name,)
    return tuple(name for law in written_laws(node) for name in parameters_in(law))


def modulations(nodes: Iterable[Node]) -> tuple[tuple[str, str], ...]:
    """Return ``(place read, element that reads it)`` for every modulated element."""
    found: dict[tuple[str, str], None] = {}
    for node in nodes:
        for law in written_laws(node):
            for signal in signals_in(law):
                found[signal.place, node.name] = None
    return tuple(found)
