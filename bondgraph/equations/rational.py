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

from bondgraph.equations.chain_rule import Row
from bondgraph.errors import EquationError


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
    columns = list(dict.fromkeys(key for row in right for key in row))
    if len(unknowns) == 1 and len(matrix) == 1 and matrix[0].get(unknowns[0]) == 1:
        return {unknowns[0]: dict(right[0])}
    zero = sympy.S.Zero
    left_rows = [[row.get(unknown, zero) for unknown in unknowns] for row in matrix]
    right_rows = [[row.get(key, zero) for key in columns] for row in right]
    field = RationalField(x for row in (*left_rows, *right_rows) for x in row)
    left = field.matrix(left_rows, len(unknowns))
    if left.rank() < len(unknowns):
        names = ", ".join(map(str, unknowns))
        raise EquationError(
            f"The equations do not determine {names}.",
            tuple(map(str, unknowns)),
            "Put an R or a storage between the elements concerned.",
        )
    if not columns:
        return {unknown: {} for unknown in unknowns}
    answer = left.lu_solve(field.matrix(right_rows, len(columns))).to_list()
    return {
        unknown: {
            key: field.expression(value)
            for key, value in zip(columns, values, strict=True)
            if value
        }
        for unknown, values in zip(unknowns, answer, strict=True)
    }


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
