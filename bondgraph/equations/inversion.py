"""Laws in the direction that causality asks for, which may not be the one written."""

import math
from collections.abc import Callable

import sympy

from bondgraph.errors import EquationError
from bondgraph.structure import signals
from bondgraph.structure.elements import (
    Compliance,
    Inertance,
    Relation,
    Resistance,
    letter,
)
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import PORT_VARIABLES, parameter_symbol

OnePortWithLaw = Inertance | Compliance | Resistance


def explicit(element: OnePortWithLaw, wanted: sympy.Symbol) -> sympy.Expr | None:
    """Return `wanted` in the element's other variable, or None if no formula exists.

    A law without a formula in this direction can still be solved numerically if it is
    strictly monotone; see `check_monotone`.
    """
    if element.law is None:  # the common case, without differentiating anything
        constant = parameter_symbol(element.name)
        big, small = _LINEAR[type(element)]
        return constant * small if wanted == big else big / constant
    try:
        return element.relation.solved_for(wanted)
    except EquationError:
        return None


_LINEAR: dict[type, tuple[sympy.Symbol, sympy.Symbol]] = {
    Resistance: (signals.e, signals.f),
    Inertance: (signals.p, signals.f),
    Compliance: (signals.q, signals.e),
}


def check_monotone(
    element: OnePortWithLaw, parameter: Callable[[str], Parameter], because: str
) -> Relation:
    """Return the relation if each value of its output has one argument.

    Raises
    ------
    EquationError
        If that cannot be shown; the message names the element.
    """
    relation = element.relation
    slope = relation.expression.diff(relation.argument)
    signed = {
        symbol: _with_sign(symbol, parameter)
        for symbol in slope.free_symbols
        if symbol not in PORT_VARIABLES
    }
    slope = slope.xreplace(signed).replace(_is_squared_tanh, _by_cosh)
    slope = sympy.expand(slope)
    if slope.is_positive or slope.is_negative:
        return relation
    remedy = f"Write the law as an expression in {relation.output}"
    if isinstance(element, Resistance):
        given = "flow" if relation.output == signals.e else "effort"
        remedy += f", or put a storage beside it that gives it its {given}"
    raise EquationError(
        f"The law {relation.output} = {relation.expression} of {letter(element)} "
        f"{element.name!r} gives {relation.output}, but here {relation.argument} is "
        f"wanted ({because}), and the law has no unique inverse.",
        (element.name,),
        f"{remedy}.",
    )


def _is_squared_tanh(expression: sympy.Expr) -> bool:
    return bool(expression.is_Pow and expression.exp == 2) and isinstance(
        expression.base, sympy.tanh
    )


def _by_cosh(square: sympy.Expr) -> sympy.Expr:
    """Return tanh² as 1 - 1/cosh², whose sign sympy knows."""
    return 1 - 1 / sympy.cosh(square.base.args[0]) ** 2


def _with_sign(
    symbol: sympy.Symbol, parameter: Callable[[str], Parameter]
) -> sympy.Symbol:
    """Return a twin of a parameter that knows the sign its value and bounds give."""
    if isinstance(symbol, signals.Signal) or symbol == signals.t:
        return symbol
    known = parameter(symbol.name)
    low, high = known.bounds
    value = known.value
    if value is None:
        value = 1.0 if low >= 0 or math.isinf(low) else 0.0
    if value > 0 and (low >= 0 or math.isinf(low)):
        return sympy.Dummy(positive=True)
    if value < 0 and (high <= 0 or math.isinf(high)):
        return sympy.Dummy(negative=True)
    return symbol
