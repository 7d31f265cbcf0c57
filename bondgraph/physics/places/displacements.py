"""Where a displacement is known, and from what: its origin must mean something.

A displacement that is only an integral has an origin of its own in every window, and
that explains too much. It is absolute where it is measured or a C holds it. From there
it is known as far as the structure carries it: through transformers with a constant
ratio, and across 0-junctions as the sum or the difference of what is known beside it.
A load behind a gear and a shaft that gives turns as its motor does, geared, less what
the shaft is wound up.
"""

from collections import deque
from collections.abc import Mapping
from functools import lru_cache

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
    return _displacements(_This(graph)).get(junction) or None


class _This:
    """A graph as a key: itself and no equal one, which would take long to compare."""

    def __init__(self, graph: FinishedGraph) -> None:
        self.graph = graph

    def __hash__(self) -> int:
        return id(self.graph)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _This) and other.graph is self.graph


@lru_cache(maxsize=16)
def _displacements(this: _This) -> dict[str, Parts]:
    """Return all displacements that are known, told by the nearest absolute ones."""
    graph = this.graph
    junctions = [one.name for one in graph.junctions if isinstance(one, OneJunction)]
    absolute = [name for name in junctions if _is_absolute(graph, name)]
    told: dict[Bond, Parts] = {}
    for name in absolute:
        for bond in graph.bonds_at(name):
            told.setdefault(bond, {name: sympy.S.One})
    reached = deque(told)
    while reached:
        bond = reached.popleft()
        for end in (bond.tail, bond.head):
            for further, parts in _beyond(graph, bond, end, told).items():
                told[further] = parts
                reached.append(further)
    by_bond = {
        name: told[bond]
        for name in junctions
        for bond in graph.bonds_at(name)[:1]
        if bond in told
    }
    return by_bond | {name: {name: sympy.S.One} for name in absolute}


def _is_absolute(graph: FinishedGraph, junction: str) -> bool:
    own = displacement(junction)
    if any(m.expression.has(own) for m in graph.measurements):
        return True
    neighbours = (graph.node(b.other(junction)) for b in graph.bonds_at(junction))
    return any(isinstance(node, Compliance) for node in neighbours)


def _beyond(
    graph: FinishedGraph, bond: Bond, end: str, told: Mapping[Bond, Parts]
) -> dict[Bond, Parts]:
    """Return the bonds at one end of a bond that it now tells, too."""
    unknown = [one for one in graph.bonds_at(end) if one not in told]
    match graph.node(end):
        case OneJunction():
            return dict.fromkeys(unknown, told[bond])
        case ZeroJunction() if len(unknown) == 1:
            return {unknown[0]: _by_balance(graph, unknown[0], end, told)}
        case Transformer() as gear if unknown and not signals_in(gear.modulus):
            (other,) = unknown
            # Where power is not counted through it, it is no plain ratio.
            if (other.head == end) != (bond.head == end):
                ratio = gear.modulus if other.head == end else 1 / gear.modulus
                return {other: {n: ratio * k for n, k in told[bond].items()}}
    return {}


def _by_balance(
    graph: FinishedGraph, own: Bond, zero: str, told: Mapping[Bond, Parts]
) -> Parts:
    """Return the flow of a bond by the balance of a 0-junction."""
    total: dict[str, sympy.Expr] = {}
    for bond in graph.bonds_at(zero):
        if bond != own:
            along = (bond.head == zero) == (own.head == zero)
            for name, factor in told[bond].items():
                share = -factor if along else factor
                total[name] = total.get(name, sympy.S.Zero) + share
    return {name: factor for name, factor in total.items() if factor != 0}
