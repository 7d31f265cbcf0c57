"""A draft: what has been written of a graph so far, and the graph it becomes.

`bondgraph.structure.builder` is how an author writes one; drafts are copied into one
another, which is how sub-graphs are made.
"""

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from itertools import count

import sympy

from bondgraph.errors import ParameterError, StructureError
from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.elements import Node
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.graph import (
    Bond,
    CausalPreference,
    FinishedGraph,
    Measurement,
    used_parameters,
)
from bondgraph.structure.linear_units import linear_units
from bondgraph.structure.parameters import Parameter, ParameterSet
from bondgraph.structure.renaming import Renaming
from bondgraph.structure.signals import Signal, parameters_in
from bondgraph.structure.subgraphs import SubGraph, renaming_of
from bondgraph.structure.units import si_unit


@dataclass(slots=True)
class Draft:
    """Nodes, bonds with their domains, measurements, parameters and wishes, unchecked.

    ``library`` holds parameters that are taken only where a law uses them;
    ``exposed`` the junctions that another graph may join.
    """

    name: str
    nodes: list[Node] = field(default_factory=list)
    bonds: list[tuple[Bond, EnergyDomain]] = field(default_factory=list)
    junction_domains: dict[str, EnergyDomain] = field(default_factory=dict)
    measurements: list[tuple[str, sympy.Expr, str | None]] = field(default_factory=list)
    parameters: dict[str, Parameter] = field(default_factory=dict)
    library: ParameterSet = field(default_factory=ParameterSet)
    preferences: dict[str, CausalPreference] = field(default_factory=dict)
    exposed: dict[str, None] = field(default_factory=dict)

    @classmethod
    def of(cls, graph: FinishedGraph) -> "Draft":
        """Return a draft that holds what a finished graph does."""
        domains = {j.name: graph.domain_at(j.name) for j in graph.junctions}
        return cls(
            name=graph.name,
            nodes=list(graph.nodes),
            bonds=list(zip(graph.bonds, graph.domains, strict=True)),
            junction_domains=domains,
            measurements=[(m.name, m.expression, m.unit) for m in graph.measurements],
            parameters=dict(graph.parameters),
            preferences={p.element: p for p in graph.preferences},
        )

    def include(
        self, part: "Draft", name: str | None, shared: Collection[str]
    ) -> SubGraph:
        """Copy `part` into this draft; see ``BondGraph.include``."""
        if part is self:
            raise StructureError(
                f"The graph {self.name!r} cannot be a part of itself while it is being "
                "written.",
                (self.name,),
                "Include a finished copy: include(graph.finish(), name).",
            )
        renaming = renaming_of(part.nodes, part.measurements, name, shared)
        self.nodes += [renaming.node(node) for node in part.nodes]
        self.bonds += [(renaming.bond(b), domain) for b, domain in part.bonds]
        self.junction_domains.update(
            (renaming.place(j), domain) for j, domain in part.junction_domains.items()
        )
        prefix = "" if name is None else f"{name}_"
        self.measurements += [
            (f"{prefix}{output}", renaming.expression(expression), unit)
            for output, expression, unit in part.measurements
        ]
        for preference in part.preferences.values():
            element = renaming.place(preference.element)
            self.preferences[element] = CausalPreference(element, preference.wanted)
        self._include_parameters(part, renaming)
        exposed = part.exposed or part.junction_domains
        return SubGraph(name or part.name, {j: renaming.place(j) for j in exposed})

    def _include_parameters(self, part: "Draft", renaming: Renaming) -> None:
        used = used_parameters(part.nodes, ())
        measured = tuple(n for _, x, _ in part.measurements for n in parameters_in(x))
        known = part.library.restricted((*used, *measured))
        for parameter in known.merged(part.parameters.values()).members:
            new = replace(parameter, name=renaming.parameter(parameter.name))
            old = self.parameters.setdefault(new.name, new)
            if old != new:
                raise ParameterError(
                    f"The parameter {new.name!r} has two declarations.",
                    (new.name,),
                    "Share it with one declaration, or name the sub-graph.",
                )

    def finished(self) -> FinishedGraph:
        """Return the checked, frozen graph, with every parameter in SI units."""
        bonds = tuple(bond for bond, _ in self.bonds)
        domains = tuple(domain for _, domain in self.bonds)
        domain_at = self._domain_at()
        measurements = tuple(
            Measurement(name, expression, _unit(expression, unit, domain_at))
            for name, expression, unit in self.measurements
        )
        used = used_parameters(self.nodes, measurements)
        declared = self.library.restricted(used).merged(self.parameters.values())
        units = linear_units(self.nodes, bonds, domains)
        undeclared = tuple(
            Parameter(name=n, unit=units.get(n, "1")) for n in used if n not in declared
        )
        parameters = declared.merged(undeclared).members
        return FinishedGraph(
            name=self.name,
            nodes=tuple(self.nodes),
            bonds=bonds,
            domains=domains,
            measurements=measurements,
            parameters=ParameterSet(tuple(map(in_si, parameters))),
            preferences=tuple(self.preferences.values()),
        )

    def _domain_at(self) -> dict[str, EnergyDomain]:
        """Return the domain at every bond, port of a field, and node (its first)."""
        fields = {n.name: n for n in self.nodes if isinstance(n, MultiPort)}
        number = {name: count(1) for name in fields}
        found: dict[str, EnergyDomain] = {}
        for bond, domain in self.bonds:
            for place in (bond.tail, bond.head, bond.name):
                found.setdefault(place, domain)
            for end in fields.keys() & {bond.tail, bond.head}:
                found[fields[end].port(next(number[end]))] = domain
        return found


def _unit(
    expression: sympy.Expr, unit: str | None, domain_at: dict[str, EnergyDomain]
) -> str:
    """Return a measurement's unit: given, or that of the one signal it reads."""
    if unit is not None:
        return unit
    if isinstance(expression, Signal) and expression.place in domain_at:
        return domain_at[expression.place].unit(expression.quantity)
    return "1"


def in_si(parameter: Parameter) -> Parameter:
    """Return the parameter with a prefixed or non-SI unit converted."""
    if parameter.value is None:
        return parameter
    unit = si_unit(parameter.unit)
    return parameter if unit == parameter.unit else parameter.to(unit)
