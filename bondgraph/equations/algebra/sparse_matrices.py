"""Sparse matrices ``{(row, column): entry}`` of expressions.

Short entries are in lowest terms; long ones stay as they arise, because nobody reads
them and bringing them to lowest terms may take longer than everything else.
"""

from collections.abc import Mapping

import sympy

from bondgraph.equations.algebra.rational import Row, in_lowest_terms, solved

Sparse = dict[tuple[int, int], sympy.Expr]
ZERO, ONE, HALF = sympy.S.Zero, sympy.S.One, sympy.Rational(1, 2)

READABLE = 60  # operations up to which an entry is brought to lowest terms


def transposed(matrix: Sparse) -> Sparse:
    """Return the transpose."""
    return {(j, i): x for (i, j), x in matrix.items()}


def product(left: Sparse, right: Sparse) -> Sparse:
    """Return the product of two matrices, entries in lowest terms."""
    rows: dict[int, list[tuple[int, sympy.Expr]]] = {}
    for (i, j), x in right.items():
        rows.setdefault(i, []).append((j, x))
    terms: dict[tuple[int, int], list[sympy.Expr]] = {}
    for (i, k), x in left.items():
        for j, y in rows.get(k, ()):
            terms.setdefault((i, j), []).append(x * y)
    return _lowest(terms)


def combined(*parts: tuple[object, Sparse]) -> Sparse:
    """Return the sum of factor times matrix over `parts`."""
    terms: dict[tuple[int, int], list[sympy.Expr]] = {}
    for factor, matrix in parts:
        for key, x in matrix.items():
            terms.setdefault(key, []).append(factor * x)
    return _lowest(terms)


def _lowest(terms: Mapping[tuple[int, int], list[sympy.Expr]]) -> Sparse:
    found = {}
    for key, parts in terms.items():
        total = sympy.Add(*parts)
        sums = total.is_Add or total.has(sympy.Add)
        if sums and total.count_ops() <= READABLE:
            total = in_lowest_terms(parts)
        if total != 0:
            found[key] = total
    return found


def applied(matrix: Sparse, column: list[sympy.Expr], size: int) -> list[sympy.Expr]:
    """Return `matrix`, which has `size` rows, times a column."""
    terms: list[list[sympy.Expr]] = [[] for _ in range(size)]
    for (i, j), x in matrix.items():
        terms[i].append(x * column[j])
    return [sympy.Add(*parts) for parts in terms]


def derivatives(expressions: list[sympy.Expr], symbols: list[sympy.Symbol]) -> Sparse:
    """Return the derivative of each expression (row) by each symbol (column)."""
    place = {symbol: j for j, symbol in enumerate(symbols)}
    return {
        (i, place[s]): expression.diff(s)
        for i, expression in enumerate(expressions)
        for s in sorted(expression.free_symbols, key=str)
        if s in place
    }


def inverse_of_one_plus(added: Sparse, size: int) -> Sparse:
    """Return the inverse of the unit matrix plus `added`."""
    unknowns = [sympy.Dummy() for _ in range(size)]
    keys = [sympy.Dummy() for _ in range(size)]
    place = {key: j for j, key in enumerate(keys)}
    rows: list[Row] = [{unknown: ONE} for unknown in unknowns]
    for (i, j), x in added.items():
        rows[i][unknowns[j]] = rows[i].get(unknowns[j], ZERO) + x
    answer = solved(rows, unknowns, [{key: ONE} for key in keys])
    return {
        (i, place[key]): x
        for i, unknown in enumerate(unknowns)
        for key, x in answer[unknown].items()
    }


def congruent(outer: Sparse, inner: Sparse, sign: int) -> Sparse:
    """Return ``outer · inner · outerᵀ`` for a symmetric (1) or skew (-1) inner matrix.

    One half is computed; the other is its mirror image, so that nothing has to cancel.
    """
    half = product(outer, inner)
    whole = product(half, transposed(outer))
    upper = {key: x for key, x in whole.items() if key[0] < key[1]}
    diagonal = {key: x for key, x in whole.items() if key[0] == key[1] and sign > 0}
    mirrored = {(j, i): sign * x for (i, j), x in upper.items()}
    return {**upper, **diagonal, **mirrored}


def bordered(skew: Sparse, across: Sparse, size: int) -> Sparse:
    """Return the skew matrix ``[[skew, -across], [acrossᵀ, 0]]``."""
    whole = dict(skew)
    for (i, j), x in across.items():
        whole[i, size + j] = -x
        whole[size + j, i] = x
    return whole


def skew_and_symmetric(matrix: Sparse) -> tuple[Sparse, Sparse]:
    """Return J and R with ``matrix = J - R``, each the mirror image of itself."""
    upper = {key: x for key, x in matrix.items() if key[0] < key[1]}
    lower = {(j, i): x for (i, j), x in matrix.items() if i > j}
    skew = combined((HALF, upper), (-HALF, lower))
    symmetric = combined((-HALF, upper), (-HALF, lower))
    diagonal = {key: -x for key, x in matrix.items() if key[0] == key[1]}
    return (
        {**skew, **{(j, i): -x for (i, j), x in skew.items()}},
        {**diagonal, **symmetric, **transposed(symmetric)},
    )
