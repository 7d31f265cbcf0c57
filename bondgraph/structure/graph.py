"""The finished graph: nodes, bonds, measurements and parameters, checked and frozen.

A `FinishedGraph` is valid by construction and never modified; edits return new ones.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import sympy

from bondgraph.errors import ParameterError, StructureError, UnitError, did_you_mean
from bondgraph.structure.domains import EnergyDomain, Quantity
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    Element,
    FlowSource,
    Gyrator,
    Inertance,
    Junction,
    Node,
    OneJunction,
    OnePort,
    Resistance,
    Transformer,
    ZeroJunction,
    letter,
)
from bondgraph.structure.parameters import Parameter, ParameterSet
from bondgraph.structure.signals import Signal, parameters_in, signals_in
from bondgraph.structure.units import compatible


@dataclass(frozen=True, slots=True)
class Bond:
    """A power bond; power is positive from `tail` to `head` (both node names)."""

    tail: str
    head: str

    @property
    def name(self) -> str:
        """The bond's name, ``tail>head``."""
        return f"{self.tail}>{self.head}"

    def other(self, node: str) -> str:
        """Return the node at the other end."""
        return self.head if node == self.tail else self.tail


@dataclass(frozen=True, slots=True)
class Measurement:
    """An output channel: an expression of signals and parameters."""

    name: str
    expression: sympy.Expr
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FinishedGraph:
    """A bond graph whose structure has been checked.

    Parameters
    ----------
    name
        What the machine is called.
    nodes, bonds
        Junctions and elements, and the bonds between them, in the author's order.
    domains
        The energy domain of every bond, in the order of `bonds`.
    measurements
        The outputs.
    parameters
        One entry per parameter that a law uses; its value may be missing.
    """

    name: str
    nodes: tuple[Node, ...]
    bonds: tuple[Bond, ...]
    domains: tuple[EnergyDomain, ...]
    measurements: tuple[Measurement, ...] = ()
    parameters: ParameterSet = field(default_factory=ParameterSet)

    def __post_init__(self) -> None:
        _check_names(self.nodes)
        _check_bonds(self)
        _check_signals(self)
        _check_parameters(self)

    @property
    def by_name(self) -> dict[str, Node]:
        """The nodes by name."""
        return {node.name: node for node in self.nodes}

    def node(self, name: str) -> Node:
        """Return the node called `name`, or refuse naming the closest ones."""
        for node in self.nodes:
            if node.name == name:
                return node
        raise StructureError(
            f"There is no junction or element {name!r} in {self.name!r}.",
            (name,),
            did_you_mean(name, (n.name for n in self.nodes)),
        )

    def bonds_at(self, name: str) -> tuple[Bond, ...]:
        """Return the bonds at a node, in the author's order."""
        return tuple(b for b in self.bonds if name in (b.tail, b.head))

    def domain_at(self, name: str) -> EnergyDomain:
        """Return the domain of a junction or one-port (of its first bond)."""
        for bond, domain in zip(self.bonds, self.domains, strict=True):
            if name in (bond.tail, bond.head, bond.name):
                return domain
        raise StructureError(f"{name!r} has no bond.", (name,), "Connect it.")

    @property
    def junctions(self) -> tuple[Junction, ...]:
        """The junctions, in the author's order."""
        return tuple(n for n in self.nodes if isinstance(n, ZeroJunction | OneJunction))

    @property
    def elements(self) -> tuple[Element, ...]:
        """The one- and two-ports, in the author's order."""
        return tuple(
            n for n in self.nodes if not isinstance(n, ZeroJunction | OneJunction)
        )

    @property
    def inputs(self) -> tuple[EffortSource | FlowSource, ...]:
        """The sources that a recording or a controller drives."""
        return tuple(
            n
            for n in self.nodes
            if isinstance(n, EffortSource | FlowSource) and n.value is None
        )

    def input_unit(self, name: str) -> str:
        """Return the SI unit of the input called `name`."""
        source = self.node(name)
        quantity = (
            Quantity.EFFORT if isinstance(source, EffortSource) else Quantity.FLOW
        )
        return self.domain_at(name).unit(quantity)

    def with_parameters(
        self, parameters: Mapping[str, float] | Iterable[Parameter]
    ) -> "FinishedGraph":
        """Return the graph with other parameter values.

        Parameters
        ----------
        parameters
            New values by name, or whole parameters; each must be one of this graph.
        """
        if isinstance(parameters, ParameterSet) or not isinstance(parameters, Mapping):
            new = tuple(
                parameters.members
                if isinstance(parameters, ParameterSet)
                else parameters
            )
            for parameter in new:
                self.parameters.find(parameter.name)
            return self._with(self.parameters.merged(new))
        return self._with(self.parameters.with_values(parameters))

    def _with(self, parameters: ParameterSet) -> "FinishedGraph":
        return FinishedGraph(
            name=self.name,
            nodes=self.nodes,
            bonds=self.bonds,
            domains=self.domains,
            measurements=self.measurements,
            parameters=parameters,
        )

    def finish(self) -> "FinishedGraph":
        """Return the graph itself (it is finished)."""
        return self


