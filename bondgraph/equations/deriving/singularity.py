"""Refusal of graphs whose unknowns are not determined, whatever the parameters.

The residuals must fix the unknowns: the matrix of their sensitivities, with the rates
put in, must have full rank. It is evaluated at arbitrary numbers for every symbol, so
that only a structural defect (a ring with unit gain, a constraint given twice) shows.
"""

from dataclasses import dataclass
from itertools import chain, count
from typing import Any

import numpy as np
import sympy

from bondgraph.equations.algebra.rational import Row
from bondgraph.equations.chain_rule import propagate, row_of, seeded
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError

GOLDEN = 0.6180339887498949
TINY = 1e-9


def refuse_singular(equations: StateEquations) -> None:
    """Raise EquationError if the residuals cannot determine the unknowns."""
    if not equations.unknowns:
        return
    evaluate = _Somewhere()
    rows = seeded(equations.unknowns, _Sum(1.0, 1.0))
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


@dataclass(frozen=True, slots=True, eq=False)
class _Sum:
    """A number and how large what it was summed from is: of rounding nothing is left.

    It equals zero where less than a billionth is left. It is complex where the symbols'
    values lie outside of what a root or a logarithm is meant for, and as good there.
    """

    value: complex
    size: float

    def __add__(self, other: "_Sum") -> "_Sum":
        return _Sum(self.value + other.value, self.size + other.size)

    def __sub__(self, other: "_Sum") -> "_Sum":
        return _Sum(self.value - other.value, self.size + other.size)

    def __mul__(self, other: "_Sum") -> "_Sum":
        product = self.value * other.value  # what was summed before counts no more
        return _Sum(product, abs(product))

    def __eq__(self, zero: object) -> bool:
        assert zero == 0
        return abs(self.value) <= TINY * self.size

    __hash__ = None  # type: ignore[assignment]


class _Somewhere:
    """Evaluates expressions at arbitrary, fixed, positive values of their symbols."""

    def __init__(self) -> None:
        self._next = count(1)
        self._values: dict[sympy.Symbol, sympy.Float] = {}

    def __call__(self, expression: sympy.Expr) -> Any:
        for symbol in sorted(expression.free_symbols, key=lambda s: str(s.name)):
            if symbol not in self._values:
                value = 0.5 + (next(self._next) * GOLDEN) % 1.0
                self._values[symbol] = sympy.Float(value)
        terms = [
            complex(term.xreplace(self._values))
            for term in sympy.Add.make_args(expression)
        ]
        return _Sum(sum(terms), sum(map(abs, terms)))


def _undetermined(matrix: list[Row]) -> list[int]:
    """Return the rows that depend on those above them, by elimination."""
    columns = {symbol: j for j, symbol in enumerate(dict.fromkeys(chain(*matrix)))}
    sizes = np.zeros((len(matrix), len(columns)))
    values = sizes.astype(complex)
    for i, row in enumerate(matrix):
        for symbol, entry in row.items():
            values[i, columns[symbol]] = entry.value
            sizes[i, columns[symbol]] = entry.size
    defective = []
    for i in range(len(matrix)):
        left = np.flatnonzero(np.abs(values[i]) > TINY * sizes[i])
        if not left.size:
            defective.append(i)
            continue
        best = left[np.argmax(np.abs(values[i, left]))]
        pivot = values[i, left] / values[i, best]
        below = np.abs(values[:, best]) > TINY * sizes[:, best]
        rows = np.flatnonzero(below[i + 1 :]) + i + 1
        step = values[rows, best][:, None] * pivot
        values[np.ix_(rows, left)] -= step
        sizes[np.ix_(rows, left)] += np.abs(step)
        values[:, best] = 0.0
        sizes[:, best] = 0.0
    return defective
