"""State equations as a record: a sorted list of assignments, never one expression.

The model is semi-explicit. With states x, inputs u, algebraic unknowns z and the
rates ẋ appearing linearly in none of them by construction, the record means::

    s_1 = expr_1(x, ẋ, z, u, u̇, p, t)         (assignments, in evaluation order)
    …
    ẋ_i = s_(rate i)                           (one signal per state)
    0   = residual_k(s, x, ẋ, z, u, p, t)      (one per algebraic unknown)
    y_j = output_j(s, x, ẋ, z, u, p, t)

Algebraic unknowns are the efforts of dependent (derivative-causality) storages, whose
residual contains ẋ, and the cut variables of algebraic loops.
"""

from dataclasses import dataclass

import sympy


@dataclass(frozen=True, slots=True)
class State:
    """One state: a momentum or displacement.

    ``symbol`` is x_i, ``rate`` the symbol of ẋ_i, ``place`` the storage or, for an
    integrated measurement, the junction or bond whose flow or effort it integrates.
    """

    symbol: sympy.Symbol
    rate: sympy.Symbol
    place: str
    unit: str


@dataclass(frozen=True, slots=True)
class Assignment:
    """``symbol = expression`` of symbols assigned before it; ``reason`` in words."""

    symbol: sympy.Symbol
    expression: sympy.Expr
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Output:
    """One measurement: its name, expression and unit."""

    name: str
    expression: sympy.Expr
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StateEquations:
    """The equations of one graph in one causality; see the module's head.

    Parameters
    ----------
    inputs, input_rates
        Input symbols u, and the symbols of u̇ (only those that occur matter).
    rates
        For each state the expression of ẋ_i in terms of assigned symbols.
    unknowns, residuals
        Algebraic unknowns z and, for each, an expression that must vanish.
    parameters
        Parameter symbols, in the order of the graph's parameter set.
    """

    name: str
    states: tuple[State, ...]
    inputs: tuple[sympy.Symbol, ...]
    input_rates: tuple[sympy.Symbol, ...]
    parameters: tuple[sympy.Symbol, ...]
    unknowns: tuple[sympy.Symbol, ...]
    assignments: tuple[Assignment, ...]
    rates: tuple[sympy.Expr, ...]
    residuals: tuple[sympy.Expr, ...]
    outputs: tuple[Output, ...]
    input_units: tuple[str, ...] = ()
