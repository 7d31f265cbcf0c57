"""What changed between two versions of a graph, in sentences.

Compared by name, so that a change reads as the engineer made it ("one R added at
worm"); the order in which things were written is not a change.
"""

from collections.abc import Iterator, Mapping
from typing import TypeVar

from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Node,
    OneJunction,
    ZeroJunction,
    letter,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.graph import Bond, FinishedGraph, Measurement
from bondgraph.structure.parameters import Parameter

_Named = TypeVar("_Named", Node, Bond, Measurement, Parameter)


def describe_difference(before: FinishedGraph, after: FinishedGraph) -> tuple[str, ...]:
    """Return one sentence per change from one graph to another, empty if none.

    Parameters
    ----------
    before, after
        Two graphs whose common names mean the same places.
    """
    return (
        *_node_changes(before, after),
        *_bond_changes(before, after),
        *_port_changes(before, after),
        *_preference_changes(before, after),
        *_measurement_changes(before, after),
        *_parameter_changes(before, after),
    )


def _split(
    before: Mapping[str, _Named], after: Mapping[str, _Named]
) -> tuple[list[_Named], list[_Named], list[tuple[_Named, _Named]]]:
    """Return what went, what came, and what stayed with a difference."""
    gone = [item for name, item in before.items() if name not in after]
    new = [item for name, item in after.items() if name not in before]
    kept = [(item, after[name]) for name, item in before.items() if name in after]
    return gone, new, [(old, now) for old, now in kept if old != now]


def _where(graph: FinishedGraph, node: Node) -> str:
    """Return where a node is, in words."""
    partners = [bond.other(node.name) for bond in graph.bonds_at(node.name)]
    if isinstance(node, ZeroJunction | OneJunction):
        return f"called {node.name}"
    return (
        f"at {partners[0]}"
        if len(partners) == 1
        else "between " + " and ".join(partners)
    )


def _kind(node: Node) -> str:
    if isinstance(node, ZeroJunction | OneJunction):
        return f"{letter(node)}-junction"
    return letter(node)


def _law(node: Node) -> str:
    if isinstance(node, EffortSource | FlowSource):
        return "an input" if node.value is None else str(node.value)
    if isinstance(node, MultiPort):
        return str(node.laws)
    law = getattr(node, "law", None)
    return "linear" if law is None else str(law)


def _node_changes(before: FinishedGraph, after: FinishedGraph) -> Iterator[str]:
    gone, new, changed = _split(before.by_name, after.by_name)
    for node in gone:
        yield f"one {_kind(node)} removed {_where(before, node)}"
    for node in new:
        yield f"one {_kind(node)} added {_where(after, node)}"
    for old, now in changed:
        if type(old) is type(now):
            yield f"the law of {old.name} replaced: {_law(old)} before, {_law(now)} now"
        else:
            yield f"{old.name} turned from {_kind(old)} into {_kind(now)}"


def _bond_changes(before: FinishedGraph, after: FinishedGraph) -> Iterator[str]:
    """Yield changed bonds between nodes that both graphs have."""
    common = set(before.by_name) & set(after.by_name)
    old, new = (
        {
            bond: domain
            for bond, domain in zip(graph.bonds, graph.domains, strict=True)
            if {bond.tail, bond.head} <= common
        }
        for graph in (before, after)
    )
    turned = {b: Bond(b.head, b.tail) for b in old if b not in new}
    turned = {b: other for b, other in turned.items() if other in {*new} - {*old}}
    for bond, domain in old.items():
        if bond in turned:
            yield f"the half arrow of {bond.name} reversed"
        elif bond not in new:
            yield f"the bond {bond.name} removed"
        elif new[bond] != domain:
            yield f"the bond {bond.name} is of {new[bond].name}, before {domain.name}"
    for bond in new:
        if bond not in old and bond not in turned.values():
            yield f"the bond {bond.name} added"


def _port_changes(before: FinishedGraph, after: FinishedGraph) -> Iterator[str]:
    """Yield fields whose ports are the same bonds in another order."""
    for node in before.nodes:
        if not isinstance(node, MultiPort) or node.name not in after.by_name:
            continue
        old, new = (
            [bond.other(node.name) for bond in graph.bonds_at(node.name)]
            for graph in (before, after)
        )
        if old != new and sorted(old) == sorted(new):
            yield (
                f"the ports of {node.name} are at {', '.join(new)}, "
                f"before {', '.join(old)}"
            )


def _preference_changes(before: FinishedGraph, after: FinishedGraph) -> Iterator[str]:
    old, new = (
        {p.element: p.wanted.value for p in graph.preferences}
        for graph in (before, after)
    )
    for element in {**old, **new}:
        if old.get(element) != new.get(element):
            yield (
                f"the preferred causality of {element} is "
                f"{new.get(element, 'left open')}, "
                f"before {old.get(element, 'left open')}"
            )


def _measurement_changes(before: FinishedGraph, after: FinishedGraph) -> Iterator[str]:
    gone, new, changed = _split(
        {m.name: m for m in before.measurements},
        {m.name: m for m in after.measurements},
    )
    for one in gone:
        yield f"measurement {one.name} removed"
    for one in new:
        yield f"measurement {one.name} added: {one.expression} [{one.unit}]"
    for old, now in changed:
        yield (
            f"measurement {old.name} reads {now.expression} [{now.unit}], "
            f"before {old.expression} [{old.unit}]"
        )


def _parameter_changes(before: FinishedGraph, after: FinishedGraph) -> Iterator[str]:
    gone, new, changed = _split(dict(before.parameters), dict(after.parameters))
    for one in gone:
        yield f"parameter {one.name} removed"
    for one in new:
        yield f"parameter {one.name} added: {_value(one)}"
    for old, now in changed:
        if (old.value, old.unit) != (now.value, now.unit):
            yield f"parameter {old.name} from {_value(old)} to {_value(now)}"
        elif _knowledge(old) != _knowledge(now):
            yield f"what is known about parameter {old.name} changed"


def _value(parameter: Parameter) -> str:
    if parameter.value is None:
        return "no value"
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    return f"{parameter.value:.6g}{unit}"


def _knowledge(parameter: Parameter) -> tuple[object, ...]:
    return parameter.bounds, parameter.std, parameter.rounding, parameter.source
