"""Definitions: the one equation that gives each wire its value.

A causal stroke says which end of a bond gives effort and which gives flow, so every
wire is defined exactly once: by an element's law, or by the balance at a junction. Not
yet sorted; loops and chains of equal signals are still in it.
"""

from dataclasses import dataclass

import sympy

from bondgraph.causality.records import CausalAssignment
from bondgraph.equations.inversion import OnePortWithLaw, check_monotone, explicit
from bondgraph.equations.state_equations import State
from bondgraph.equations.wires import Port, SymbolNames, Wires
from bondgraph.errors import EquationError
from bondgraph.structure import signals
from bondgraph.structure.domains import Quantity
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
from bondgraph.structure.graph import FinishedGraph, is_one_port
from bondgraph.structure.signals import Signal, parameter_symbol, signals_in


@dataclass(frozen=True, slots=True)
class Definition:
    """``symbol = expression``, given by the node `origin`."""

    symbol: sympy.Symbol
    expression: sympy.Expr
    origin: str
    reason: str


@dataclass(frozen=True, slots=True)
class Implicit:
    """A wire that only makes `residual` vanish (a law without a formula)."""

    symbol: sympy.Symbol
    residual: sympy.Expr
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

    Attributes are filled in the order of the graph's nodes: ``given`` (explicit
    definitions by symbol), ``implicit``, ``dependent``, ``states`` and ``rates``.
    """

    def __init__(
        self, graph: FinishedGraph, causality: CausalAssignment, names: SymbolNames
    ) -> None:
        self.graph = graph
        self.names = names
        self.given: dict[sympy.Symbol, Definition] = {}
        self.implicit: dict[sympy.Symbol, Implicit] = {}
        self.dependent: dict[sympy.Symbol, Dependent] = {}
        self.states: list[State] = []
        self.rates: list[sympy.Expr] = []
        self.inputs = {
            source.name: sympy.Symbol(source.name, real=True) for source in graph.inputs
        }
        self._parameter = {p.name: p for p in graph.parameters.members}
        self._causality = causality
        self._storage_symbols = self._name_states(causality.integral)
        self.wires = Wires(graph, names)
        self._stroke = [stroke.at for stroke in causality.strokes]
        self._providers: dict[sympy.Symbol, tuple[str, int]] = {}
        self._stored: dict[str, sympy.Expr] = {}
        self._integrators: dict[sympy.Symbol, sympy.Symbol] = {}
        self._make_states()
        for node in graph.nodes:
            self._define(node)
        self._check_complete()

    # States -----------------------------------------------------------------

    def _name_states(self, integral: tuple[str, ...]) -> dict[str, sympy.Symbol]:
        nodes = self.graph.by_name
        return {
            name: self.names.symbol(f"{_stored_letter(nodes[name])}_{name}")
            for name in integral
        }

    def _make_states(self) -> None:
        """Make the states of integral storages and note who stores what."""
        integral = set(self._causality.integral)
        storages = [
            n for n in self.graph.nodes if isinstance(n, Inertance | Compliance)
        ]
        for node in sorted(storages, key=lambda n: n.name not in integral):
            port = self.wires.port(node.name)
            inertance = isinstance(node, Inertance)
            wire = port.effort if inertance else port.flow
            sign = port.effort_sign if inertance else port.flow_sign
            self._providers.setdefault(wire, (node.name, sign))
            if node.name in integral:
                rate = port.own_effort if inertance else port.own_flow
                symbol = self._storage_symbols[node.name]
                self._add_state(symbol, node.name, port.bond, inertance, rate)

    def _add_state(
        self,
        symbol: sympy.Symbol,
        place: str,
        bond: int,
        is_momentum: bool,
        rate: sympy.Expr,
    ) -> None:
        quantity = Quantity.MOMENTUM if is_momentum else Quantity.DISPLACEMENT
        unit = self.graph.domains[bond].unit(quantity)
        rate_symbol = self.names.symbol(f"d{symbol.name}")
        self.states.append(State(symbol, rate_symbol, place, unit))
        self.rates.append(rate)

    def stored(self, name: str) -> sympy.Expr:
        """Return the momentum (displacement) in the I (C) called `name`."""
        if name in self._storage_symbols:
            return self._storage_symbols[name]
        if name not in self._stored:
            self._stored[name] = self._stored_of_dependent(name)
        return self._stored[name]

    def _stored_of_dependent(self, name: str) -> sympy.Expr:
        element = self.wires.nodes[name]
        assert isinstance(element, Inertance | Compliance)
        inertance = isinstance(element, Inertance)
        port = self.wires.port(name)
        stored, co = (signals.p, signals.f) if inertance else (signals.q, signals.e)
        own = port.own_flow if inertance else port.own_effort
        law = explicit(element, stored)
        if law is not None:
            return self._in_wires(law, {co: own})
        relation = check_monotone(element, self._parameter.__getitem__, "dependent")
        symbol = self.names.symbol(f"{stored}_{name}")
        law = self._in_wires(relation.expression, {stored: symbol})
        reason = f"what dependent {letter(element)} {name!r} stores has no formula"
        self.implicit[symbol] = Implicit(symbol, own - law, name, reason)
        return symbol

    # Signals ----------------------------------------------------------------

    def value(self, signal: Signal) -> sympy.Expr:
        """Return what a signal stands for in wires and states.

        The integral of an effort (flow) is what an I (C) on the same wire stores; where
        there is none, a state of its own is added.
        """
        quantity, place = signal.quantity, signal.place
        node = self.wires.nodes.get(place)
        own_kind = {Quantity.MOMENTUM: Inertance, Quantity.DISPLACEMENT: Compliance}
        if quantity in own_kind and isinstance(node, own_kind[quantity]):
            return self.stored(place)
        wire, sign = self.wires.read(quantity, place)
        if quantity in own_kind:
            return sign * self._integral(wire, quantity)
        return wire if sign > 0 else -wire

    def _integral(self, wire: sympy.Symbol, quantity: Quantity) -> sympy.Expr:
        if wire in self._providers:
            name, sign = self._providers[wire]
            return sign * self.stored(name)
        # A one-port's own wire is integrated in the one-port's convention, so that
        # turning its arrow leaves the state as it is.
        label = self.wires.label[wire]
        sign = 1
        if label in self.wires.nodes and is_one_port(self.wires.nodes[label]):
            sign = self.wires.read(quantity, label)[1]
        if wire not in self._integrators:
            is_momentum = quantity is Quantity.MOMENTUM
            symbol = self.names.symbol(f"{'p' if is_momentum else 'q'}_{label}")
            wires = self.wires.effort if is_momentum else self.wires.flow
            self._integrators[wire] = symbol
            self._add_state(symbol, label, wires.index(wire), is_momentum, sign * wire)
        return sign * self._integrators[wire]

    def in_wires(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with its signals replaced by wires and states."""
        return self._in_wires(expression, {})

    def _in_wires(
        self, law: sympy.Expr, own: dict[sympy.Symbol, sympy.Expr]
    ) -> sympy.Expr:
        reads = signals_in(law)
        if not reads:
            return law.xreplace(own) if own else law
        return law.xreplace({**own, **{signal: self.value(signal) for signal in reads}})

    # Elements ---------------------------------------------------------------

    def _define(self, node: object) -> None:
        match node:
            case EffortSource():
                port = self.wires.port(node.name)
                value = self._source_value(node)
                self._give(port.effort, port.effort_sign * value, node.name, "source")
            case FlowSource():
                port = self.wires.port(node.name)
                value = self._source_value(node)
                self._give(port.flow, port.flow_sign * value, node.name, "source")
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
        return self.in_wires(source.value)

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
        law = explicit(element, wanted)
        kind = letter(element)
        if law is not None:
            expression = sign * self._in_wires(law, {symbol: value})
            self._give(wire, expression, element.name, f"law of {kind}")
            return
        because = "forced by the rest of the graph"
        relation = check_monotone(element, self._parameter.__getitem__, because)
        own = port.own_effort if is_effort else port.own_flow
        right = self._in_wires(relation.expression, {wanted: own})
        reason = f"the law of {kind} {element.name!r} has no formula for {wanted}"
        self.implicit[wire] = Implicit(wire, value - right, element.name, reason)

    def _storage(self, node: Inertance | Compliance) -> None:
        port = self.wires.port(node.name)
        inertance = isinstance(node, Inertance)
        if node.name in self._storage_symbols:
            stored = signals.p if inertance else signals.q
            wanted = signals.f if inertance else signals.e
            self._law(node, port, wanted, (stored, self._storage_symbols[node.name]))
            return
        wire = port.effort if inertance else port.flow
        own = port.own_effort if inertance else port.own_flow
        given = "flow" if inertance else "effort"
        reason = (
            f"{letter(node)} {node.name!r} is dependent: its {given} is set by others"
        )
        self.dependent[wire] = Dependent(
            wire, own, self.stored(node.name), node.name, reason
        )

    def _resistance(self, node: Resistance) -> None:
        port = self.wires.port(node.name)
        if self._receives_effort(node.name, port):
            self._law(node, port, signals.f, (signals.e, port.own_effort))
        else:
            self._law(node, port, signals.e, (signals.f, port.own_flow))

    def _transformer(self, node: Transformer) -> None:
        a, b = self.wires.two_ports(node.name)
        modulus = self.in_wires(node.modulus)
        if self._receives_effort(node.name, a):
            effort, flow = (b, modulus * a.own_effort), (a, modulus * b.own_flow)
        else:
            effort, flow = (a, b.own_effort / modulus), (b, a.own_flow / modulus)
        self._give(effort[0].effort, effort[0].effort_sign * effort[1], node.name, "TF")
        self._give(flow[0].flow, flow[0].flow_sign * flow[1], node.name, "TF")

    def _gyrator(self, node: Gyrator) -> None:
        a, b = self.wires.two_ports(node.name)
        modulus = self.in_wires(node.modulus)
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
        terms = [
            self._into(i, name) * -self._into(supplier, name) * wires[i]
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


def _stored_letter(node: object) -> str:
    return "p" if isinstance(node, Inertance) else "q"


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
