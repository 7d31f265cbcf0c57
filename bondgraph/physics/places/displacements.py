"""Where a displacement is known, and from what: its origin must mean something.

A displacement that is only an integral has an origin of its own in every window, and
that explains too much. It is absolute where it is measured or a C holds it. From there
it is known as far as the structure carries it: through transformers with a constant
ratio, and across 0-junctions as the sum or the difference of what is known beside it.
A load behind a gear and a shaft that gives turns as its motor does, geared, less what
the shaft is wound up.
"""

from collections.abc import Mapping, Set

import sympy

from bondgraph.structure.elements import (
    Compliance,
    OneJunction,
    Transformer,
    ZeroJunction,
)
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.signals import displacement, signals_in

Parts = Mapping[str, sympy.Expr]
"""1-junctions whose displacements are added, each with its factor."""


def known_displacement(graph: FinishedGraph, junction: str) -> Parts | None:
    """Return what the displacement at a 1-junction is made of; None where unknown.

    Factors are signs, and the ratios of the transformers between; where it is absolute
    it is its own displacement.
    """
    return _known(graph, junction, frozenset())


def _known(graph: FinishedGraph, junction: str, passed: Set[str]) -> Parts | None:
    if _is_absolute(graph, junction):
        return {junction: sympy.S.One}
    for bond in graph.bonds_at(junction):
        found = _beyond(graph, bond, junction, passed)
        if found is not None:
            return found
    return None


def _is_absolute(graph: FinishedGraph, junction: str) -> bool:
    own = displacement(junction)
    if any(m.expression.has(own) for m in graph.measurements):
        return True
    neighbours = (graph.node(b.other(junction)) for b in graph.bonds_at(junction))
    return any(isinstance(node, Compliance) for node in neighbours)


def _beyond(
    graph: FinishedGraph, bond: Bond, here: str, passed: Set[str]
) -> Parts | None:
    """Return the displacement of a bond, told by what is at its other end."""
    there = bond.other(here)
    if there in passed:
        return None
    passed = passed | {here}
    match graph.node(there):
        case OneJunction():
            return _known(graph, there, passed)
        case ZeroJunction():
            return _by_balance(graph, bond, there, passed)
        case Transformer() as gear if not signals_in(gear.modulus):
            return _geared(graph, bond, gear, passed)
    return None


def _by_balance(
    graph: FinishedGraph, own: Bond, zero: str, passed: Set[str]
) -> Parts | None:
    """Return the flow of a bond by the balance of the 0-junction at its end."""
    total: dict[str, sympy.Expr] = {}
    for bond in graph.bonds_at(zero):
        if bond == own:
            continue
        found = _beyond(graph, bond, zero, passed)
        if found is None:
            return None
        along = (bond.head == zero) == (own.head == zero)
        for name, factor in found.items():
            total[name] = total.get(name, sympy.S.Zero) + (-factor if along else factor)
    return {name: factor for name, factor in total.items() if factor != 0} or None


def _geared(
    graph: FinishedGraph, own: Bond, gear: Transformer, passed: Set[str]
) -> Parts | None:
    """Return the flow of a bond by the transformer at its end: ``f_a = K f_b``."""
    (other,) = (bond for bond in graph.bonds_at(gear.name) if bond != own)
    if (own.head == gear.name) == (other.head == gear.name):
        return None  # not the way power is counted through it
    found = _beyond(graph, other, gear.name, passed)
    if found is None:
        return None
    ratio = gear.modulus if own.head == gear.name else 1 / gear.modulus
    return {name: ratio * factor for name, factor in found.items()}
