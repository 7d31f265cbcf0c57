"""First-order form before anything is eliminated: ``E ξ' = A ξ + B u + B_rate u̇``.

ξ holds the states and the algebraic unknowns. Each row is one law's chain rule; solving
for the unknowns would multiply every entry by the inverse of a mass matrix or of a
resistive mesh, which costs minutes and pages where this costs milliseconds.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy

from bondgraph.equations.algebra.rational import Row, in_lowest_terms
from bondgraph.equations.chain_rule import propagate, row_of, seeded
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.steady_state import SteadyState
from bondgraph.equations.transfer.closed_form import (
    all_closed_forms,
    chosen,
    closed_form,
)
from bondgraph.equations.transfer.operating_point import OperatingPoint
from bondgraph.equations.transfer.pencil import Pencil
from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.equations.transfer.transfer_matrix import TransferMatrix


@dataclass(frozen=True, slots=True, kw_only=True)
class DescriptorSystem:
    """``E ξ' = A ξ + B u + B_rate u̇`` and ``y = C ξ + D u + D_rate u̇``.

    ξ is `states` and then `unknowns`; E is singular where there are unknowns. For a
    nonlinear model all are deviations from the operating point.
    """

    name: str
    states: tuple[str, ...]
    unknowns: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    E: sympy.ImmutableSparseMatrix
    A: sympy.ImmutableSparseMatrix
    B: sympy.ImmutableSparseMatrix
    C: sympy.ImmutableSparseMatrix
    D: sympy.ImmutableSparseMatrix
    B_rate: sympy.ImmutableSparseMatrix
    D_rate: sympy.ImmutableSparseMatrix

    def transfer_function(
        self,
        output: str | None = None,
        input: str | None = None,  # noqa: A002
    ) -> TransferFunction:
        """Return the transfer function from `input` to `output`.

        Either may be left out where there is only one.

        Raises
        ------
        EquationError
            If there is no such signal, the closed form has too many terms, or the
            unknowns are not determined.
        """
        row = chosen(output, self.outputs, "output", self.name)
        column = chosen(input, self.inputs, "input", self.name)
        return self._transfer(self._pencil(), row, column)

    def transfer_matrix(self) -> TransferMatrix:
        """Return the transfer functions of all outputs and inputs."""
        pencil = self._pencil()
        return all_closed_forms(
            self.name,
            self.outputs,
            self.inputs,
            lambda i, j: self._transfer(pencil, i, j),
        )

    def _pencil(self) -> Pencil:
        return Pencil(
            constant={place: -value for place, value in self.A.todok().items()},
            linear=self.E.todok(),
            right=self.B.todok(),
            right_rate=self.B_rate.todok(),
            read=self.C.todok(),
            direct=self.D.todok(),
            direct_rate=self.D_rate.todok(),
        )

    def _transfer(self, pencil: Pencil, row: int, column: int) -> TransferFunction:
        return closed_form(
            pencil,
            (row, column),
            self._coupled(row, column),
            (self.outputs[row], self.inputs[column]),
        )

    def _coupled(self, row: int, column: int) -> list[int]:
        """Return the output's variables, and those that the input moves."""
        near: dict[int, set[int]] = {}
        for i, j in {*self.A.todok(), *self.E.todok()}:
            near.setdefault(j, set()).add(i)
        pending = [j for i, j in self.C.todok() if i == row]
        inputs = {*self.B.todok(), *self.B_rate.todok()}
        pending += [i for i, j in inputs if j == column]
        seen: set[int] = set()
        while pending:
            here = pending.pop()
            if here not in seen:
                seen.add(here)
                pending.extend(near.get(here, ()))
        return sorted(seen)


@dataclass(frozen=True, slots=True)
class FirstOrder:
    """Rows of rates, residuals (with ẋ) and outputs, along x, z, u and u̇."""

    rates: tuple[Row, ...]
    residuals: tuple[Row, ...]
    outputs: tuple[Row, ...]


