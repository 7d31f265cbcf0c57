"""Exact linear algebra with symbolic parameters, on small blocks.

Entries become elements of a field of rational functions, where sums cancel by
themselves; nothing is simplified. Functions such as sin(theta) and irrational powers
enter as symbols of their own, decimals as exact fractions.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import sympy
from sympy.polys.domains import QQ
from sympy.polys.matrices import DomainMatrix

from bondgraph.errors import EquationError

Row = dict[sympy.Symbol, Any]
"""A sparse linear form ``{seed: coefficient}``: of expressions or of numbers."""

MOST_OPERATIONS = 600  # of one coefficient: some seconds of exact arithmetic


class RationalField:
    """The field of rational functions in the symbols of some expressions."""

    def __init__(self, expressions: Iterable[sympy.Expr]) -> None:
        self._names: dict[sympy.Expr, sympy.Symbol] = {}
        self._prepared: dict[sympy.Expr, sympy.Expr] = {}
        symbols: set[sympy.Symbol] = set()
        for expression in expressions:
            prepared = self._prepare(expression)
            self._prepared[expression] = prepared
            symbols |= prepared.free_symbols
        self.symbols = sorted(symbols, key=lambda s: str(s.name))
        self.domain = QQ.frac_field(*self.symbols) if self.symbols else QQ
        self._back = {symbol: expression for expression, symbol in self._names.items()}
        self._made: dict[sympy.Expr, Any] = {}

    def _prepare(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with all that is not rational replaced by symbols."""
        if expression.is_Float:
            return sympy.Rational(str(expression))
        if expression.is_Rational or expression.is_Symbol:
            return expression
        whole_power = expression.is_Pow and expression.exp.is_Integer
        if expression.is_Add or expression.is_Mul:
            return expression.func(*(self._prepare(arg) for arg in expression.args))
        if whole_power:
            return self._prepare(expression.base) ** expression.exp
        if expression not in self._names:
            self._names[expression] = sympy.Dummy(f"k{len(self._names)}", real=True)
        return self._names[expression]

    def element(self, expression: sympy.Expr) -> Any:
        """Return the field element that `expression` is."""
        if expression not in self._made:
            prepared = self._prepared.get(expression)
            if prepared is None:
                prepared = self._prepare(expression)
            if prepared.count_ops() > MOST_OPERATIONS:
                raise EquationError(
                    f"A coefficient has more than {MOST_OPERATIONS} operations; a "
                    f"closed form with it would take minutes and fill pages.",
                    tuple(sorted(str(x) for x in expression.free_symbols))[:5],
                    "Put numbers in: state_space(graph, at=...) answers at once.",
                )
            self._made[expression] = self.domain.from_sympy(prepared)
        return self._made[expression]

    def expression(self, element: Any) -> sympy.Expr:
        """Return a field element as an expression."""
        return self.domain.to_sympy(element).xreplace(self._back)

    def restored(self, expression: sympy.Expr) -> sympy.Expr:
        """Return `expression` with the functions that symbols stood for put back."""
        return expression.xreplace(self._back)

    def matrix(self, rows: Sequence[Sequence[sympy.Expr]], width: int) -> DomainMatrix:
        """Return the matrix with these entries."""
        entries = [[self.element(x) for x in row] for row in rows]
        return DomainMatrix(entries, (len(rows), width), self.domain)


def in_lowest_terms(terms: Sequence[sympy.Expr]) -> sympy.Expr:
    """Return the sum of `terms` as one fraction; meant for single coefficients."""
    if len(terms) == 1 and not terms[0].has(sympy.Add):
        return terms[0]
    field = RationalField(terms)
    return field.expression(sum(map(field.element, terms), field.domain.zero))


def solved(
    matrix: Sequence[Row], unknowns: Sequence[sympy.Symbol], right: Sequence[Row]
) -> dict[sympy.Symbol, Row]:
    """Return for each unknown its row, from ``matrix · unknowns = right``.

    Parameters
    ----------
    matrix
        One row per equation: ``{unknown: coefficient}``.
    right
        One row per equation: ``{anything: coefficient}``.

    Raises
    ------
    EquationError
        If the matrix is singular.
    """
    solution: dict[sympy.Symbol, Row] = {}
    for equations, block in _blocks(matrix, unknowns):
        solution.update(
            _solved_block(
                [matrix[i] for i in equations], block, [right[i] for i in equations]
            )
        )
    return solution


