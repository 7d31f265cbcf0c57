"""Wires: the variables of a graph once equal ones are one, and whose sign is whose.

Every bond has an effort and a flow. Bonds at one 0-junction share their effort, bonds
at one 1-junction their flow; what is shared is one `wire` with one symbol. A port's own
variables follow its element's convention (power into an I, C or R, out of a source);
where a half arrow points the other way, the variable that the neighbouring junction
balances changes sign, so that turning an arrow never changes the physics.
"""

from dataclasses import dataclass

import sympy

from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    OneJunction,
    ZeroJunction,
    is_one_port,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.graph import FinishedGraph


class SymbolNames:
    """Hands out real symbols, each name once."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def reserve(self, name: str) -> None:
        """Keep `name` from being handed out."""
        self._taken.add(name)

    def symbol(self, name: str) -> sympy.Symbol:
        """Return a new symbol called `name`, with underscores added if it is taken."""
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        return sympy.Symbol(name, real=True)


@dataclass(frozen=True, slots=True)
class Port:
    """One port of an element: its bond's wires and the signs of its own variables.

    Own effort is ``effort_sign * effort``, own flow ``flow_sign * flow``.
    """

    bond: int
    effort: sympy.Symbol
    flow: sympy.Symbol
    effort_sign: int
    flow_sign: int

    @property
    def own_effort(self) -> sympy.Expr:
        """The element's own effort."""
        return self.effort if self.effort_sign > 0 else -self.effort

    @property
    def own_flow(self) -> sympy.Expr:
        """The element's own flow."""
        return self.flow if self.flow_sign > 0 else -self.flow


class Wires:
    """The wires of a graph.

    ``effort[b]`` and ``flow[b]`` are the symbols of bond b; ``label`` gives the place
    that a wire is named after.
    """

    def __init__(self, graph: FinishedGraph, names: SymbolNames) -> None:
        self.graph = graph
        self.names = names
        self.nodes = graph.by_name
        self.at: dict[str, list[int]] = {node.name: [] for node in graph.nodes}
        for i, bond in enumerate(graph.bonds):
            self.at[bond.tail].append(i)
            self.at[bond.head].append(i)
        self.bond_index = {b.name: i for i, b in reversed([*enumerate(graph.bonds)])}
        self.label: dict[sympy.Symbol, str] = {}
        self.effort = self._wires("e", ZeroJunction)
        self.flow = self._wires("f", OneJunction)

    def _wires(
        self, prefix: str, junction: type[ZeroJunction] | type[OneJunction]
    ) -> list[sympy.Symbol]:
        """Return the wire of every bond; bonds at a `junction` share theirs."""
        bonds = self.graph.bonds
        wires: list[sympy.Symbol | None] = [None] * len(bonds)
        for node in self.graph.nodes:
            if not isinstance(node, junction) or wires[self.at[node.name][0]]:
                continue
            wire = self._new(prefix, node.name)
            pending = [node.name]
            while pending:
                here = pending.pop()
                for i in self.at[here]:
                    if wires[i] is None:
                        wires[i] = wire
                        there = bonds[i].other(here)
                        if isinstance(self.nodes[there], junction):
                            pending.append(there)
        return [
            self._new(prefix, self._bond_label(i)) if wire is None else wire
            for i, wire in enumerate(wires)
        ]

    def _new(self, prefix: str, label: str) -> sympy.Symbol:
        wire = self.names.symbol(f"{prefix}_{label}")
        self.label[wire] = label
        return wire

    def _bond_label(self, i: int) -> str:
        bond = self.graph.bonds[i]
        for end in (bond.tail, bond.head):
            node = self.nodes[end]
            if is_one_port(node):
                return end
            if isinstance(node, MultiPort):
                return f"{end}_{self.at[end].index(i) + 1}"
        return f"{bond.tail}_{bond.head}"

    def port(self, name: str) -> Port:
        """Return the port of the one-port called `name`."""
        (i,) = self.at[name]
        outward = isinstance(self.nodes[name], EffortSource | FlowSource)
        return self._oriented(name, i, inward=not outward)

    def ports(self, name: str) -> tuple[Port, ...]:
        """Return the ports of the field called `name`, power positive into it."""
        return tuple(self._oriented(name, i, inward=True) for i in self.at[name])

    def two_ports(self, name: str) -> tuple[Port, Port]:
        """Return ports a and b of the two-port called `name`.

        Power is positive into a and out of b. The half arrows say which is which; if
        both point in or both out, the author's first bond is a.
        """
        first, second = self.at[name]
        bonds = self.graph.bonds
        if bonds[first].tail == name and bonds[second].head == name:
            first, second = second, first
        return (
            self._oriented(name, first, inward=True),
            self._oriented(name, second, inward=False),
        )

    def _oriented(self, name: str, i: int, *, inward: bool) -> Port:
        bond = self.graph.bonds[i]
        sign = 1 if (bond.head == name) == inward else -1
        beside_zero = isinstance(self.nodes[bond.other(name)], ZeroJunction)
        effort_sign, flow_sign = (1, sign) if beside_zero else (sign, 1)
        return Port(i, self.effort[i], self.flow[i], effort_sign, flow_sign)

    def read(self, quantity: Quantity, place: str) -> tuple[sympy.Symbol, int]:
        """Return the effort (momentum) or flow (displacement) wire at `place`.

        The sign is that of the place's own convention.
        """
        is_effort = quantity in (Quantity.EFFORT, Quantity.MOMENTUM)
        node = self.nodes.get(place)
        bond = self.graph.port_bond(place)
        if bond is not None:
            port = self._oriented(
                place.partition("[")[0], self.bond_index[bond], inward=True
            )
            if is_effort:
                return port.effort, port.effort_sign
            return port.flow, port.flow_sign
        if node is None:
            i = self.bond_index[place]
        elif is_one_port(node):
            port = self.port(place)
            if is_effort:
                return port.effort, port.effort_sign
            return port.flow, port.flow_sign
        else:
            i = self.at[place][0]
        return (self.effort[i] if is_effort else self.flow[i]), 1
