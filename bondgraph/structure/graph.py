"""The finished graph: nodes, bonds, measurements and parameters, checked and frozen.

A `FinishedGraph` is valid by construction and never modified; edits return new ones.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import sympy

from bondgraph.errors import StructureError, did_you_mean
from bondgraph.structure.checks import check_graph
from bondgraph.structure.domains import EnergyDomain, Quantity
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Junction,
    Node,
    is_one_port,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.nodes import laws_of, parameters_of
from bondgraph.structure.parameters import Parameter, ParameterSet
from bondgraph.structure.signals import parameters_in


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


class Wanted(StrEnum):
    """What the author wants of an element's causality."""

    INTEGRAL = "integral"
    DERIVATIVE = "derivative"
    GIVES_EFFORT = "effort"
    GIVES_FLOW = "flow"


@dataclass(frozen=True, slots=True)
class CausalPreference:
    """The author's wish for the causality of an element (or a field's port)."""

    element: str
    wanted: Wanted


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
    preferences
        The author's wishes for causality.
    """

    name: str
    nodes: tuple[Node, ...]
    bonds: tuple[Bond, ...]
    domains: tuple[EnergyDomain, ...]
    measurements: tuple[Measurement, ...] = ()
    parameters: ParameterSet = field(default_factory=ParameterSet)
    preferences: tuple[CausalPreference, ...] = ()
    _nodes: dict[str, Node] = field(init=False, repr=False, compare=False)
    _bonds_at: dict[str, list[int]] = field(init=False, repr=False, compare=False)
    _bond: dict[str, int] = field(init=False, repr=False, compare=False)
    _port: dict[str, str] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        at: dict[str, list[int]] = {node.name: [] for node in self.nodes}
        for i, bond in enumerate(self.bonds):
            at.setdefault(bond.tail, []).append(i)
            at.setdefault(bond.head, []).append(i)
        object.__setattr__(self, "_nodes", {node.name: node for node in self.nodes})
        object.__setattr__(self, "_bonds_at", at)
        names = {bond.name: i for i, bond in enumerate(self.bonds)}
        object.__setattr__(self, "_bond", names)
        object.__setattr__(self, "_port", self._field_ports())
        check_graph(self)

    def _field_ports(self) -> dict[str, str]:
        return {
            node.port(k + 1): self.bonds[i].name
            for node in self.nodes
            if isinstance(node, MultiPort)
            for k, i in enumerate(self._bonds_at[node.name][: node.size])
        }

    @property
    def by_name(self) -> Mapping[str, Node]:
        """The nodes by name."""
        return self._nodes

    def node(self, name: str) -> Node:
        """Return the node called `name`, or refuse naming the closest ones."""
        try:
            return self._nodes[name]
        except KeyError:
            raise StructureError(
                f"There is no junction or element {name!r} in {self.name!r}.",
                (name,),
                did_you_mean(name, self._nodes),
            ) from None

    def bonds_at(self, name: str) -> tuple[Bond, ...]:
        """Return the bonds at a node, in the author's order."""
        return tuple(self.bonds[i] for i in self._bonds_at.get(name, ()))

    def domains_at(self, name: str) -> tuple[EnergyDomain, ...]:
        """Return the domains of the bonds at a node, in the author's order."""
        return tuple(self.domains[i] for i in self._bonds_at.get(name, ()))

    def has_place(self, name: str) -> bool:
        """Return whether there is a node or bond called `name`."""
        return name in self._nodes or name in self._bond or name in self._port

    def port_bond(self, name: str) -> str | None:
        """Return the bond at the field's port called ``field[1]``, if it is one."""
        return self._port.get(name)

    def domain_at(self, name: str) -> EnergyDomain:
        """Return the domain of a junction or one-port (of its first bond) or bond."""
        name = self._port.get(name, name)
        bonds = self._bonds_at.get(name) or [self._bond.get(name, -1)]
        if bonds[0] < 0:
            raise StructureError(f"{name!r} has no bond.", (name,), "Connect it.")
        return self.domains[bonds[0]]

    @property
    def junctions(self) -> tuple[Junction, ...]:
        """The junctions, in the author's order."""
        return tuple(n for n in self.nodes if isinstance(n, Junction))

    @property
    def elements(self) -> tuple[Node, ...]:
        """The one-, two- and multiports, in the author's order."""
        return tuple(n for n in self.nodes if not isinstance(n, Junction))

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
            preferences=self.preferences,
        )

    def finish(self) -> "FinishedGraph":
        """Return the graph itself (it is finished)."""
        return self


def used_parameters(
    nodes: Iterable[Node], measurements: Iterable[Measurement]
) -> tuple[str, ...]:
    """Return the names of all parameters that laws and measurements use, in order."""
    names: dict[str, None] = {}
    for node in nodes:
        names.update(dict.fromkeys(parameters_of(node)))
    for measurement in measurements:
        names.update(dict.fromkeys(parameters_in(measurement.expression)))
    return tuple(names)


__all__ = [
    "Bond",
    "CausalPreference",
    "FinishedGraph",
    "Measurement",
    "Wanted",
    "is_one_port",
    "laws_of",
    "used_parameters",
]
