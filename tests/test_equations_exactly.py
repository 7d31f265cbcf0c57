"""Equations to the last digit: what small mistakes in them would change (see the page
on mutation testing), each against numbers worked out another way.
"""

import numpy as np
import pytest
import sympy
from sympy import Abs, Max, Rational, cosh, exp, log, sign, sin, tanh

from bondgraph.equations.algebra import factors
from bondgraph.equations.algebra.elimination import eliminated, reduced
from bondgraph.equations.algebra.factors import (
    Factor,
    factored,
    monic,
    polynomial,
    product,
)
from bondgraph.equations.algebra.pieces import joints_of
from bondgraph.equations.chain_rule import derivative
from bondgraph.equations.deriving.inversion import _by_cosh, _is_squared_tanh
from bondgraph.equations.deriving.singularity import _Sum, _undetermined
from bondgraph.equations.power.stored_energy import _antiderivative, _vanishes
from bondgraph.equations.transfer.transfer_function import s

x, y, a, b, c = sympy.symbols("x y a b c", real=True)
PLACES = (-2.7, -1.3, -0.4, 0.3, 0.8, 1.9, 3.1)
POSITIVE = (0.2, 0.7, 1.6, 2.9)


def slope(expression, at, step=1e-6):
    """Return a central difference."""
    values = [float(expression.subs(x, at + d)) for d in (-step, step)]
    return (values[1] - values[0]) / (2 * step)


@pytest.mark.parametrize(
    "expression",
    [
        Abs(log(x)),
        x * Abs(log(x)),
        x**2 * sign(log(x)),
        Abs(log(x)) * Abs(x - 2),
        exp(-Abs(log(x) ** 3)),
        Abs(x + Abs(log(x))),
        Abs(x * sign(log(x))),
        Abs(log(x)) * sign(log(x)),
        Abs(x * sign(log(x))) ** 2 + Abs(x - 2),
    ],
    ids=str,
)
def test_the_slope_of_a_modulus_is_that_of_a_real_number(expression):
    found = derivative(expression, x)
    assert not found.has(sympy.Derivative, sympy.Subs)
    for at in POSITIVE:
        assert float(found.subs(x, at)) == pytest.approx(slope(expression, at), 1e-5)


@pytest.mark.parametrize(
    ("core", "places"),
    [
        (sympy.S.One, PLACES),
        (x**3, PLACES),
        (x**-2, POSITIVE),
        (Max(0, 2 * x - 1) ** Rational(3, 2), PLACES),
        (Max(0, 1 - 3 * x), PLACES),
        (Abs(2 * x + 1), PLACES),
        (Abs(1 - 4 * x), PLACES),
        (sign(2 - x), PLACES),
        (sign(3 * x + 1), PLACES),
        (sin(2 * x), PLACES),
    ],
    ids=str,
)
def test_an_integral_has_what_was_integrated_as_its_slope(core, places):
    whole = _antiderivative(core, x)
    for at in places:
        assert slope(whole, at) == pytest.approx(float(core.subs(x, at)), 1e-5, 1e-8)


def test_a_squared_tanh_is_one_less_a_squared_cosh_under_one():
    square = tanh(a * x) ** 2
    assert _is_squared_tanh(square)
    assert not _is_squared_tanh(tanh(x))
    assert not _is_squared_tanh(cosh(x) ** 2)
    for at in PLACES:
        values = {a: 0.7, x: at}
        assert float(_by_cosh(square).subs(values)) == pytest.approx(
            float(square.subs(values))
        )


def at(expression, value, **values):
    return complex(expression.subs({s: value, a: 1.7, b: -0.6, c: 2.3, **values}))


@pytest.mark.parametrize(
    "whole",
    [
        (s + a) ** 2 * (s + b),
        4 * a**2 * (s + 1) ** 3,
        a**3 * b**2 * s**2 * (s**2 + a * s + b),
        (s + a) * (s**2 + 1) ** 2 * 5 / 3,
        sympy.S(7) * c,
        c * s**3,
    ],
    ids=str,
)
def test_factors_multiply_to_the_polynomial(whole):
    coefficients = sympy.Poly(whole, s).all_coeffs()
    constant, factors = factored(coefficients)
    together = sympy.Mul(constant, *(polynomial(f) ** n for f, n in factors))
    leading = coefficients[0]
    over = sympy.Mul(leading, *(factor.expression for factor in monic(coefficients)))
    for value in (0.3 + 1j, -1.2, 2j):
        expected = at(whole, value)
        for form in (together, over, product(coefficients)):
            assert at(form, value) == pytest.approx(expected, rel=1e-12)
    assert all(factor.coefficients[0] == 1 for factor in monic(coefficients))


def test_the_roots_of_a_factor_are_where_it_is_nothing():
    for coefficients in ((1, a), (1, a, b), (1, 2, 5)):
        factor = Factor(tuple(map(sympy.sympify, coefficients)), 2)
        assert len(factor.roots) == factor.degree
        for root in factor.roots:
            assert at(factor.expression, at(root, 0)) == pytest.approx(0, abs=1e-12)
        # All of them, so that their product is what stands without s.
        last = sympy.Mul(*(-root for root in factor.roots)) - factor.coefficients[-1]
        assert at(last, 0) == pytest.approx(0, abs=1e-12)
    assert Factor((sympy.S.One, a, b, c), 1).roots == ()


