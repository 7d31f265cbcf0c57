"""Expressions in states: what assigned symbols, signals and rates stand for.

The sorted equations name every intermediate result; for reading, and where a matrix is
wanted in states, the names are put back. Nothing is simplified.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import sympy

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.deriving.differentiation import TimeDerivative
from bondgraph.equations.deriving.sorting import replaced
from bondgraph.equations.deriving.wires import SymbolNames
from bondgraph.equations.reduction import reduce
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError
from bondgraph.structure.domains import Quantity
from bondgraph.structure.graph import FinishedGraph, Measurement
from bondgraph.structure.signals import Signal


class Insertion:
    """Puts assignments, solved unknowns and rates into expressions.

    What it returns is in terms of states, inputs, input rates, parameters and those
    unknowns that no formula gives.
    """

    def __init__(self, equations: StateEquations) -> None:
        reduced = reduce(equations)
        rates = [state.rate for state in equations.states]
        self._assigned: dict[sympy.Symbol, sympy.Expr] = {}
        for assignment in (*equations.assignments, *equations.further):
            self._assigned[assignment.symbol] = replaced(
                assignment.expression, self._assigned
            )
        self._solved = reduced.solutions
        self._rates = dict(zip(rates, reduced.explicit(), strict=True))

    def __call__(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with everything inserted, not simplified."""
        for by in (self._assigned, self._solved, self._rates):
            expression = replaced(expression, by)
        return expression


def signal_values(
    graph: FinishedGraph, equations: StateEquations, signals: Iterable[Signal]
) -> dict[sympy.Symbol, sympy.Expr]:
    """Return what signals that a law of `graph` reads are in its equations.

    Integrals of flows and efforts at junctions are not among the equations' signals;
    those are read through a measurement, which adds no state, because the law already
    made one.
    """
    known = equations.signals
    found = {s: known[s.quantity, s.place] for s in signals if s in _direct(known)}
    missing = [s for s in signals if s not in found]
    if missing:
        probes = tuple(Measurement(f"~{s}", s, "1") for s in missing)
        probed = derive(replace(graph, measurements=(*graph.measurements, *probes)))
        values = [output.expression for output in probed.outputs[-len(missing) :]]
        _check_same(probed, equations)
        found.update(zip(missing, values, strict=True))
    return found


def _check_same(probed: StateEquations, equations: StateEquations) -> None:
    """Refuse equations of another causality than the graph's own."""
    if probed.states != equations.states:
        raise EquationError(
            f"The equations given for {equations.name!r} have other states than those "
            f"that its own causality gives.",
            (equations.name,),
            "Leave the equations out, or derive them without a causality of your own.",
        )


def _direct(known: Mapping[tuple[Quantity, str], sympy.Expr]) -> set[Signal]:
    return {Signal(quantity, place) for quantity, place in known}


def rate_of(expression: sympy.Expr, equations: StateEquations) -> sympy.Expr:
    """Return d(expression)/dt in terms of what is assigned."""
    leaves: dict[sympy.Symbol, sympy.Expr] = {
        s.symbol: s.rate for s in equations.states
    }
    leaves.update(zip(equations.inputs, equations.input_rates, strict=True))
    unknowns = set(equations.unknowns)

    def residual_of(symbol: sympy.Symbol) -> None:
        if symbol in unknowns:
            raise EquationError(
                f"The rate of the unknown {str(symbol)!r} has no formula.",
                (str(symbol),),
                "Put a storage where it is read.",
            )

    assigned = {a.symbol: a.expression for a in equations.assignments}
    derivative = TimeDerivative(assigned, leaves, residual_of, SymbolNames())
    rate = derivative.of(expression)
    made: dict[sympy.Symbol, sympy.Expr] = {}
    for symbol, right in derivative.assignments.values():
        made[symbol] = replaced(right, made)
    return replaced(rate, made)


def in_terms_of_states(expression: sympy.Expr, equations: StateEquations) -> sympy.Expr:
    """Return `expression` with the assignments it needs, and no others, put in.

    Unknowns and rates stay; `Insertion` solves for them too, and costs more.
    """
    listed = (*equations.assignments, *equations.further)
    place = {a.symbol: i for i, a in enumerate(listed)}
    while needed := [s for s in expression.free_symbols if s in place]:
        last = max(needed, key=place.__getitem__)
        expression = expression.xreplace({last: listed[place[last]].expression})
    return expression
