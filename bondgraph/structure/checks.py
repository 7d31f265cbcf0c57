"""What is checked when a graph is made, each refusal with the names and the way out."""

from collections import Counter
from typing import TYPE_CHECKING

import sympy

from bondgraph.errors import ParameterError, StructureError, UnitError, did_you_mean
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import (
    Gyrator,
    Junction,
    Node,
    OneJunction,
    Resistance,
    Storage,
    Transformer,
    ZeroJunction,
    letter,
)
from bondgraph.structure.fields import MultiPort, ResistanceField, StorageField
from bondgraph.structure.linear_units import linear_unit
from bondgraph.structure.nodes import (
    is_linear,
    parameters_of,
    port_count,
    written_laws,
)
from bondgraph.structure.signals import Signal, parameters_in, signals_in
from bondgraph.structure.units import compatible

if TYPE_CHECKING:
    from bondgraph.structure.graph import FinishedGraph

_NOT_REAL = (sympy.I, sympy.nan, sympy.zoo)
_FLOWS = (Quantity.FLOW, Quantity.DISPLACEMENT)
_EFFORTS = (Quantity.EFFORT, Quantity.MOMENTUM)


def check_graph(graph: "FinishedGraph") -> None:
    """Raise StructureError, ParameterError or UnitError if `graph` is not right."""
    _check_names(graph)
    _check_bonds(graph)
    _check_domains(graph)
    _check_laws(graph)
    _check_signals(graph)
    _check_parameters(graph)
    _check_preferences(graph)


def _check_names(graph: "FinishedGraph") -> None:
    if not graph.nodes:
        raise StructureError(
            "The graph is empty.", (), "Add a junction with one(...) or zero(...)."
        )
    if len(graph.by_name) == len(graph.nodes):
        return
    for name, count in Counter(node.name for node in graph.nodes).items():
        if count > 1:
            kinds = " and ".join(letter(n) for n in graph.nodes if n.name == name)
            raise StructureError(
                f"The name {name!r} is used {count} times ({kinds}).",
                (name,),
                "Give every junction and element a name of its own.",
            )


def _check_bonds(graph: "FinishedGraph") -> None:
    nodes = graph.by_name
    for bond in graph.bonds:
        for end in (bond.tail, bond.head):
            if end not in nodes:
                raise StructureError(
                    f"The bond {bond.name!r} dangles: there is no {end!r}.",
                    (bond.name, end),
                    did_you_mean(end, nodes),
                )
        if bond.tail == bond.head:
            raise StructureError(
                f"The bond {bond.name!r} joins {bond.tail!r} to itself.",
                (bond.name,),
                "Join two different junctions.",
            )
    for node in graph.nodes:
        _check_port_count(node, len(graph.bonds_at(node.name)))
    for name, count in Counter(bond.name for bond in graph.bonds).items():
        if count > 1:
            raise StructureError(
                f"There are {count} bonds {name!r}.",
                (name,),
                "Put a junction into all but one of them, so that each has a name.",
            )


def _check_port_count(node: Node, count: int) -> None:
    wanted = port_count(node)
    if wanted is None:
        if count == 0:
            raise StructureError(
                f"The {letter(node)}-junction {node.name!r} has no bond.",
                (node.name,),
                "Put an element on it or join it.",
            )
    elif isinstance(node, Transformer | Gyrator) and count != wanted:
        raise StructureError(
            f"{letter(node)} {node.name!r} dangles: it has {count} of 2 bonds.",
            (node.name,),
            "Join it between two junctions.",
        )
    elif count != wanted:
        where = "exactly one junction" if wanted == 1 else f"{wanted} junctions"
        raise StructureError(
            f"{letter(node)} {node.name!r} has {count} bonds and needs {wanted}.",
            (node.name,),
            f"Put it on {where}.",
        )


def _check_domains(graph: "FinishedGraph") -> None:
    """Refuse a junction whose bonds belong to different energy domains."""
    for node in graph.nodes:
        if not isinstance(node, Junction):
            continue
        domains = graph.domains_at(node.name)
        if len(set(map(id, domains))) == 1:
            continue
        pairs = zip(graph.bonds_at(node.name), domains, strict=True)
        checked = {domain.name: bond for bond, domain in pairs if domain.checked}
        if len(checked) > 1:
            (one, first), (other, second), *_ = checked.items()
            raise UnitError(
                f"The junction {node.name!r} joins bonds of two energy domains: "
                f"{first.name!r} ({one}) and {second.name!r} ({other}).",
                (node.name, first.name, second.name),
                "Put a TF or GY between them.",
            )


def _check_laws(graph: "FinishedGraph") -> None:
    """Refuse laws that are no real numbers, and two-ports that let nothing through."""
    for node in graph.nodes:
        for law in written_laws(node):
            _check_real(law, f"The law of {letter(node)} {node.name!r}", node.name)
            if isinstance(node, Transformer | Gyrator) and law.is_zero:
                raise StructureError(
                    f"The modulus of {letter(node)} {node.name!r} is zero.",
                    (node.name,),
                    "Leave the two-port out, or give it a modulus.",
                )
    for measurement in graph.measurements:
        name = measurement.name
        _check_real(measurement.expression, f"The measurement {name!r}", name)