def first_order(equations: StateEquations, at: OperatingPoint) -> FirstOrder:
    """Return the chain rule's rows; nothing is solved for, ẋ stays in residuals."""
    one = sympy.S.One
    states = [state.symbol for state in equations.states]
    symbols = [state.rate for state in equations.states]
    leaves = (*states, *equations.inputs, *equations.input_rates)
    rows = seeded((*leaves, *equations.unknowns), one)
    early, late = equations.around_rates()
    propagate(rows, early, at)
    rates = [row_of(rate, rows, at) for rate in equations.rates]
    rows.update(seeded(symbols, one))
    propagate(rows, late, at)
    known = dict(zip(symbols, rates, strict=True))
    _refuse_jumps(equations, at, rows)
    return FirstOrder(
        tuple(rates),
        tuple(row_of(residual, rows, at) for residual in equations.residuals),
        tuple(
            substituted(row_of(output.expression, rows, at), known)
            for output in equations.outputs
        ),
    )


def _refuse_jumps(
    equations: StateEquations, at: OperatingPoint, rows: Mapping[sympy.Symbol, Row]
) -> None:
    expressions = {str(a.symbol): a.expression for a in equations.assignments}
    expressions |= {o.name: o.expression for o in equations.outputs}
    for state, rate in zip(equations.states, equations.rates, strict=True):
        expressions[f"the rate of {state.symbol}"] = rate
    for unknown, residual in zip(equations.unknowns, equations.residuals, strict=True):
        expressions[str(unknown)] = residual
    for name, expression in expressions.items():
        if any(symbol in rows for symbol in expression.free_symbols):
            at.refuse_jump(expression, name)


def substituted(row: Row, solutions: Mapping[sympy.Symbol, Row]) -> Row:
    """Return `row` with symbols replaced by the rows that they are."""
    if not any(key in solutions for key in row):
        return row
    total: dict[sympy.Symbol, list[sympy.Expr]] = {}
    for key, value in row.items():
        for leaf, factor in solutions.get(key, {key: sympy.S.One}).items():
            total.setdefault(leaf, []).append(value * factor)
    return {leaf: in_lowest_terms(terms) for leaf, terms in total.items()}


def smooth(row: Row, at: OperatingPoint, of: str) -> Row:
    """Return `row` with the same slopes on every side of a kink, or refuse."""
    return {leaf: at.smooth(value, of) for leaf, value in row.items()}


def matrix(
    rows: Sequence[Row], columns: Sequence[sympy.Symbol]
) -> sympy.ImmutableSparseMatrix:
    """Return the matrix with these rows in the order of `columns`."""
    place = {symbol: j for j, symbol in enumerate(columns)}
    entries = {
        (i, place[symbol]): value
        for i, row in enumerate(rows)
        for symbol, value in row.items()
        if symbol in place and value != 0
    }
    return sympy.ImmutableSparseMatrix(len(rows), len(columns), entries)


def descriptor(
    equations: StateEquations, at: Mapping[str, object] | SteadyState | None = None
) -> DescriptorSystem:
    """Return ``E ξ' = A ξ + B u`` around an operating point; see `linearise`.

    Nothing is solved for, so it costs no more than the number of laws.

    Raises
    ------
    EquationError
        If a law has no derivative at the operating point.
    """
    point = OperatingPoint(equations, at)
    found = first_order(equations, point)
    states = [state.symbol for state in equations.states]
    rates = [state.rate for state in equations.states]
    variables = [*states, *equations.unknowns]
    rows = [
        smooth(row, point, f"the rate of {state}")
        for state, row in zip(states, found.rates, strict=True)
    ]
    rows += [
        smooth(row, point, f"the equation of {unknown}")
        for unknown, row in zip(equations.unknowns, found.residuals, strict=True)
    ]
    outputs = [
        smooth(row, point, f"the output {output.name!r}")
        for output, row in zip(equations.outputs, found.outputs, strict=True)
    ]
    moved = [{rate: sympy.S.One} for rate in rates]
    moved += [
        {symbol: -value for symbol, value in row.items()} for row in rows[len(rates) :]
    ]
    unmoved = [*rates, *(sympy.Dummy() for _ in equations.unknowns)]
    return DescriptorSystem(
        name=equations.name,
        states=tuple(x.name for x in states),
        unknowns=tuple(z.name for z in equations.unknowns),
        inputs=tuple(u.name for u in equations.inputs),
        outputs=tuple(output.name for output in equations.outputs),
        E=matrix(moved, unmoved),
        A=matrix(rows, variables),
        B=matrix(rows, equations.inputs),
        C=matrix(outputs, variables),
        D=matrix(outputs, equations.inputs),
        B_rate=matrix(rows, equations.input_rates),
        D_rate=matrix(outputs, equations.input_rates),
    )