def laws_of(node: Node) -> tuple[sympy.Expr, ...]:
    """Return the expressions that define `node`."""
    match node:
        case EffortSource() | FlowSource():
            return () if node.value is None else (node.value,)
        case Inertance() | Compliance() | Resistance():
            return (node.relation.expression,)
        case Transformer() | Gyrator():
            return (node.modulus,)
        case ZeroJunction() | OneJunction():
            return ()


def _check_names(nodes: tuple[Node, ...]) -> None:
    if not nodes:
        raise StructureError(
            "The graph is empty.", (), "Add a junction with one(...) or zero(...)."
        )
    for name, count in Counter(node.name for node in nodes).items():
        if count > 1:
            kinds = " and ".join(letter(n) for n in nodes if n.name == name)
            raise StructureError(
                f"The name {name!r} is used {count} times ({kinds}).",
                (name,),
                "Give every junction and element a name of its own.",
            )


def _check_bonds(graph: FinishedGraph) -> None:
    nodes = graph.by_name
    ports: defaultdict[str, int] = defaultdict(int)
    for bond in graph.bonds:
        for end in (bond.tail, bond.head):
            if end not in nodes:
                raise StructureError(
                    f"The bond {bond.name!r} dangles: there is no {end!r}.",
                    (bond.name, end),
                    did_you_mean(end, nodes),
                )
            ports[end] += 1
        if bond.tail == bond.head:
            raise StructureError(
                f"The bond {bond.name!r} joins {bond.tail!r} to itself.",
                (bond.name,),
                "Join two different junctions.",
            )
    for node in graph.nodes:
        _check_port_count(node, ports[node.name])


def _check_port_count(node: Node, count: int) -> None:
    match node:
        case ZeroJunction() | OneJunction():
            if count == 0:
                raise StructureError(
                    f"The {letter(node)}-junction {node.name!r} has no bond.",
                    (node.name,),
                    "Put an element on it or join it.",
                )
        case Transformer() | Gyrator():
            if count != 2:
                raise StructureError(
                    f"{letter(node)} {node.name!r} dangles: it has {count} of 2 bonds.",
                    (node.name,),
                    "Join it between two junctions.",
                )
        case _:
            if count != 1:
                raise StructureError(
                    f"{letter(node)} {node.name!r} has {count} bonds and needs 1.",
                    (node.name,),
                    "Put it on exactly one junction.",
                )


def _check_signals(graph: FinishedGraph) -> None:
    places = set(graph.by_name) | {bond.name for bond in graph.bonds}
    expressions = [
        (node.name, law) for node in graph.nodes for law in laws_of(node)
    ] + [(m.name, m.expression) for m in graph.measurements]
    for owner, expression in expressions:
        for signal in signals_in(expression):
            if signal.place not in places:
                raise StructureError(
                    f"{owner!r} reads {signal}, and there is no such place.",
                    (owner, signal.place),
                    did_you_mean(signal.place, places),
                )
            _check_signal_is_common(graph, owner, signal)


