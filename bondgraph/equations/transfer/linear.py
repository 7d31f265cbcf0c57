"""Linear systems ``ẋ = A x + B u, y = C x + D u`` with symbolic parameters.

The matrices come from the chain rule through the sorted assignments; the unknowns are
solved for in a field of rational functions. Where an input is differentiated (a source
that sets a storage), ``B_rate`` and ``D_rate`` multiply u̇.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import sympy

from bondgraph.equations.algebra.rational import Row, solved
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.state_equations import StateEquations
from bondgraph.equations.steady_state import SteadyState
from bondgraph.equations.transfer.closed_form import (
    all_closed_forms,
    chosen,
    closed_form,
)
from bondgraph.equations.transfer.descriptor import (
    first_order,
    matrix,
    smooth,
    substituted,
)
from bondgraph.equations.transfer.operating_point import OperatingPoint
from bondgraph.equations.transfer.pencil import Pencil
from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.equations.transfer.transfer_matrix import TransferMatrix
from bondgraph.structure.graph import FinishedGraph


class Form(StrEnum):
    """How a linear system may be written."""

    STATE_SPACE = "state space"
    DESCRIPTOR = "descriptor"


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearSystem:
    """``ẋ = A x + B u + B_rate u̇`` and ``y = C x + D u + D_rate u̇``.

    ``states``, ``inputs`` and ``outputs`` are the names of the rows and columns. For a
    nonlinear model x, u and y are deviations from the operating point. ``terms`` counts
    the terms of all entries, ``descriptor_terms`` those before the unknowns were
    eliminated.
    """

    name: str
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    A: sympy.ImmutableSparseMatrix
    B: sympy.ImmutableSparseMatrix
    C: sympy.ImmutableSparseMatrix
    D: sympy.ImmutableSparseMatrix
    B_rate: sympy.ImmutableSparseMatrix
    D_rate: sympy.ImmutableSparseMatrix
    terms: int = 0
    descriptor_terms: int = 0

    @property
    def sparser(self) -> Form:
        """The form that says the same in fewer terms; see `descriptor`."""
        if self.descriptor_terms < self.terms:
            return Form.DESCRIPTOR
        return Form.STATE_SPACE

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
            If there is no such signal, or the closed form has too many terms.
        """
        row = chosen(output, self.outputs, "output", self.name)
        column = chosen(input, self.inputs, "input", self.name)
        return self._transfer(self._pencil(), row, column)

    def transfer_matrix(self) -> TransferMatrix:
        """Return the transfer functions of all outputs and inputs.

        They share one characteristic polynomial per coupled part of the system.

        Raises
        ------
        EquationError
            If one of them has too many terms for a closed form.
        """
        pencil = self._pencil()
        return all_closed_forms(
            self.name,
            self.outputs,
            self.inputs,
            lambda i, j: self._transfer(pencil, i, j),
        )

    def _pencil(self) -> Pencil:
        """Return ``(sI - A) x = (B + s B_rate) u`` and the outputs."""
        size = len(self.states)
        return Pencil(
            constant={place: -value for place, value in self.A.todok().items()},
            linear={(i, i): sympy.S.One for i in range(size)},
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
            self._between(row, column),
            (self.outputs[row], self.inputs[column]),
        )

    def _between(self, row: int, column: int) -> list[int]:
        """Return the states that the input reaches and that reach the output."""
        forward: dict[int, list[int]] = {}
        backward: dict[int, list[int]] = {}
        for i, j in self.A.todok():
            forward.setdefault(j, []).append(i)
            backward.setdefault(i, []).append(j)
        inputs = {*self.B.todok(), *self.B_rate.todok()}
        started = [i for i, j in inputs if j == column]
        ended = [j for i, j in self.C.todok() if i == row]
        return sorted(_reached(started, forward) & _reached(ended, backward))


def _reached(start: list[int], edges: Mapping[int, list[int]]) -> set[int]:
    seen: set[int] = set()
    pending = list(start)
    while pending:
        node = pending.pop()
        if node not in seen:
            seen.add(node)
            pending.extend(edges.get(node, ()))
    return seen


def linearise(
    equations: StateEquations | FinishedGraph,
    at: Mapping[str, object] | SteadyState | None = None,
) -> LinearSystem:
    """Return the linear system around an operating point.

    Parameters
    ----------
    equations
        Or the finished graph that they are derived from.
    at
        Values (numbers or expressions of parameters) of states, inputs and ``t`` by
        name at the operating point, zero where not named, or what `steady_state`
        found. A linear model needs none.

    Raises
    ------
    EquationError
        If a law has no derivative at the operating point (a kink whose two sides
        differ, a jump).
    """
    if isinstance(equations, FinishedGraph):
        equations = derive(equations)
    point = OperatingPoint(equations, at)
    raw = first_order(equations, point)
    states = [state.symbol for state in equations.states]
    rates = [state.rate for state in equations.states]
    solutions = _solved(raw.rates, raw.residuals, rates, equations.unknowns)
    found = [
        smooth(solutions[rate], point, f"the rate of {state}")
        for state, rate in zip(states, rates, strict=True)
    ]
    outputs = [
        smooth(substituted(row, solutions), point, f"the output {output.name!r}")
        for output, row in zip(equations.outputs, raw.outputs, strict=True)
    ]
    return LinearSystem(
        name=equations.name,
        states=tuple(x.name for x in states),
        inputs=tuple(u.name for u in equations.inputs),
        outputs=tuple(o.name for o in equations.outputs),
        A=matrix(found, states),
        B=matrix(found, equations.inputs),
        C=matrix(outputs, states),
        D=matrix(outputs, equations.inputs),
        B_rate=matrix(found, equations.input_rates),
        D_rate=matrix(outputs, equations.input_rates),
        terms=_terms([*found, *outputs]),
        descriptor_terms=_terms([*raw.rates, *raw.residuals, *raw.outputs]),
    )


def _terms(rows: Iterable[Row]) -> int:
    """Return how many terms all entries have together."""
    return sum(
        len(sympy.Add.make_args(part))
        for row in rows
        for value in row.values()
        for part in value.as_numer_denom()
        if part != 1
    )


def _solved(
    rates: Sequence[Row],
    residuals: Sequence[Row],
    rate_symbols: Sequence[sympy.Symbol],
    unknowns: Sequence[sympy.Symbol],
) -> dict[sympy.Symbol, Row]:
    """Return rates and unknowns in states and inputs.

    Both are solved for together: what couples many dependent storages is one rate, and
    inserted first it would fill the matrix in.
    """
    known = {*rate_symbols, *unknowns}
    rows = [
        {**{k: -v for k, v in row.items()}, rate: 1 - row.get(rate, sympy.S.Zero)}
        for rate, row in zip(rate_symbols, rates, strict=True)
    ]
    rows += residuals
    matrix = [{k: v for k, v in row.items() if k in known} for row in rows]
    right = [{k: -v for k, v in row.items() if k not in known} for row in rows]
    return solved(matrix, [*rate_symbols, *unknowns], right)