def _check_real(expression: sympy.Expr, what: str, name: str) -> None:
    if expression.has(*_NOT_REAL):
        raise StructureError(
            f"{what} is {expression}, which is no real number.",
            (name,),
            "Write it so that real numbers give real numbers.",
        )


def _check_signals(graph: "FinishedGraph") -> None:
    for node in graph.nodes:
        for law in written_laws(node):
            for signal in signals_in(law):
                _check_signal(graph, node.name, signal)
    driven = {source.name for source in graph.inputs}
    for measurement in graph.measurements:
        if measurement.name in driven:
            raise StructureError(
                f"{measurement.name!r} is an input and a measurement.",
                (measurement.name,),
                "Give one of them another name: a recording has one channel of a name.",
            )
        for signal in signals_in(measurement.expression):
            _check_signal(graph, measurement.name, signal)


def _check_signal(graph: "FinishedGraph", owner: str, signal: Signal) -> None:
    """Refuse a signal of no place, or that its place does not have as one."""
    if not graph.has_place(signal.place):
        places = [*graph.by_name, *(bond.name for bond in graph.bonds)]
        raise StructureError(
            f"{owner!r} reads {signal}, and there is no such place.",
            (owner, signal.place),
            did_you_mean(signal.place, places),
        )
    node = graph.by_name.get(signal.place)
    names = ", ".join(repr(b.name) for b in graph.bonds_at(signal.place))
    if isinstance(node, Transformer | Gyrator | MultiPort):
        count = "two" if isinstance(node, Transformer | Gyrator) else str(node.size)
        raise StructureError(
            f"{owner!r} reads {signal}, but {node.name!r} has {count} ports.",
            (owner, node.name),
            f"Name the bond instead: {names}.",
        )
    other: type[Node]
    if isinstance(node, OneJunction) and signal.quantity in _EFFORTS:
        common, kind, other = "flow", "1", ZeroJunction
    elif isinstance(node, ZeroJunction) and signal.quantity in _FLOWS:
        common, kind, other = "effort", "0", OneJunction
    else:
        return
    beyond = (bond.other(signal.place) for bond in graph.bonds_at(signal.place))
    beside = [repr(name) for name in beyond if isinstance(graph.node(name), other)]
    also = f", or at {' or '.join(beside)} beside it" if beside else ""
    raise StructureError(
        f"{owner!r} reads {signal}, but the {kind}-junction {signal.place!r} has only "
        f"its {common} in common.",
        (owner, signal.place),
        f"Read it at a bond: {names}{also}.",
    )


def _check_parameters(graph: "FinishedGraph") -> None:
    used: dict[str, None] = {}
    for node in graph.nodes:
        used.update(dict.fromkeys(parameters_of(node)))
    for measurement in graph.measurements:
        used.update(dict.fromkeys(parameters_in(measurement.expression)))
    for parameter in graph.parameters.members:
        if parameter.name not in used:
            raise ParameterError(
                f"No law of {graph.name!r} uses the parameter {parameter.name!r}.",
                (parameter.name,),
                did_you_mean(parameter.name, used),
            )
    for name in used:
        if name not in graph.parameters:
            raise ParameterError(
                f"The parameter {name!r} of {graph.name!r} is not declared.",
                (name,),
                "Declare it with parameter(name, value, unit).",
            )
    for node in graph.nodes:
        if not is_linear(node):
            continue
        bonds = graph.bonds_at(node.name)
        wanted = linear_unit(node, bonds, graph.domains_at(node.name))
        if wanted is not None:
            _check_unit(graph, node, *wanted)


def _check_unit(graph: "FinishedGraph", node: Node, unit: str, words: str) -> None:
    """Check that a linear element's parameter has the unit its domain gives."""
    parameter = graph.parameters[node.name]
    if parameter.value is not None and not compatible(parameter.unit, unit):
        raise UnitError(
            f"{letter(node)} {node.name!r} is in {parameter.unit!r}, which is not a "
            f"unit of {words} ({unit}).",
            (node.name,),
            f"Give it in {unit} or a unit that converts to it.",
        )


def _check_preferences(graph: "FinishedGraph") -> None:
    ports = {node.name: node for node in graph.nodes}
    for node in graph.nodes:
        if isinstance(node, MultiPort):
            ports.update((node.port(i + 1), node) for i in range(node.size))
    for preference in graph.preferences:
        found = ports.get(preference.element)
        if isinstance(found, Storage | StorageField):
            allowed = ("integral", "derivative")
        elif isinstance(found, Resistance | ResistanceField):
            allowed = ("effort", "flow")
        else:
            raise StructureError(
                f"{preference.element!r} has no causality to prefer.",
                (preference.element,),
                did_you_mean(preference.element, ports),
            )
        if preference.wanted.value not in allowed:
            raise StructureError(
                f"{preference.element!r} cannot prefer {preference.wanted.value!r}.",
                (preference.element,),
                f"Prefer {' or '.join(allowed)}.",
            )
