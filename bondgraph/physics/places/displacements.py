"""Where a displacement is known, and from what: its origin must mean something.

A displacement that is only an integral has an origin of its own in every window, and
that explains too much. It is absolute where it is measured or a C holds it, and where a
0-junction gives it as the sum or the difference of absolute ones: between two bodies
whose positions are known.
"""

from collections.abc import Mapping

from bondgraph.structure.elements import Compliance, OneJunction, ZeroJunction
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.signals import displacement


def known_displacement(graph: FinishedGraph, junction: str) -> Mapping[str, int] | None:
    """Return what the displacement at a 1-junction is made of; None where unknown.

    The 1-junctions whose displacements it adds, each with its sign (1 or -1); itself
    where it is absolute.
    """
    if _is_absolute(graph, junction):
        return {junction: 1}
    for bond in graph.bonds_at(junction):
        middle = graph.node(bond.other(junction))
        if isinstance(middle, ZeroJunction):
            found = _by_balance(graph, bond, middle.name)
            if found is not None:
                return found
    return None


def _is_absolute(graph: FinishedGraph, junction: str) -> bool:
    own = displacement(junction)
    if any(m.expression.has(own) for m in graph.measurements):
        return True
    neighbours = (graph.node(b.other(junction)) for b in graph.bonds_at(junction))
    return any(isinstance(node, Compliance) for node in neighbours)


def _by_balance(graph: FinishedGraph, own: Bond, zero: str) -> Mapping[str, int] | None:
    """Return the flow of a bond by the balance of the 0-junction at its end."""
    found: dict[str, int] = {}
    for bond in graph.bonds_at(zero):
        if bond == own:
            continue
        other = bond.other(zero)
        plain = isinstance(graph.node(other), OneJunction)
        if not plain or other in found or not _is_absolute(graph, other):
            return None
        along = (bond.head == zero) == (own.head == zero)
        found[other] = -1 if along else 1
    return found or None
