"""What a graph remembers: its states, and what a signal stands for.

A storage in integral causality is a state; one in derivative causality holds what its
law says of the flow (effort) that others set. The integral of a flow (effort) that a
signal reads is what a C (an I) on the same wire holds, or a state of its own.
"""

from dataclasses import dataclass

import sympy

from bondgraph.equations.inversion import check_monotone, explicit
from bondgraph.equations.state_equations import State
from bondgraph.equations.wires import SymbolNames, Wires
from bondgraph.structure import signals
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import Compliance, Inertance, letter
from bondgraph.structure.graph import FinishedGraph, is_one_port
from bondgraph.structure.signals import Signal, signals_in


@dataclass(frozen=True, slots=True)
class Implicit:
    """A wire that only makes `residual` vanish (a law without a formula)."""

    symbol: sympy.Symbol
    residual: sympy.Expr
    origin: str
    reason: str


class Memory:
    """The states of a causal graph and the meaning of its signals.

    ``states`` and ``rates`` hold one entry per state, ``symbols`` the state symbol of
    each integral storage, ``implicit`` the unknown contents of dependent storages.
    """

    def __init__(
        self, graph: FinishedGraph, integral: tuple[str, ...], names: SymbolNames
    ) -> None:
        self.graph = graph
        self.names = names
        self.states: list[State] = []
        self.rates: list[sympy.Expr] = []
        self.implicit: dict[sympy.Symbol, Implicit] = {}
        nodes = graph.by_name
        self.symbols = {
            name: names.symbol(f"{_stored_letter(nodes[name])}_{name}")
            for name in integral
        }
        self.wires = Wires(graph, names)
        self._parameter = {p.name: p for p in graph.parameters.members}
        self._providers: dict[sympy.Symbol, tuple[str, int]] = {}
        self._stored: dict[str, sympy.Expr] = {}
        self._integrators: dict[sympy.Symbol, sympy.Symbol] = {}
        self._make_states()

    def _make_states(self) -> None:
        """Make the states of integral storages and note who stores what."""
        storages = [
            n for n in self.graph.nodes if isinstance(n, Inertance | Compliance)
        ]
        for node in sorted(storages, key=lambda n: n.name not in self.symbols):
            port = self.wires.port(node.name)
            inertance = isinstance(node, Inertance)
            wire = port.effort if inertance else port.flow
            sign = port.effort_sign if inertance else port.flow_sign
            self._providers.setdefault(wire, (node.name, sign))
            if node.name in self.symbols:
                rate = port.own_effort if inertance else port.own_flow
                symbol = self.symbols[node.name]
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
        if name in self.symbols:
            return self.symbols[name]
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
            return self.substituted(law, {co: own})
        relation = check_monotone(element, self._parameter.__getitem__, "dependent")
        symbol = self.names.symbol(f"{stored}_{name}")
        law = self.substituted(relation.expression, {stored: symbol})
        reason = f"what dependent {letter(element)} {name!r} stores has no formula"
        self.implicit[symbol] = Implicit(symbol, own - law, name, reason)
        return symbol

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
            return signed(self._integral(wire, quantity), sign)
        return signed(wire, sign)

    def _integral(self, wire: sympy.Symbol, quantity: Quantity) -> sympy.Expr:
        if wire in self._providers:
            name, sign = self._providers[wire]
            return signed(self.stored(name), sign)
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
            self._add_state(
                symbol, label, wires.index(wire), is_momentum, signed(wire, sign)
            )
        return signed(self._integrators[wire], sign)

    def in_wires(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with its signals replaced by wires and states."""
        return self.substituted(expression, {})

    def substituted(
        self, law: sympy.Expr, own: dict[sympy.Symbol, sympy.Expr]
    ) -> sympy.Expr:
        """Return `law` with `own` port variables put in and its signals replaced."""
        reads = signals_in(law)
        if not reads:
            return law.xreplace(own) if own else law
        return law.xreplace({**own, **{signal: self.value(signal) for signal in reads}})


def signed(expression: sympy.Expr, sign: int) -> sympy.Expr:
    """Return `expression` or its negative, without asking sympy where it is itself."""
    return expression if sign > 0 else -expression


def _stored_letter(node: object) -> str:
    return "p" if isinstance(node, Inertance) else "q"
