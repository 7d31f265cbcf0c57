"""A power of a signal that keeps its sign, and is a line near zero."""

import sympy

NEAR_ZERO = 0.01
"""It is a line within this share of the largest value."""


def raised(
    signal: sympy.Expr, size: sympy.Symbol, more: sympy.Expr | sympy.Symbol
) -> sympy.Expr:
    """Return ``signal * |signal / size|^more``, smooth where it is zero.

    At `size` it is the signal itself, whatever the power.
    """
    share = sympy.sqrt((signal / size) ** 2 + NEAR_ZERO**2)
    return signal * share**more
