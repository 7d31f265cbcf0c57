"""Sensitivities through a list of assignments, by the chain rule.

A row is a sparse linear form ``{seed: coefficient}``. Each assignment's row is the sum
of its partial derivatives times the rows of what it reads, so the shared-subexpression
graph is walked once. The coefficients may be sympy expressions or numbers: `evaluate`
turns a partial derivative into one.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import sympy

from bondgraph.equations.algebra.rational import Row
from bondgraph.equations.state_equations import Assignment

Rows = Mapping[sympy.Symbol, Row]
Evaluate = Callable[[sympy.Expr], Any]


def seeded(seeds: Iterable[sympy.Symbol], one: Any) -> dict[sympy.Symbol, Row]:
    """Return the rows of independent symbols: each depends on itself alone."""
    return {seed: {seed: one} for seed in seeds}


def propagate(
    rows: dict[sympy.Symbol, Row], assignments: Iterable[Assignment], evaluate: Evaluate
) -> dict[sympy.Symbol, Row]:
    """Add to `rows` those of every assignment that depends on a seed; return it."""
    for assignment in assignments:
        row = row_of(assignment.expression, rows, evaluate)
        if row:
            rows[assignment.symbol] = row
    return rows


def row_of(expression: sympy.Expr, rows: Rows, evaluate: Evaluate) -> Row:
    """Return the sensitivities of `expression` to the seeds of `rows`."""
    total: Row = {}
    for symbol, partial in partials(expression, rows):
        factor = evaluate(partial)
        if factor == 0:
            continue
        for seed, coefficient in rows[symbol].items():
            term = factor * coefficient
            total[seed] = total[seed] + term if seed in total else term
    return {seed: value for seed, value in total.items() if value != 0}


def partials(
    expression: sympy.Expr, rows: Mapping[sympy.Symbol, Any]
) -> list[tuple[sympy.Symbol, sympy.Expr]]:
    """Return ``(symbol, partial derivative)`` for the symbols that have a row."""
    if expression.is_Symbol:
        return [(expression, sympy.S.One)] if expression in rows else []
    found = sorted(
        (s for s in expression.free_symbols if s in rows), key=lambda s: str(s.name)
    )
    return [(symbol, partial_derivative(expression, symbol)) for symbol in found]


def partial_derivative(expression: sympy.Expr, symbol: sympy.Symbol) -> sympy.Expr:
    """Return d(expression)/d(symbol), quickly where it is a coefficient."""
    if expression.is_Add:
        terms = [term for term in expression.args if symbol in term.free_symbols]
        if len(terms) == 1:
            return partial_derivative(terms[0], symbol)
    elif expression == symbol:
        return sympy.S.One
    elif expression.is_Mul and symbol in expression.args:
        rest = expression / symbol
        if symbol not in rest.free_symbols:
            return rest
    return derivative(expression, symbol)


def derivative(expression: sympy.Expr, symbol: sympy.Symbol) -> sympy.Expr:
    """Return d(expression)/d(symbol), also where sympy cannot see that all is real.

    Of ``Abs(log(x))`` sympy leaves an unevaluated derivative, because the logarithm
    may be complex. Every quantity of a graph is real: |g|' = sign(g) g'.
    """
    found = expression.diff(symbol)
    if not found.has(sympy.Derivative, sympy.Subs):
        return found
    kinked = {a for a in expression.atoms(sympy.Abs, sympy.sign) if a.has(symbol)}
    outer = [
        a for a in kinked if not any(a in b.args[0].atoms(type(a)) for b in kinked)
    ]
    put = {a: sympy.Dummy(real=True) for a in outer}
    back = {dummy: a for a, dummy in put.items()}
    opened = expression.xreplace(put)
    terms = [opened.diff(symbol)]
    for a, dummy in put.items():
        if isinstance(a, sympy.Abs):
            inner = derivative(a.args[0], symbol)
            terms.append(opened.diff(dummy) * sympy.sign(a.args[0]) * inner)
    return sympy.Add(*terms).xreplace(back)
