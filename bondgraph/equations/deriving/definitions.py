"""Definitions: the one equation that gives each wire its value.

A causal stroke says which end of a bond gives effort and which gives flow, so every
wire is defined exactly once: by an element's law, or by the balance at a junction. Not
yet sorted; loops and chains of equal signals are still in it.
"""

from dataclasses import dataclass

import sympy

from bondgraph.causality.records import CausalAssignment
from bondgraph.equations.deriving.inversion import OnePortWithLaw
from bondgraph.equations.deriving.memory import Implicit, Memory, StoragePort, signed
from bondgraph.equations.deriving.wires import Port, SymbolNames
from bondgraph.errors import EquationError
from bondgraph.structure import signals
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Gyrator,
    Inertance,
    OneJunction,
    Resistance,
    Transformer,
    ZeroJunction,
    letter,
)
from bondgraph.structure.fields import (
    ComplianceField,
    InertanceField,
    MixedField,
    MultiPort,
    ResistanceField,
    StorageField,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import parameter_symbol


@dataclass(frozen=True, slots=True)
class Definition:
    """``symbol = expression``, given by the node `origin`."""

    symbol: sympy.Symbol
    expression: sympy.Expr
    origin: str
    reason: str


@dataclass(frozen=True, slots=True)
class Dependent:
    """A storage in derivative causality: its own port variable is d(stored)/dt."""

    symbol: sympy.Symbol
    own: sympy.Expr
    stored: sympy.Expr
    origin: str
    reason: str


class Definitions:
    """All wires of a causal graph with their definitions.

    Filled in the order of the graph's nodes: ``given`` (explicit definitions by
    symbol), ``implicit`` and ``dependent``; ``memory`` holds the states.
    """

    def __init__(
        self, graph: FinishedGraph, causality: CausalAssignment, names: SymbolNames
    ) -> None:
        self.graph = graph
        self.given: dict[sympy.Symbol, Definition] = {}
        self.dependent: dict[sympy.Symbol, Dependent] = {}
        self.inputs = {
            source.name: sympy.Symbol(source.name, real=True) for source in graph.inputs
        }
        self.memory = Memory(graph, causality.integral, names)
        self.wires = self.memory.wires
        self.implicit = self.memory.implicit
        self._stroke = [stroke.at for stroke in causality.strokes]
        for node in graph.nodes:
            self._define(node)
        self._check_complete()

    def _define(self, node: object) -> None:
        match node:
            case EffortSource():
                port = self.wires.port(node.name)
                value = self._source_value(node)
                self._give(
                    port.effort, signed(value, port.effort_sign), node.name, "source"
                )
            case FlowSource():
                port = self.wires.port(node.name)
                value = self._source_value(node)
                self._give(
                    port.flow, signed(value, port.flow_sign), node.name, "source"
                )
            case Inertance() | Compliance():
                self._storage(node)
            case Resistance():
                self._resistance(node)
            case Transformer():
                self._transformer(node)
            case Gyrator():
                self._gyrator(node)
            case ZeroJunction() | OneJunction():
                self._balance(node)
            case ResistanceField():
                self._resistance_field(node)
            case InertanceField() | ComplianceField() | MixedField():
                self._storage_field(node)

    def _give(
        self, wire: sympy.Symbol, expression: sympy.Expr, origin: str, reason: str
    ) -> None:
        if wire in self.given or wire in self.dependent or wire in self.implicit:
            raise EquationError(
                f"{str(wire)!r} is defined twice, by {origin!r} and another element.",
                (origin, str(wire)),
                "Remove one of the two constraints.",
            )
        self.given[wire] = Definition(wire, expression, origin, reason)

    def _source_value(self, source: EffortSource | FlowSource) -> sympy.Expr:
        if source.value is None:
            return self.inputs[source.name]
        return self.memory.in_wires(source.value)

    def _receives_effort(self, name: str, port: Port) -> bool:
        return self._stroke[port.bond] == name

    def _law(
        self,
        element: OnePortWithLaw,
        port: Port,
        wanted: sympy.Symbol,
        other: tuple[sympy.Symbol, sympy.Expr],
    ) -> None:
        """Define the wire of `wanted` (e or f) by the element's law."""
        is_effort = wanted == signals.e
        wire = port.effort if is_effort else port.flow
        sign = port.effort_sign if is_effort else port.flow_sign
        symbol, value = other
        law = self.memory.laws.explicit(element, wanted, {symbol: value})
        kind = letter(element)
        if law is not None:
            expression = signed(self.memory.in_wires(law), sign)
            self._give(wire, expression, element.name, f"law of {kind}")
            return
        because = "forced by the rest of the graph"
        relation = self.memory.laws.monotone(element, because)
        own = port.own_effort if is_effort else port.own_flow
        right = self.memory.substituted(relation.expression, {wanted: own})
        reason = f"the law of {kind} {element.name!r} has no formula for {wanted}"
        self.implicit[wire] = Implicit(wire, value - right, element.name, reason)

    def _storage(self, node: Inertance | Compliance) -> None:
        port = self.memory.ports[node.name]
        if port.name not in self.memory.symbols:
            self._dependent(port)
            return
        inertance = isinstance(node, Inertance)
        stored = signals.p if inertance else signals.q
        wanted = signals.f if inertance else signals.e
        self._law(node, port.port, wanted, (stored, self.memory.symbols[port.name]))

    def _dependent(self, port: StoragePort) -> None:
        wire, _ = port.rate_wire
        given = "flow" if port.is_momentum else "effort"
        kind = letter(self.wires.nodes[port.element])
        reason = f"{kind} {port.name!r} is dependent: its {given} is set by others"
        stored = self.memory.stored(port.name)
        self.dependent[wire] = Dependent(wire, port.rate, stored, port.element, reason)

    def _storage_field(self, field: StorageField) -> None:
        unknown: list[int] = []
        for i, relation in enumerate(field.relations):
            port = self.memory.ports[field.port(i + 1)]
            if port.name not in self.memory.symbols:
                self._dependent(port)
                continue
            wire = port.port.flow if port.is_momentum else port.port.effort
            sign = port.port.flow_sign if port.is_momentum else port.port.effort_sign
            law = self.memory.of_field(field, relation.expression)
            if relation.output != field.stored[i]:
                self._give(wire, signed(law, sign), field.name, f"law of {port.name}")
                continue
            unknown.append(i)
            self._unknown(wire, self.memory.symbols[port.name] - law, field, i)
        self.memory.laws.check_field(field, unknown, "they are states")

    def _resistance_field(self, field: ResistanceField) -> None:
        unknown: list[int] = []
        for i, relation in enumerate(field.relations):
            port = self.wires.ports(field.name)[i]
            gives_flow = self._receives_effort(field.name, port)
            wire = port.flow if gives_flow else port.effort
            sign = port.flow_sign if gives_flow else port.effort_sign
            law = self.memory.of_field(field, relation.expression)
            if relation.output.letter == ("f" if gives_flow else "e"):
                name = field.port(i + 1)
                self._give(wire, signed(law, sign), field.name, f"law of {name}")
                continue
            unknown.append(i)
            known = port.own_effort if gives_flow else port.own_flow
            self._unknown(wire, known - law, field, i)
        self.memory.laws.check_field(field, unknown, "forced by the rest of the graph")

    def _unknown(
        self, wire: sympy.Symbol, residual: sympy.Expr, field: MultiPort, i: int
    ) -> None:
        wanted = field.relations[i].argument
        reason = f"the laws of {field.name!r} have no formula for {wanted}"
        self.implicit[wire] = Implicit(wire, residual, field.name, reason)

    def _resistance(self, node: Resistance) -> None:
        port = self.wires.port(node.name)
        if self._receives_effort(node.name, port):
            self._law(node, port, signals.f, (signals.e, port.own_effort))
        else:
            self._law(node, port, signals.e, (signals.f, port.own_flow))

    def _transformer(self, node: Transformer) -> None:
        a, b = self.wires.two_ports(node.name)
        modulus = self.memory.in_wires(node.modulus)
        if self._receives_effort(node.name, a):
            effort, flow = (b, modulus * a.own_effort), (a, modulus * b.own_flow)
        else:
            effort, flow = (a, b.own_effort / modulus), (b, a.own_flow / modulus)
        self._give(
            effort[0].effort, signed(effort[1], effort[0].effort_sign), node.name, "TF"
        )
        self._give(flow[0].flow, signed(flow[1], flow[0].flow_sign), node.name, "TF")

    def _gyrator(self, node: Gyrator) -> None:
        a, b = self.wires.two_ports(node.name)
        modulus = self.memory.in_wires(node.modulus)
        for port, other in ((a, b), (b, a)):
            if self._receives_effort(node.name, a):
                value = port.flow_sign * other.own_effort / modulus
                self._give(port.flow, value, node.name, "GY")
            else:
                value = port.effort_sign * modulus * other.own_flow
                self._give(port.effort, value, node.name, "GY")

    def _balance(self, junction: ZeroJunction | OneJunction) -> None:
        """Define the balanced variable of the bond that supplies the common one."""
        name = junction.name
        one = isinstance(junction, OneJunction)
        wires = self.wires.effort if one else self.wires.flow
        bonds = self.wires.at[name]
        (supplier,) = (i for i in bonds if (self._stroke[i] == name) != one)
        outward = -self._into(supplier, name)
        terms = [
            signed(wires[i], self._into(i, name) * outward)
            for i in bonds
            if i != supplier
        ]
        what = "efforts" if one else "flows"
        reason = f"{what} balance at {name}"
        self._give(wires[supplier], sympy.Add(*terms), name, reason)

    def _into(self, bond: int, junction: str) -> int:
        return 1 if self.graph.bonds[bond].head == junction else -1

    def _check_complete(self) -> None:
        """Refuse a wire that nothing defines: a ring that only passes values round."""
        for wire, label in self.wires.label.items():
            if (
                wire not in self.given
                and wire not in self.implicit
                and wire not in self.dependent
            ):
                raise EquationError(
                    f"Nothing in {self.graph.name!r} determines {str(wire)!r}: the "
                    f"junctions around {label!r} only pass it round in a ring.",
                    (label,),
                    "Open the ring, or put a source, a storage or an R in it.",
                )


def reserved_names(graph: FinishedGraph) -> SymbolNames:
    """Return a supply of names that avoids those of parameters and inputs.

    Raises
    ------
    EquationError
        If an input has the name of a parameter, because the two would be one symbol.
    """
    names = SymbolNames()
    names.reserve("t")
    for parameter in graph.parameters:
        names.reserve(parameter_symbol(parameter).name)
    for source in graph.inputs:
        if source.name in graph.parameters:
            raise EquationError(
                f"{source.name!r} names both an input and a parameter.",
                (source.name,),
                f"Rename one; to read the input write effort({source.name!r}).",
            )
        names.reserve(source.name)
    return names