def _check_signal_is_common(graph: FinishedGraph, owner: str, signal: Signal) -> None:
    """Refuse a signal that its junction does not have in common."""
    node = graph.by_name.get(signal.place)
    if isinstance(node, Transformer | Gyrator):
        names = ", ".join(repr(b.name) for b in graph.bonds_at(node.name))
        raise StructureError(
            f"{owner!r} reads {signal}, but {node.name!r} has two ports.",
            (owner, node.name),
            f"Name the bond instead: {names}.",
        )
    flows = (Quantity.FLOW, Quantity.DISPLACEMENT)
    efforts = (Quantity.EFFORT, Quantity.MOMENTUM)
    if isinstance(node, OneJunction) and signal.quantity in efforts:
        common, kind = "flow", "1"
    elif isinstance(node, ZeroJunction) and signal.quantity in flows:
        common, kind = "effort", "0"
    else:
        return
    names = ", ".join(repr(b.name) for b in graph.bonds_at(signal.place))
    raise StructureError(
        f"{owner!r} reads {signal}, but the {kind}-junction {signal.place!r} has only "
        f"its {common} in common.",
        (owner, signal.place),
        f"Read it at a bond: {names}.",
    )


def _check_parameters(graph: FinishedGraph) -> None:
    used = set(used_parameters(graph.nodes, graph.measurements))
    for parameter in graph.parameters.members:
        if parameter.name not in used:
            raise ParameterError(
                f"No law of {graph.name!r} uses the parameter {parameter.name!r}.",
                (parameter.name,),
                did_you_mean(parameter.name, used),
            )
    for name in used - set(graph.parameters):
        raise ParameterError(
            f"The parameter {name!r} of {graph.name!r} is not declared.",
            (name,),
            "Declare it with parameter(name, value, unit).",
        )
    for node in graph.nodes:
        _check_linear_unit(graph, node)


def used_parameters(
    nodes: Iterable[Node], measurements: Iterable[Measurement]
) -> tuple[str, ...]:
    """Return the names of all parameters that laws and measurements use, in order."""
    names: dict[str, None] = {}
    for node in nodes:
        for law in laws_of(node):
            names.update(dict.fromkeys(parameters_in(law)))
    for measurement in measurements:
        names.update(dict.fromkeys(parameters_in(measurement.expression)))
    return tuple(names)


_LINEAR_UNITS = {
    Resistance: (Quantity.EFFORT, Quantity.FLOW),
    Inertance: (Quantity.MOMENTUM, Quantity.FLOW),
    Compliance: (Quantity.DISPLACEMENT, Quantity.EFFORT),
}


def _check_linear_unit(graph: FinishedGraph, node: Node) -> None:
    """Check that a linear one-port's parameter has the unit its domain gives."""
    if not isinstance(node, Resistance | Inertance | Compliance) or node.law:
        return
    domain = graph.domain_at(node.name)
    parameter = graph.parameters[node.name]
    if not domain.checked or parameter.value is None:
        return
    above, below = _LINEAR_UNITS[type(node)]
    unit = f"({domain.unit(above)})/({domain.unit(below)})"
    if not compatible(parameter.unit, unit):
        raise UnitError(
            f"{letter(node)} {node.name!r} is in {parameter.unit!r}, which is not a "
            f"unit of {domain.word(above)} per {domain.word(below)} ({unit}).",
            (node.name,),
            f"Give it in {unit} or a unit that converts to it.",
        )


def is_one_port(node: Node) -> bool:
    """Return whether `node` has exactly one port."""
    return isinstance(
        node, EffortSource | FlowSource | Inertance | Compliance | Resistance
    )


__all__ = [
    "Bond",
    "FinishedGraph",
    "Measurement",
    "OnePort",
    "is_one_port",
    "laws_of",
    "used_parameters",
]
