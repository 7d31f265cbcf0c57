"""What a graph remembers: its states, and what a signal stands for.

A storage port in integral causality is a state; one in derivative causality holds what
its law says of the flow (effort) that others set. The integral of a flow (effort) that
a signal reads is what a C (an I) on the same wire holds, or a state of its own.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy

from bondgraph.equations.deriving.inversion import Laws
from bondgraph.equations.deriving.wires import Port, SymbolNames, Wires
from bondgraph.equations.state_equations import State
from bondgraph.structure import signals
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import Inertance, Storage, is_one_port, letter
from bondgraph.structure.fields import MultiPort, StorageField
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import Signal, signals_in


@dataclass(frozen=True, slots=True)
class Implicit:
    """A wire that only makes `residual` vanish (a law without a formula)."""

    symbol: sympy.Symbol
    residual: sympy.Expr
    origin: str
    reason: str


@dataclass(frozen=True, slots=True)
class StoragePort:
    """A port that stores: of an I or C, or one of a field's, called ``name[1]``."""

    name: str
    element: str
    port: Port
    is_momentum: bool

    @property
    def symbol_name(self) -> str:
        """What its state is called: ``p_mass``, ``q_field_1``."""
        place = self.name.replace("[", "_").replace("]", "")
        return f"{'p' if self.is_momentum else 'q'}_{place}"

    @property
    def rate(self) -> sympy.Expr:
        """The own effort (flow), whose integral it stores."""
        return self.port.own_effort if self.is_momentum else self.port.own_flow

    @property
    def co(self) -> sympy.Expr:
        """The own flow (effort), which its law ties to what it stores."""
        return self.port.own_flow if self.is_momentum else self.port.own_effort

    @property
    def rate_wire(self) -> tuple[sympy.Symbol, int]:
        """The wire of `rate`, and its sign."""
        port = self.port
        if self.is_momentum:
            return port.effort, port.effort_sign
        return port.flow, port.flow_sign


class Memory:
    """The states of a causal graph and the meaning of its signals.

    ``states`` and ``rates`` hold one entry per state, ``symbols`` the state symbol of
    each integral storage port, ``implicit`` the unknown contents of dependent ones.
    """

    def __init__(
        self, graph: FinishedGraph, integral: tuple[str, ...], names: SymbolNames
    ) -> None:
        self.graph = graph
        self.names = names
        self.laws = Laws(graph)
        self.states: list[State] = []
        self.rates: list[sympy.Expr] = []
        self.implicit: dict[sympy.Symbol, Implicit] = {}
        integral_ports = set(integral)
        self.wires = Wires(graph, names)
        self.ports = {port.name: port for port in self._storage_ports()}
        self.symbols = {
            name: names.symbol(port.symbol_name)
            for name, port in self.ports.items()
            if name in integral_ports
        }
        self._providers: dict[sympy.Symbol, tuple[str, int]] = {}
        self._stored: dict[str, sympy.Expr] = {}
        self._integrators: dict[sympy.Symbol, sympy.Symbol] = {}
        self._make_states()

    def _storage_ports(self) -> Iterator[StoragePort]:
        for node in self.graph.nodes:
            if isinstance(node, Storage):
                momentum = isinstance(node, Inertance)
                port = self.wires.port(node.name)
                yield StoragePort(node.name, node.name, port, momentum)
            elif isinstance(node, StorageField):
                for i, port in enumerate(self.wires.ports(node.name)):
                    momentum = node.stored[i].letter == "p"
                    yield StoragePort(node.port(i + 1), node.name, port, momentum)

    def _make_states(self) -> None:
        """Make the states of integral storages and note who stores what."""
        for port in sorted(
            self.ports.values(), key=lambda p: p.name not in self.symbols
        ):
            wire, sign = port.rate_wire
            self._providers.setdefault(wire, (port.name, sign))
            if port.name in self.symbols:
                self._add_state(
                    self.symbols[port.name],
                    port.name,
                    port.port.bond,
                    port.is_momentum,
                    port.rate,
                )

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
        self.states.append(State(symbol, rate_symbol, place, unit, quantity))
        self.rates.append(rate)

    def stored(self, name: str) -> sympy.Expr:
        """Return what the storage port called `name` holds."""
        if name in self.symbols:
            return self.symbols[name]
        if name not in self._stored:
            element = self.wires.nodes[self.ports[name].element]
            if isinstance(element, StorageField):
                self._store_dependent_ports(element)
            else:
                assert isinstance(element, Storage)
                self._stored[name] = self._stored_of_dependent(element)
        return self._stored[name]

    def _stored_of_dependent(self, element: Storage) -> sympy.Expr:
        inertance = isinstance(element, Inertance)
        port = self.ports[element.name]
        stored, co = (signals.p, signals.f) if inertance else (signals.q, signals.e)
        law = self.laws.smooth(element, stored, {co: port.co})
        if law is not None:
            return self.in_wires(law)
        relation = self.laws.monotone(element, "dependent")
        symbol = self.names.symbol(port.symbol_name)
        law = self.substituted(relation.expression, {stored: symbol})
        self._unknown_content(symbol, port.co - law, element.name, letter(element))
        return symbol

    def _unknown_content(
        self, symbol: sympy.Symbol, residual: sympy.Expr, name: str, kind: str
    ) -> None:
        reason = f"what dependent {kind} {name!r} stores has no formula"
        self.implicit[symbol] = Implicit(symbol, residual, name, reason)

    def _store_dependent_ports(self, field: StorageField) -> None:
        """Find what a field's dependent ports hold, all of them at once."""
        relations = field.relations
        dependent = [
            i for i in range(field.size) if field.port(i + 1) not in self.symbols
        ]
        unknown = [i for i in dependent if relations[i].output != field.stored[i]]
        self.laws.check_field(field, unknown, "dependent")
        for i in unknown:
            port = self.ports[field.port(i + 1)]
            self._stored[port.name] = self.names.symbol(port.symbol_name)
        for i in dependent:
            law = self.of_field(field, relations[i].expression)
            name = field.port(i + 1)
            if i in unknown:
                residual = self.ports[name].co - law
                self._unknown_content(
                    self._stored[name], residual, field.name, letter(field)
                )
            else:
                self._stored[name] = law

    def of_field(self, field: MultiPort, law: sympy.Expr) -> sympy.Expr:
        """Return a field's law in wires and states."""
        ports = self.wires.ports(field.name)
        own: dict[sympy.Symbol, sympy.Expr] = {}
        for symbol in law.free_symbols:
            if isinstance(symbol, signals.PortVariable):
                port = ports[symbol.number - 1]
                if symbol.letter in "pq":
                    own[symbol] = self.stored(field.port(symbol.number))
                else:
                    own[symbol] = (
                        port.own_effort if symbol.letter == "e" else port.own_flow
                    )
        return self.substituted(law, own)

    def value(self, signal: Signal) -> sympy.Expr:
        """Return what a signal stands for in wires and states.

        The integral of an effort (flow) is what an I (C) on the same wire stores; where
        there is none, a state of its own is added.
        """
        quantity, place = signal.quantity, signal.place
        integrated = quantity in (Quantity.MOMENTUM, Quantity.DISPLACEMENT)
        own = self.ports.get(place)
        if own and integrated and own.is_momentum == (quantity is Quantity.MOMENTUM):
            return self.stored(place)
        wire, sign = self.wires.read(quantity, place)
        return signed(self._integral(wire, quantity) if integrated else wire, sign)

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
