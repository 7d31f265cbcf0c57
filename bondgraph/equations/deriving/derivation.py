"""Derivation: from a finished graph to its state equations.

Causality gives each wire one definition; sorting puts them in order and cuts loops;
dependent storages add unknowns whose residual is the total derivative of what they
store. Nothing is ever expanded.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import sympy

from bondgraph.causality.assignment import assign_causality
from bondgraph.causality.records import CausalAssignment
from bondgraph.equations.deriving.definitions import Definitions, reserved_names
from bondgraph.equations.deriving.differentiation import TimeDerivative
from bondgraph.equations.deriving.dry_friction import set_valued_signs
from bondgraph.equations.deriving.singularity import refuse_singular
from bondgraph.equations.deriving.sorting import (
    components,
    cut_loops,
    dependencies,
    replaced,
    without_aliases,
)
from bondgraph.equations.state_equations import Assignment, Output, StateEquations
from bondgraph.errors import EquationError
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import (
    Junction,
    ZeroJunction,
    is_one_port,
    letter,
)
from bondgraph.structure.fields import MultiPort
from bondgraph.structure.graph import FinishedGraph, Wanted
from bondgraph.structure.signals import parameter_symbol, t


@dataclass(frozen=True, slots=True)
class _Unknown:
    """An algebraic unknown's residual, why it is one, and the elements it is due to."""

    residual: sympy.Expr
    reason: str
    elements: tuple[str, ...]


def derive(
    graph: FinishedGraph, *, causality: CausalAssignment | None = None
) -> StateEquations:
    """Return the state equations of `graph`.

    The states are the momentum of each I and the displacement of each C in integral
    causality, and the integral of each flow (effort) that a displacement (momentum)
    signal reads and no storage holds. Free symbols of the result are states, rates,
    inputs, input rates, unknowns, parameters, t and assigned symbols.

    Parameters
    ----------
    causality
        The strokes to use instead of those that `assign_causality` gives.

    Raises
    ------
    CausalConflictError
        If no causality satisfies every element.
    EquationError
        If a law has no inverse where one is needed, or the graph is singular.
    """
    causality = assign_causality(graph) if causality is None else causality
    return _Derivation(graph, causality).equations()


