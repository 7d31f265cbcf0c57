"""Refusal of graphs whose unknowns are not determined, whatever the parameters.

The residuals must fix the unknowns: the matrix of their sensitivities, with the rates
put in, must have full rank. It is evaluated at arbitrary numbers for every symbol, so
that only a structural defect (a ring with unit gain, a constraint given twice) shows.
"""

from itertools import count
from typing import Any

import sympy

from bondgraph.equations.chain_rule import Row, propagate, row_of, seeded
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError

GOLDEN = 0.6180339887498949
TINY = 1e-9


def refuse_singular(equations: StateEquations) -> None:
    """Raise EquationError if the residuals cannot determine the unknowns."""
    if not equations.unknowns:
        return
    evaluate = _Somewhere()
    rows = seeded(equations.unknowns, 1.0)
    early, late = equations.around_rates()
    rows = propagate(rows, early, evaluate)
    for state, rate in zip(equations.states, equations.rates, strict=True):
        row = row_of(rate, rows, evaluate)
        if row:
            rows[state.rate] = row
    rows = propagate(rows, late, evaluate)
    matrix = [row_of(residual, rows, evaluate) for residual in equations.residuals]
    defective = _undetermined(matrix)
    if defective:
        named = ", ".join(str(equations.unknowns[i]) for i in defective)
        why = "; ".join(dict.fromkeys(equations.reasons[i] for i in defective))
        blamed = dict.fromkeys(name for i in defective for name in equations.causes[i])
        raise EquationError(
            f"{equations.name!r} does not determine {named} ({why}).",
            (*blamed, *(str(equations.unknowns[i]) for i in defective)),
            "A constraint is given twice or a ring has unit gain: remove one of the "
            "elements named here, or put an R or a storage between them.",
        )


class _Somewhere:
    """Evaluates expressions at arbitrary, fixed, positive values of their symbols."""

    def __init__(self) -> None:
        self._next = count(1)
        self._values: dict[sympy.Symbol, sympy.Float] = {}

    def __call__(self, expression: sympy.Expr) -> Any:
        if expression.is_Number:
            return float(expression)
        for symbol in sorted(expression.free_symbols, key=lambda s: str(s.name)):
            if symbol not in self._values:
                value = 0.5 + (next(self._next) * GOLDEN) % 1.0
                self._values[symbol] = sympy.Float(value)
        return float(expression.xreplace(self._values))


def _undetermined(matrix: list[Row]) -> list[int]:
    """Return the rows left without a pivot by sparse elimination."""
    pivots: dict[sympy.Symbol, Row] = {}
    defective = []
    for i, full in enumerate(matrix):
        row = dict(full)
        scale = max((abs(v) for v in row.values()), default=0.0)
        for symbol, pivot in pivots.items():
            if symbol in row:
                factor = row.pop(symbol)
                for other, value in pivot.items():
                    row[other] = row.get(other, 0.0) - factor * value
        best = max(row, key=lambda s: abs(row[s]), default=None)
        if best is None or abs(row[best]) <= TINY * scale:
            defective.append(i)
            continue
        head = row.pop(best)
        pivots[best] = {s: v / head for s, v in row.items() if v != 0.0}
    return defective
