"""What lies outside of a gap: of a threshold, of play, of lost motion."""

import sympy


def beyond(x: sympy.Expr, half: sympy.Symbol) -> sympy.Expr:
    """Return how far x lies outside of ± half; nothing within."""
    return sympy.Max(x - half, 0) + sympy.Min(x + half, 0)