class _Derivation:
    """The steps of one derivation, each reading what those before it left."""

    def __init__(self, graph: FinishedGraph, causality: CausalAssignment) -> None:
        self.graph = graph
        names = self.names = reserved_names(graph)
        self.definitions = Definitions(graph, causality, names)
        self.outputs = [
            (m, self.definitions.memory.in_wires(m.expression))
            for m in graph.measurements
        ]
        kept, self.aliases = without_aliases(self.definitions.given)
        self.dry = set_valued_signs(self.definitions, kept, self.aliases)
        self.given = {s: d.expression for s, d in kept.items()}
        self.why = {s: f"{d.reason} ({d.origin})" for s, d in kept.items()}
        self.origin = {s: d.origin for s, d in kept.items()}
        self.inputs = self.definitions.inputs
        self.input_rates = {
            symbol: names.symbol(f"d{symbol.name}") for symbol in self.inputs.values()
        }
        self.unknowns: dict[sympy.Symbol, _Unknown] = {}
        self.order = self._sort(causality)
        self.spares_possible = True
        self._differentiate()

    def _sort(self, causality: CausalAssignment) -> list[sympy.Symbol]:
        """Order the definitions; cut wires and laws without a formula are unknowns."""
        free = {name.partition("[")[0] for name in causality.arbitrary}
        liked = [s for s, d in self.definitions.given.items() if d.origin in free]
        order, cut = cut_loops(dependencies(self.given), liked)
        for symbol, loop in cut.items():
            residual = symbol - self.given.pop(symbol)
            self.unknowns[symbol] = self._in_loop(residual, loop)
        for implicit in self.definitions.implicit.values():
            residual = replaced(implicit.residual, self.aliases)
            self.unknowns[implicit.symbol] = _Unknown(
                residual, implicit.reason, (implicit.origin,)
            )
        return order

    def _in_loop(
        self, residual: sympy.Expr, loop: tuple[sympy.Symbol, ...]
    ) -> _Unknown:
        """Return the unknown that opens a loop, with the elements in it."""
        nodes = self.definitions.wires.nodes
        origins = sorted({self.definitions.given[symbol].origin for symbol in loop})
        elements = [name for name in origins if not isinstance(nodes[name], Junction)]
        named = [f"{letter(nodes[name])} {name!r}" for name in elements]
        through = ", ".join(named or map(repr, origins))
        reason = f"algebraic loop through {through}"
        return _Unknown(residual, reason, tuple(elements or origins))

    def _differentiate(self) -> None:
        """Add the residuals of dependent storages."""
        states = self.definitions.memory.states
        leaves: dict[sympy.Symbol, sympy.Expr] = {s.symbol: s.rate for s in states}
        leaves.update(self.input_rates)
        derivative = TimeDerivative(self.given, leaves, self._residual_of, self.names)
        for dependent in self.definitions.dependent.values():
            stored = replaced(dependent.stored, self.aliases)
            own = replaced(dependent.own, self.aliases)
            residual = own - derivative.of(stored)
            self.unknowns[dependent.symbol] = _Unknown(
                residual, dependent.reason, (dependent.origin,)
            )
        for rate, residual in derivative.residuals().items():
            reason = f"{rate} is a rate that a dependent storage follows"
            followed = self.unknowns[derivative.source_of(rate)].elements
            self.unknowns[rate] = _Unknown(residual, reason, followed)
            self.spares_possible = False
        for source, (symbol, expression) in derivative.assignments.items():
            self.given[symbol] = expression
            self.why[symbol] = f"rate of {source}"
            self.order.append(symbol)

    def _residual_of(self, symbol: sympy.Symbol) -> sympy.Expr | None:
        """Return the residual of an unknown that may be differentiated."""
        dependent = self.definitions.dependent.get(symbol)
        if dependent is not None:
            wished = any(
                p.element.partition("[")[0] == dependent.origin
                and p.wanted is Wanted.DERIVATIVE
                for p in self.graph.preferences
            )
            raise EquationError(
                f"The equations need the rate of {str(symbol)!r}, which itself follows "
                f"from a rate: {dependent.reason}, and another dependent storage "
                f"follows it.",
                (dependent.origin,),
                f"Drop the wish that {dependent.origin!r} be derivative."
                if wished
                else "Put an R or a C (an I) between the two, as every real part has.",
            )
        if symbol in self.unknowns:
            return self.unknowns[symbol].residual
        return None

    def equations(self) -> StateEquations:
        """Return the record, with what nothing needs put aside."""
        rates = tuple(
            replaced(rate, self.aliases) for rate in self.definitions.memory.rates
        )
        outputs = tuple(
            Output(m.name, replaced(expression, self.aliases), m.unit)
            for m, expression in self.outputs
        )
        spare = self._spare_unknowns([*rates, *(o.expression for o in outputs)])
        unknowns = [s for s in self.unknowns if s not in spare]
        residuals = tuple(self.unknowns[s].residual for s in unknowns)
        needed = self._needed([*rates, *residuals, *(o.expression for o in outputs)])
        listed = [s for s in self.order if s in needed]
        equations = StateEquations(
            name=self.graph.name,
            states=tuple(self.definitions.memory.states),
            inputs=tuple(self.inputs.values()),
            input_rates=tuple(self.input_rates.values()),
            parameters=tuple(parameter_symbol(p) for p in self.graph.parameters),
            unknowns=tuple(unknowns),
            assignments=tuple(self._assignment(s) for s in listed),
            rates=rates,
            residuals=residuals,
            outputs=outputs,
            input_units=tuple(self.graph.input_unit(name) for name in self.inputs),
            reasons=tuple(self.unknowns[s].reason for s in unknowns),
            causes=tuple(self.unknowns[s].elements for s in unknowns),
            further=tuple(map(self._assignment, self._further(spare, needed))),
            signals=self._signals(),
            dry_friction=self.dry,
        )
        _check_symbols(equations)
        refuse_singular(equations)
        return equations

    def _further(
        self, spare: list[sympy.Symbol], needed: set[sympy.Symbol]
    ) -> list[sympy.Symbol]:
        """Return in order the symbols that nothing needs; `spare` become explicit."""
        for symbol in spare:
            unknown = self.unknowns[symbol]
            sign = self.definitions.dependent[symbol].own.coeff(symbol)
            self.given[symbol] = symbol - sign * unknown.residual
            self.why[symbol] = unknown.reason
        rest = {s: x for s, x in self.given.items() if s not in needed}
        return [s for (s,) in components(dependencies(rest), rest, set())]

    def _assignment(self, symbol: sympy.Symbol) -> Assignment:
        origin = self.origin.get(symbol, "")
        return Assignment(symbol, self.given[symbol], self.why.get(symbol, ""), origin)

    def _needed(self, roots: Iterable[sympy.Expr]) -> set[sympy.Symbol]:
        """Return the assigned symbols and unknowns that `roots` need."""
        needed: set[sympy.Symbol] = set()
        pending = [s for root in roots for s in root.free_symbols]
        while pending:
            symbol = pending.pop()
            if symbol not in needed and (
                symbol in self.given or symbol in self.unknowns
            ):
                needed.add(symbol)
                if symbol in self.given:
                    pending.extend(self.given[symbol].free_symbols)
                else:
                    pending.extend(self.unknowns[symbol].residual.free_symbols)
        return needed

    def _spare_unknowns(self, roots: list[sympy.Expr]) -> list[sympy.Symbol]:
        """Return the dependent storages' efforts (flows) that nothing needs.

        They are explicit in the rates, so they can follow after everything else.
        """
        if not self.spares_possible:
            return []
        loops = [
            unknown.residual
            for symbol, unknown in self.unknowns.items()
            if symbol not in self.definitions.dependent
        ]
        needed = self._needed([*roots, *loops])
        return [
            s
            for s in self.definitions.dependent
            if s not in needed and s in self.unknowns
        ]

    def _signals(self) -> Mapping[tuple[Quantity, str], sympy.Expr]:
        """Return every port variable in terms of what is assigned."""
        wires = self.definitions.wires
        found: dict[tuple[Quantity, str], sympy.Expr] = {}

        def put(place: str, effort: sympy.Expr, flow: sympy.Expr) -> None:
            found[Quantity.EFFORT, place] = replaced(effort, self.aliases)
            found[Quantity.FLOW, place] = replaced(flow, self.aliases)

        for i, bond in enumerate(self.graph.bonds):
            put(bond.name, wires.effort[i], wires.flow[i])
        for node in self.graph.nodes:
            if is_one_port(node):
                port = wires.port(node.name)
                put(node.name, port.own_effort, port.own_flow)
            elif isinstance(node, MultiPort):
                for k, port in enumerate(wires.ports(node.name)):
                    put(node.port(k + 1), port.own_effort, port.own_flow)
            elif isinstance(node, ZeroJunction):
                effort = wires.effort[wires.at[node.name][0]]
                found[Quantity.EFFORT, node.name] = replaced(effort, self.aliases)
            elif letter(node) == "1":
                flow = wires.flow[wires.at[node.name][0]]
                found[Quantity.FLOW, node.name] = replaced(flow, self.aliases)
        memory = self.definitions.memory
        for storage in memory.ports.values():
            momentum = storage.is_momentum
            kind = Quantity.MOMENTUM if momentum else Quantity.DISPLACEMENT
            stored = replaced(memory.stored(storage.name), self.aliases)
            found[kind, storage.name] = stored
        return found


def _check_symbols(equations: StateEquations) -> None:
    """Assert that nothing leaks: every symbol read is known where it is read."""
    known = {t, *equations.inputs, *equations.input_rates}
    known.update(equations.parameters, equations.unknowns)
    known.update(s.symbol for s in equations.states)
    known.update(s.rate for s in equations.states)
    for assignment in (*equations.assignments, *equations.further):
        leaked = assignment.expression.free_symbols - known
        assert not leaked, f"{assignment.symbol} reads unknown {leaked}"
        known.add(assignment.symbol)
    read = (
        *equations.rates,
        *equations.residuals,
        *(output.expression for output in equations.outputs),
        *equations.signals.values(),
    )
    for expression in read:
        leaked = expression.free_symbols - known
        assert not leaked, f"{expression} reads unknown {leaked}"
