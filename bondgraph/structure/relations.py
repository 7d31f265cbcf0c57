"""Constitutive relations: one port's law, and its inverse where a formula exists.

A law is written in one port variable and gives the other. Causality may ask for the
opposite direction; `inverse` peels the law from outside inwards and answers only where
each value has exactly one argument, whatever the parameters' values are.
"""

from dataclasses import dataclass

import sympy


@dataclass(frozen=True, slots=True)
class Relation:
    """A constitutive relation ``output = expression(argument, …)`` of one port."""

    output: sympy.Symbol
    argument: sympy.Symbol
    expression: sympy.Expr


def inverse(
    expression: sympy.Expr, argument: sympy.Symbol, value: sympy.Expr
) -> sympy.Expr | None:
    """Return the one real `argument` at which `expression` has `value`, or None.

    None also where there is one, but no formula, or only for some parameter values.
    """
    slope = slope_of_line(expression, argument)
    if slope is not None:
        rest = expression.xreplace({argument: sympy.S.Zero})
        return (value - rest) / slope
    here = expression
    while here != argument:
        peeled = _peeled(here, argument, value)
        if peeled is None:
            return None
        here, value = peeled
    return value


def slope_of_line(expression: sympy.Expr, argument: sympy.Symbol) -> sympy.Expr | None:
    """Return the slope of an expression that is one line, and not level; else None.

    As it is written: no function of the argument is looked into. The slope of a long
    curve takes long, and pieces of one slope need not be one line.
    """
    bent = expression.atoms(sympy.Function, sympy.Piecewise)
    if any(part.has(argument) for part in bent):
        return None
    slope = expression.diff(argument)
    return None if slope == 0 or slope.has(argument) else slope


def _peeled(
    expression: sympy.Expr, argument: sympy.Symbol, value: sympy.Expr
) -> tuple[sympy.Expr, sympy.Expr] | None:
    """Take the outermost operation off; return what is inside and its value."""
    if expression.is_Add:
        rest, inner = expression.as_independent(argument, as_Add=True)
        return None if inner.is_Add else (inner, value - rest)
    power = _odd_power(expression, argument)
    if power is not None:
        factor, exponent = power
        return argument, _signed_root(value / factor, exponent)
    if expression.is_Mul:
        rest, inner = expression.as_independent(argument, as_Add=False)
        return None if inner.is_Mul else (inner, value / rest)
    if expression.is_Pow:
        return _peeled_power(expression, argument, value)
    undo = _INVERSES.get(expression.func)
    return None if undo is None else (expression.args[0], undo(value))


# Outside its range an inverse must be no number: tan would take atan's up again.
_INVERSES = {
    sympy.exp: sympy.log,
    sympy.log: sympy.exp,
    sympy.tanh: lambda y: sympy.log((1 + y) / (1 - y)) / 2,
}


def _peeled_power(
    power: sympy.Pow, argument: sympy.Symbol, value: sympy.Expr
) -> tuple[sympy.Expr, sympy.Expr] | None:
    base, exponent = power.base, power.exp
    if not exponent.has(argument):
        odd = exponent.is_Integer and exponent % 2 == 1 and exponent > 0
        return (base, _signed_root(value, exponent)) if odd else None
    if base.is_number and base.is_positive and base != 1:
        return exponent, sympy.log(value) / sympy.log(base)
    return None


def _signed_root(value: sympy.Expr, exponent: sympy.Expr) -> sympy.Expr:
    """Return the real v with ``sign(v) |v|ⁿ = value``."""
    if exponent == 1:
        return value
    if exponent.is_number and exponent < 1:  # smooth, and without a sign
        return value * sympy.Abs(value) ** (1 / exponent - 1)
    return sympy.sign(value) * sympy.Abs(value) ** (1 / exponent)


def _odd_power(
    expression: sympy.Expr, argument: sympy.Symbol
) -> tuple[sympy.Expr, sympy.Expr] | None:
    """Return (factor, n) if the expression is factor · sign(x) |x|ⁿ with n > 0."""
    factor, signs, exponent = sympy.S.One, 0, sympy.S.Zero
    for part in sympy.Mul.make_args(expression):
        base, power = part.as_base_exp()
        if not part.has(argument):
            factor *= part
        elif base == argument and power.is_Integer:
            signs, exponent = signs + int(power), exponent + power
        elif base == sympy.Abs(argument) and not power.has(argument):
            exponent += power
        elif part == sympy.sign(argument):
            signs += 1
        else:
            return None
    if signs % 2 == 0 or not exponent.is_positive:
        return None
    return factor, exponent