def rows_of(matrix, symbols):
    return [
        {symbol: value for symbol, value in zip(symbols, row, strict=True) if value}
        for row in matrix
    ]


def matrix_of(rows, symbols):
    return sympy.Matrix([[row.get(symbol, 0) for symbol in symbols] for row in rows])


@pytest.mark.parametrize("seed", range(6))
def test_elimination_keeps_what_the_rows_say_of_the_rest(seed):
    random = np.random.default_rng(seed)
    symbols = sympy.symbols("v0:6")
    matrix = sympy.Matrix(5, 6, lambda *_: int(random.integers(-2, 3)))
    kept = set(symbols[3:])
    left = matrix_of(eliminated(rows_of(matrix.tolist(), symbols), kept), symbols)
    assert not any(left[:, :3])
    # The same as what of the row space does not touch the others.
    space = matrix.T.columnspace()
    basis = sympy.Matrix.hstack(*space).T
    free = basis[:, :3].T.nullspace()
    untouched = [sympy.Matrix(v).T * basis for v in free]
    expected = sympy.Matrix.vstack(*untouched) if untouched else sympy.zeros(0, 6)
    assert left.rank() == expected.rank()
    assert sympy.Matrix.vstack(left, expected).rank() == expected.rank()


@pytest.mark.parametrize("seed", range(4))
def test_a_basis_is_reduced_in_the_order_that_is_preferred(seed):
    random = np.random.default_rng(10 + seed)
    symbols = sympy.symbols("v0:5")
    matrix = sympy.Matrix(4, 5, lambda *_: int(random.integers(-2, 3)))
    found = reduced(rows_of(matrix.tolist(), symbols), symbols)
    expected, pivots = matrix.rref()
    assert {symbols[i] for i in pivots} == set(found)
    for i, pivot in enumerate(pivots):
        row = matrix_of([found[symbols[pivot]]], symbols)
        assert row == expected[i, :]


def test_a_row_that_others_say_already_is_undetermined():
    u, v, w = sympy.symbols("u v w")

    def undetermined(*rows):
        exact = [{s: _Sum(x, abs(x)) for s, x in row.items()} for row in rows]
        return _undetermined(exact)

    rows = [{u: 2.0, v: 1.0}, {v: -3.0, w: 0.5}, {u: 4.0, v: -1.0, w: 0.5}, {}]
    assert undetermined(*rows) == [2, 3]
    assert undetermined(*rows[:2], {u: 4.0, v: -1.0, w: 0.6}) == []
    assert undetermined({u: 1e-200, v: 1e-200}, {u: 1.0, v: 1.0}) == [1]
    # What rounding leaves of a difference is nothing, however small the rest is.
    assert undetermined({u: 0.7, v: 0.3}, {u: 11 * 0.7, v: 11 * 0.3}) == [1]
    eleven = {u: 11 * 0.7, v: 11 * 0.3}
    assert undetermined({u: 0.7, v: 0.3}, {v: 1.0, w: 1.0}, eleven) == [2]
    rounded = _Sum(0.1, 0.1) * _Sum(3.0, 3.0) - _Sum(0.3, 0.3)
    assert rounded.value != 0.0
    assert _undetermined([{u: rounded}]) == [0]
    assert _undetermined([{u: rounded + _Sum(1e-6, 1e-6)}]) == []


def test_joints_are_found_whichever_way_round_a_condition_is_written():
    ways = (x < 1, x <= 1, sympy.Gt(1, x), sympy.Ge(1, x))
    found = [joints_of(sympy.Piecewise((2 * x, way), (x + 1, True)), x) for way in ways]
    assert all(one == found[0] for one in found)
    assert found[0] is not None
    moving = sympy.Piecewise((2 * x, x < x**2), (x + 1, True), evaluate=False)
    assert joints_of(moving, x) is None
    moving = sympy.Piecewise((2 * x, x**2 < x), (x + 1, True), evaluate=False)
    assert joints_of(moving, x) is None


def test_what_is_too_long_to_factor_is_one_factor_and_the_same_polynomial(monkeypatch):
    whole = sympy.expand(s * (s + a) * (s + b))
    coefficients = sympy.Poly(whole, s).all_coeffs()
    monkeypatch.setattr(factors, "MOST_TERMS", 3)
    constant, found = factored(coefficients)
    assert [power for _, power in found] == [1, 1]
    together = sympy.Mul(constant, *(polynomial(f) ** n for f, n in found))
    assert sympy.expand(together - whole) == 0
    monkeypatch.setattr(factors, "MOST_TERMS", 4)
    assert len(factored(coefficients)[1]) == 3


def test_what_vanishes_does_so_for_either_sign_of_what_varies():
    for zero in (x - x, (x + 1) ** 2 - x**2 - 2 * x - 1, cosh(x) ** 2 - 1):
        varied = zero - (sympy.sinh(x) ** 2 if zero.has(cosh) else 0)
        assert _vanishes(varied, (x,))
    assert not _vanishes(x + 1 - x - Rational(1, 10**6), (x,))
    assert not _vanishes(sin(x) - x + x**3 / 6, (x,))
    # Parameters are positive, what is stored is not.
    assert _vanishes(Abs(a) - a, (x,))
    assert not _vanishes(Abs(x) - x, (x,))
    assert not _vanishes(a * (Abs(x) - x), (x,))
