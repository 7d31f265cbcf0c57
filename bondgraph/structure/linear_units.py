"""The unit that a linear element's one parameter has in its energy domain."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bondgraph.structure.domains import THERMAL, EnergyDomain, Quantity
from bondgraph.structure.elements import (
    Compliance,
    Gyrator,
    Inertance,
    Node,
    Resistance,
    Transformer,
)
from bondgraph.structure.nodes import is_linear, port_count

if TYPE_CHECKING:
    from bondgraph.structure.graph import Bond

_PER = {
    Resistance: (Quantity.EFFORT, Quantity.FLOW),
    Inertance: (Quantity.MOMENTUM, Quantity.FLOW),
    Compliance: (Quantity.DISPLACEMENT, Quantity.EFFORT),
    Transformer: (Quantity.EFFORT, Quantity.EFFORT),
    Gyrator: (Quantity.EFFORT, Quantity.FLOW),
}


def linear_unit(
    node: Node, bonds: "tuple[Bond, ...]", domains: tuple[EnergyDomain, ...]
) -> tuple[str, str] | None:
    """Return the unit of a linear element's parameter, and what it is in words.

    None where the element has a law of its own or its domain's units are not checked
    (analogue), or where the power of both sides differs (thermal pseudo bonds).
    """
    if not is_linear(node) or not all(domain.checked for domain in domains):
        return None
    above, below = _PER[type(node)]
    to, of = domains[0], domains[0]
    if isinstance(node, Transformer | Gyrator):
        # Port b, where power leaves, is the bond whose tail the two-port is.
        leaving = 0 if bonds[0].tail == node.name and bonds[1].head == node.name else 1
        to, of = domains[leaving], domains[1 - leaving]
        if to is not of and THERMAL in (to, of):
            return None
        if to is of and isinstance(node, Transformer):
            return "1", "effort per effort"
    words = f"{to.word(above)} per {of.word(below)}"
    return f"({to.unit(above)})/({of.unit(below)})", words


def linear_units(
    nodes: Sequence[Node],
    bonds: "Sequence[Bond]",
    domains: Sequence[EnergyDomain],
) -> dict[str, str]:
    """Return the unit of each linear element's parameter, where it is known."""
    at: dict[str, list[int]] = {}
    for i, bond in enumerate(bonds):
        at.setdefault(bond.tail, []).append(i)
        at.setdefault(bond.head, []).append(i)
    units: dict[str, str] = {}
    for node in nodes:
        own = at.get(node.name, [])
        if len(own) != port_count(node):
            continue  # dangling, which is refused elsewhere
        found = linear_unit(
            node, tuple(bonds[i] for i in own), tuple(domains[i] for i in own)
        )
        if found is not None:
            units[node.name] = found[0]
    return units