def _solved_block(
    matrix: list[Row], unknowns: list[sympy.Symbol], right: list[Row]
) -> dict[sympy.Symbol, Row]:
    if len(unknowns) == 1 and len(matrix) == 1 and matrix[0].get(unknowns[0]) == 1:
        return {unknowns[0]: dict(right[0])}
    field = RationalField(x for row in (*matrix, *right) for x in row.values())
    elimination = _Elimination(
        [_in_field(field, row) for row in matrix],
        [_in_field(field, row) for row in right],
        unknowns,
    )
    return {
        unknown: {key: field.expression(value) for key, value in row.items()}
        for unknown, row in elimination.solution().items()
    }


def _in_field(field: RationalField, row: Row) -> Row:
    entries = {key: field.element(value) for key, value in row.items()}
    return {key: value for key, value in entries.items() if value}


class _Elimination:
    """Gauss-Jordan elimination on sparse rows of field elements.

    The pivot is the one that can fill in the least (Markowitz, *Management Science* 3,
    1957), and of those the shortest: what is nearly triangular is solved by insertion.
    """

    def __init__(
        self, matrix: list[Row], right: list[Row], unknowns: list[sympy.Symbol]
    ) -> None:
        self.matrix, self.right, self.unknowns = matrix, right, unknowns
        self.rows_of: dict[sympy.Symbol, set[int]] = {u: set() for u in unknowns}
        for i, row in enumerate(matrix):
            for unknown in row:
                self.rows_of[unknown].add(i)

    def solution(self) -> dict[sympy.Symbol, Row]:
        """Return the row of each unknown, or refuse naming those not determined."""
        pending = dict.fromkeys(range(len(self.matrix)))
        pivots: dict[sympy.Symbol, int] = {}
        for _ in self.unknowns:
            unknown, i = self._pivot(pending, pivots)
            del pending[i]
            pivots[unknown] = i
            self._eliminate(unknown, i)
        return {unknown: self.right[pivots[unknown]] for unknown in self.unknowns}

    def _pivot(
        self, pending: Iterable[int], pivots: Iterable[sympy.Symbol]
    ) -> tuple[sympy.Symbol, int]:
        best, found = None, None
        for i in pending:
            across = len(self.matrix[i]) - 1
            for unknown, value in self.matrix[i].items():
                fill = across * (len(self.rows_of[unknown]) - 1)
                cost = (fill, _length(value))
                if best is None or cost < best:
                    best, found = cost, (unknown, i)
        if found is None:
            left = [str(u) for u in self.unknowns if u not in set(pivots)]
            raise EquationError(
                f"The equations do not determine {', '.join(left)}.",
                tuple(left),
                "Put an R or a storage between the elements concerned.",
            )
        return found

    def _eliminate(self, unknown: sympy.Symbol, i: int) -> None:
        """Make `unknown` the pivot of row i, and take it out of every other row."""
        head = self.matrix[i].pop(unknown)
        self.rows_of[unknown].discard(i)
        for row in (self.matrix[i], self.right[i]):
            for key, value in row.items():
                row[key] = value / head
        for k in sorted(self.rows_of[unknown]):
            factor = self.matrix[k].pop(unknown)
            _subtract(self.right[k], self.right[i], factor)
            for added in _subtract(self.matrix[k], self.matrix[i], factor):
                if added in self.matrix[k]:
                    self.rows_of[added].add(k)
                else:
                    self.rows_of[added].discard(k)
        self.rows_of[unknown] = set()


def _subtract(row: Row, other: Row, factor: Any) -> Iterable[sympy.Symbol]:
    """Take factor times `other` from `row`; return the keys that were touched."""
    for key, value in other.items():
        left = row[key] - factor * value if key in row else -factor * value
        if left:
            row[key] = left
        else:
            row.pop(key, None)
    return list(other)


def _length(value: Any) -> int:
    """Return how many terms a field element has."""
    return len(value.numer) + len(value.denom) if hasattr(value, "numer") else 2


def _blocks(
    matrix: Sequence[Row], unknowns: Sequence[sympy.Symbol]
) -> list[tuple[list[int], list[sympy.Symbol]]]:
    """Return the independent parts of a system: (equations, unknowns) each."""
    parent = {unknown: unknown for unknown in unknowns}

    def root(symbol: sympy.Symbol) -> sympy.Symbol:
        while parent[symbol] != symbol:
            parent[symbol] = parent[parent[symbol]]
            symbol = parent[symbol]
        return symbol

    for row in matrix:
        first, *others = row or [None]
        for other in others:
            parent[root(other)] = root(first)
    parts: dict[sympy.Symbol, tuple[list[int], list[sympy.Symbol]]] = {}
    for unknown in unknowns:
        parts.setdefault(root(unknown), ([], []))[1].append(unknown)
    for i, row in enumerate(matrix):
        if row:
            parts[root(next(iter(row)))][0].append(i)
    return list(parts.values())
