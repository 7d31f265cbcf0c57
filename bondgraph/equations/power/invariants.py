"""First integrals and redundant states: what stays constant whatever the laws are.

Junctions and constant two-ports bind the efforts and flows of a graph by linear
equations. Where those alone make a combination of the storages' rates vanish, the
same combination of what they store never changes: momentum, charge, the difference
of two displacements that move together. All other variables are eliminated from the
equations, the least entangled first, so that in a chain nothing fills in; what is
left are the combinations, exact in the parameters. Laws are never asked, and a modulus
that moves binds nothing.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import sympy

from bondgraph.equations.algebra.elimination import Row, eliminated, reduced, total
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.deriving.wires import SymbolNames, Wires
from bondgraph.equations.insertion import in_terms_of_states
from bondgraph.equations.power.energy import energy
from bondgraph.equations.state_equations import State, StateEquations
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Gyrator,
    Inertance,
    Junction,
    OneJunction,
    Resistance,
    Storage,
    Transformer,
    is_modulated,
)
from bondgraph.structure.fields import ResistanceField, StorageField
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import as_expression, t


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstIntegral:
    """A combination of states that keeps its initial value.

    Parameters
    ----------
    expression
        The combination, in states, parameters and (of a dependent storage without a
        formula) unknowns.
    places
        The storages and integrated measurements in it.
    word
        What it is called: momentum, charge, …, combination.
    """

    expression: sympy.Expr
    places: tuple[str, ...]
    word: str

    @property
    def statement(self) -> str:
        """The integral in words."""
        return (
            f"The {self.word} {self.expression} is conserved: the structure makes the "
            f"rates at {', '.join(self.places)} cancel, whatever the laws are."
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RedundantState:
    """A state that follows others.

    Parameters
    ----------
    through
        An expression of other states from which it differs by a constant, its initial
        value less that of the expression.
    """

    state: str
    through: sympy.Expr

    @property
    def statement(self) -> str:
        """The same in words."""
        return f"{self.state} follows {self.through}: the two differ by a constant."


@dataclass(frozen=True, slots=True, kw_only=True)
class Invariants:
    """What stays constant in a model, and which states it could do without.

    Parameters
    ----------
    first_integrals
        A basis of the combinations that the structure keeps constant.
    redundant
        States that differ from a combination of others by a constant.
    measured_only
        States that measurements read and no rate does: they change nothing.
    unread
        States that neither a rate nor a measurement reads.
    energy
        The total energy where it is constant: nothing supplies, dissipates or
        exchanges power. Else None.
    """

    name: str
    first_integrals: tuple[FirstIntegral, ...]
    redundant: tuple[RedundantState, ...]
    measured_only: tuple[str, ...]
    unread: tuple[str, ...]
    energy: sympy.Expr | None

    def as_text(self) -> str:
        """Return what was found as plain text, one sentence per line."""
        lines = [f"  {i.statement}" for i in self.first_integrals]
        lines += [f"  {r.statement}" for r in self.redundant]
        lines += [
            f"  {name} is read by measurements only." for name in self.measured_only
        ]
        lines += [f"  {name} is read by nothing." for name in self.unread]
        if self.energy is not None:
            lines.append(f"  The energy {self.energy} is constant.")
        return "\n".join(["invariants", *(lines or ["  none"])]) + "\n"

    def as_latex(self) -> str:
        """Return the first integrals as a LaTeX ``aligned`` block."""
        found = [i.expression for i in self.first_integrals]
        if self.energy is not None:
            found.append(self.energy)
        if not found:
            return r"\text{no first integral}"
        lines = [rf"{sympy.latex(x)} &= \text{{const}}" for x in found]
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.as_latex()}$"


def invariants(
    graph: FinishedGraph, equations: StateEquations | None = None
) -> Invariants:
    """Return the first integrals of `graph` and its redundant states.

    Found are the integrals that are linear in what is stored and hold whatever the
    laws of storages, resistances and sources are; and the energy where it is constant.

    Parameters
    ----------
    equations
        The state equations of this graph, where they have been derived before.

    Raises
    ------
    CausalConflictError, EquationError
        If the graph has no state equations.
    """
    equations = derive(graph) if equations is None else equations
    held = _Held(graph, equations)
    rows = reduced(eliminated(held.rows, set(held.contents)), held.contents)
    states = {s.symbol for s in equations.states}
    measured_only, unread = _without_effect(equations)
    return Invariants(
        name=graph.name,
        first_integrals=tuple(held.first_integral(row) for row in rows.values()),
        redundant=tuple(
            held.redundant(pivot, row)
            for pivot, row in rows.items()
            if len(row) > 1 and all(held.contents[x] in states for x in row)
        ),
        measured_only=measured_only,
        unread=unread,
        energy=_constant_energy(graph, equations),
    )


class _Held:
    """Everything that is stored or integrated, and the equations that bind the rates.

    ``contents`` gives for the symbol of each rate what it is the rate of, first those
    that are best expressed through others: integrals that no storage holds, then what
    the author wrote last.
    """

    def __init__(self, graph: FinishedGraph, equations: StateEquations) -> None:
        self.graph = graph
        self.equations = equations
        self.wires = Wires(graph, SymbolNames())
        self.rows: list[Row] = []
        self.contents: dict[sympy.Symbol, sympy.Expr] = {}
        self.place: dict[sympy.Symbol, str] = {}
        self.quantity: dict[sympy.Symbol, Quantity] = {}
        ports = self._storage_ports()
        for state in equations.states:
            if state.place not in ports:
                self._add_integral(state)
        for name, (quantity, rate) in reversed(ports.items()):
            self._add(name, quantity, rate, equations.signal(quantity, name))
        for node in graph.nodes:
            if isinstance(node, Junction):
                self._balance(node)
            elif isinstance(node, Transformer | Gyrator) and not _moves(node):
                self._two_port(node)

    def _storage_ports(self) -> dict[str, tuple[Quantity, sympy.Expr]]:
        """Return for every storing port what it stores and the rate of that."""
        found = {}
        for node in self.graph.nodes:
            if isinstance(node, Storage):
                ports = [
                    (node.name, isinstance(node, Inertance), self.wires.port(node.name))
                ]
            elif isinstance(node, StorageField):
                ports = [
                    (node.port(i + 1), node.stored[i].letter == "p", port)
                    for i, port in enumerate(self.wires.ports(node.name))
                ]
            else:
                continue
            for name, is_momentum, port in ports:
                quantity = Quantity.MOMENTUM if is_momentum else Quantity.DISPLACEMENT
                rate = port.own_effort if is_momentum else port.own_flow
                found[name] = (quantity, rate)
        return found

    def _add_integral(self, state: State) -> None:
        """Add a state that no storage holds, named after the wire it integrates."""
        quantity = state.quantity
        wires = self.wires.effort if state.is_momentum else self.wires.flow
        wire = next(w for w in wires if self.wires.label[w] == state.place)
        node = self.graph.by_name.get(state.place)
        sign = 1
        if node is not None and not isinstance(node, Junction):
            sign = self.wires.read(quantity, state.place)[1]
        self._add(state.place, quantity, sign * wire, state.symbol)

    def _add(
        self, place: str, quantity: Quantity, rate: sympy.Expr, content: sympy.Expr
    ) -> None:
        symbol = sympy.Dummy(place)
        self.contents[symbol] = content
        self.place[symbol] = place
        self.quantity[symbol] = quantity
        self.rows.append(_row([(1, symbol), (-1, rate)]))

    def _balance(self, junction: Junction) -> None:
        one = isinstance(junction, OneJunction)
        wires = self.wires.effort if one else self.wires.flow
        bonds = self.graph.bonds
        self.rows.append(
            _row(
                (1 if bonds[i].head == junction.name else -1, wires[i])
                for i in self.wires.at[junction.name]
            )
        )

    def _two_port(self, node: Transformer | Gyrator) -> None:
        a, b = self.wires.two_ports(node.name)
        k = node.modulus
        if isinstance(node, Transformer):
            pairs = ((b.own_effort, a.own_effort), (a.own_flow, b.own_flow))
        else:
            pairs = ((b.own_effort, a.own_flow), (a.own_effort, b.own_flow))
        self.rows.extend(_row([(1, left), (-k, right)]) for left, right in pairs)

    def first_integral(self, row: Row) -> FirstIntegral:
        combination = sympy.Add(*(x * self.contents[s] for s, x in row.items()))
        expression = in_terms_of_states(combination, self.equations)
        places = tuple(self.place[s] for s in reversed(self.contents) if s in row)
        words = {
            self.graph.domain_at(_owner(self.place[s])).word(self.quantity[s])
            for s in row
            if self.graph.has_place(_owner(self.place[s]))
        }
        word = words.pop() if len(words) == 1 else "combination"
        return FirstIntegral(expression=expression, places=places, word=word)

    def redundant(self, pivot: sympy.Symbol, row: Row) -> RedundantState:
        terms = (-x * self.contents[s] for s, x in row.items() if s != pivot)
        return RedundantState(
            state=str(self.contents[pivot]), through=sympy.Add(*terms)
        )


def _owner(place: str) -> str:
    """Return the node that a place such as ``field[1]`` belongs to."""
    return place.split("[", maxsplit=1)[0]


def _moves(node: Transformer | Gyrator) -> bool:
    return is_modulated(node.law) or t in node.modulus.free_symbols


def _row(terms: Iterable[tuple[sympy.Expr | int, sympy.Expr]]) -> Row:
    """Return the row of ``Σ factor · (± symbol)``."""
    row: Row = {}
    for factor, signed in terms:
        (symbol,) = signed.free_symbols
        value = as_expression(factor) if signed.is_Symbol else -as_expression(factor)
        row[symbol] = total(row.get(symbol, sympy.S.Zero), value)
    return {symbol: value for symbol, value in row.items() if value != 0}


def _without_effect(
    equations: StateEquations,
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the states that only measurements read, and those that nothing reads."""
    given = {a.symbol: a.expression for a in equations.assignments}
    by_dynamics = _read(given, {*equations.rates, *equations.residuals})
    by_outputs = _read(given, {o.expression for o in equations.outputs})
    names = [s.symbol for s in equations.states if s.symbol not in by_dynamics]
    return (
        tuple(s.name for s in names if s in by_outputs),
        tuple(s.name for s in names if s not in by_outputs),
    )


def _read(
    given: Mapping[sympy.Symbol, sympy.Expr], roots: Iterable[sympy.Expr]
) -> set[sympy.Symbol]:
    """Return every symbol that the roots depend on through assignments."""
    found: set[sympy.Symbol] = set()
    pending = [s for root in roots for s in root.free_symbols]
    while pending:
        symbol = pending.pop()
        if symbol not in found:
            found.add(symbol)
            if symbol in given:
                pending.extend(given[symbol].free_symbols)
    return found


def _constant_energy(
    graph: FinishedGraph, equations: StateEquations
) -> sympy.Expr | None:
    """Return the energy where nothing can change it."""
    changing = EffortSource | FlowSource | Resistance | ResistanceField
    storages = [n for n in graph.nodes if isinstance(n, Storage | StorageField)]
    if not storages or any(isinstance(n, changing) for n in graph.nodes):
        return None
    balance = energy(graph, equations)
    if not balance.is_closed or balance.total == 0:
        return None
    return in_terms_of_states(balance.total, equations)
