"""Laws written in pieces: whether each piece meets the next, or the law jumps.

The slope of a law says whether it rises, but nothing of a jump between two pieces: a
law that rises in both and falls between them gives one value twice.
"""

from collections.abc import Collection
from dataclasses import dataclass
from itertools import pairwise

import sympy


@dataclass(frozen=True, slots=True)
class Joints:
    """Where pieces of a law meet; `upward` is 1 where they are written so, else -1."""

    edges: tuple[sympy.Expr, ...]
    upward: int


def is_in_pieces(expression: sympy.Expr, symbols: Collection[sympy.Symbol]) -> bool:
    """Return whether pieces of an expression read any of `symbols`.

    Then it need not be linear in them, even where all pieces have one slope.
    """
    return any(one.has(*symbols) for one in expression.atoms(sympy.Piecewise))


def has_no_jump(law: sympy.Expr, x: sympy.Symbol) -> bool:
    """Return whether all pieces of a law are seen to meet where one ends."""
    pieces = (one for one in law.atoms(sympy.Piecewise) if one.has(x))
    return all(joints_of(one, x) is not None for one in pieces)


def joints_of(law: sympy.Piecewise, x: sympy.Symbol) -> Joints | None:
    """Return where each piece meets the next along x, or None if they do not all.

    Edges that are numbers must be in order; of formulas the author's order is believed.
    """
    *inner, (_, last) = law.args
    bounds = [_bound(condition, x) for _, condition in inner]
    if last != sympy.true or any(bound is None for bound in bounds):
        return None
    edges = tuple(bound[0] for bound in bounds if bound is not None)
    ways = {bound[1] for bound in bounds if bound is not None}
    if len(ways) != 1:
        return None
    (upward,) = ways
    for one, other in pairwise(edges):
        if (upward * (other - one)).is_positive is False:
            return None
    for (piece, _), (following, _), edge in zip(
        law.args[:-1], law.args[1:], edges, strict=True
    ):
        if sympy.simplify((piece - following).xreplace({x: edge})) != 0:
            return None
    return Joints(edges, upward)


def _bound(condition: sympy.Basic, x: sympy.Symbol) -> tuple[sympy.Expr, int] | None:
    """Return (c, 1) for ``x < c`` and ``x <= c``, (c, -1) for the other way round."""
    match condition:
        case sympy.StrictLessThan() | sympy.LessThan():
            below, above = condition.lhs, condition.rhs
        case sympy.StrictGreaterThan() | sympy.GreaterThan():
            below, above = condition.rhs, condition.lhs
        case _:
            return None
    if below == x and not above.has(x):
        return above, 1
    return (below, -1) if above == x and not below.has(x) else None
