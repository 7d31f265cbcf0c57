"""Exact elimination on sparse rows whose coefficients are functions of parameters.

A row ``{symbol: coefficient}`` says that the sum of its products vanishes. The least
entangled symbol is eliminated first, so that chains and trees do not fill in.
"""

from collections.abc import Iterable
from heapq import heapify, heappop, heappush

import sympy

from bondgraph.equations.algebra.rational import in_lowest_terms

Row = dict[sympy.Symbol, sympy.Expr]
ZERO = sympy.S.Zero


def total(one: sympy.Expr, other: sympy.Expr) -> sympy.Expr:
    """Return the sum of two coefficients, exactly zero where it vanishes."""
    found = one + other
    if found.is_Number or not found.has(sympy.Add):
        return found
    return in_lowest_terms([one, other])


def eliminated(rows: list[Row], kept: set[sympy.Symbol]) -> list[Row]:
    """Return what the rows say of the `kept` symbols alone.

    The symbol that fewest rows contain goes first; one that a single row contains
    takes that row with it, and nothing is computed.
    """
    live = dict(enumerate(rows))
    columns: dict[sympy.Symbol, set[int]] = {}
    for i, row in live.items():
        for symbol in row:
            if symbol not in kept:
                columns.setdefault(symbol, set()).add(i)
    order = {symbol: n for n, symbol in enumerate(columns)}
    queue = [(len(found), order[s], s) for s, found in columns.items()]
    heapify(queue)
    while queue:
        count, _, symbol = heappop(queue)
        if len(columns.get(symbol, ())) == count > 0:  # else an entry out of date
            for other in _eliminate(symbol, live, columns):
                heappush(queue, (len(columns[other]), order[other], other))
    return [row for row in live.values() if row]


def _eliminate(
    symbol: sympy.Symbol, live: dict[int, Row], columns: dict[sympy.Symbol, set[int]]
) -> list[sympy.Symbol]:
    """Remove `symbol` with one row from all others; return whose columns changed."""
    found = columns.pop(symbol)
    chosen = min(found, key=lambda i: (len(live[i]), i))
    pivot = live.pop(chosen)
    changed = [other for other in pivot if other in columns]
    for i in sorted(found - {chosen}):
        live[i] = _subtracted(live[i], pivot, symbol)
    for other in changed:
        columns[other] -= found
        columns[other].update(i for i in found if other in live.get(i, ()))
    return changed


def _subtracted(row: Row, pivot: Row, symbol: sympy.Symbol) -> Row:
    """Return `row` less the multiple of `pivot` that removes `symbol`."""
    factor = -row[symbol] / pivot[symbol]
    if factor.has(sympy.Add):
        factor = in_lowest_terms([factor])
    result = dict(row)
    for other, value in pivot.items():
        found = total(result.get(other, ZERO), factor * value)
        if other == symbol or found == 0:
            result.pop(other, None)
        else:
            result[other] = found
    return result


def reduced(
    rows: list[Row], preferred: Iterable[sympy.Symbol]
) -> dict[sympy.Symbol, Row]:
    """Return a basis of the rows by pivot; a pivot occurs in its own row alone.

    Pivots are taken in the order of `preferred`, where there is a choice.
    """
    place = {symbol: i for i, symbol in enumerate(preferred)}
    basis: dict[sympy.Symbol, Row] = {}
    for row in rows:
        here = row
        for symbol in [s for s in here if s in basis]:
            if symbol in here:
                here = _subtracted(here, basis[symbol], symbol)
        if not here:
            continue
        pivot = min(here, key=place.__getitem__)
        scaled = {s: _quotient(x, here[pivot]) for s, x in here.items()}
        for other, known in basis.items():
            if pivot in known:
                basis[other] = _subtracted(known, scaled, pivot)
        basis[pivot] = scaled
    return basis


def _quotient(value: sympy.Expr, divisor: sympy.Expr) -> sympy.Expr:
    result = value / divisor
    return in_lowest_terms([result]) if result.has(sympy.Add) else result
