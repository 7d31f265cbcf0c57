"""The tape against sympy: values, exact tangents, degrees, and what it refuses."""

import math

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from bondgraph import BondGraph, I, R, Se, f
from bondgraph.equations.deriving.derivation import derive
from bondgraph.errors import EquationError
from bondgraph.numeric.model import compile_model, evaluate
from bondgraph.numeric.tape import Op, record_tape

a, b, c = sympy.symbols("a b c", real=True)
VARIABLES = (a, b, c)


def tape_of(*expressions, definitions=(), active=VARIABLES):
    return record_tape(VARIABLES, definitions, expressions, lambda s: s in set(active))


def run(expression, point):
    """Return the tape's value and gradient of one expression."""
    values, slopes = evaluate(tape_of(expression), np.array(point), np.eye(3))
    return float(values[0]), slopes[0]


def reference(expression, point):
    """Return sympy's own value and its symbolic gradient, in numpy."""
    function = sympy.lambdify(VARIABLES, expression, "numpy")
    gradient = [
        sympy.lambdify(VARIABLES, sympy.diff(expression, v), "numpy") for v in VARIABLES
    ]
    return float(function(*point)), np.array([float(g(*point)) for g in gradient])


POSITIVE = [(0.3, 1.7, 0.9), (2.1, 0.4, 0.2), (0.05, 0.6, 3.0)]
SIGNED = [(-0.3, 1.7, -0.9), (0.8, -0.4, 0.2), (-0.05, -0.6, 0.7)]
INSIDE = [(-0.3, 0.7, -0.9), (0.8, -0.4, 0.2), (0.0, 0.5, 0.5)]

SMOOTH = [
    (a + b - c, SIGNED),
    (-a - b, SIGNED),
    (a * b * c, SIGNED),
    (-2 * a * b + 3, SIGNED),
    (a / b, SIGNED),
    (a / (b * c**2), SIGNED),
    (1 / (a * b), SIGNED),
    (a**3 - b**2, SIGNED),
    (a**-3, SIGNED),
    ((a + b) ** 2, SIGNED),
    (sympy.sqrt(a), POSITIVE),
    (b / sympy.sqrt(a), POSITIVE),
    (a ** sympy.Rational(3, 2), POSITIVE),
    (a ** sympy.Float(-0.7), POSITIVE),
    (a**b, POSITIVE),
    (a ** (-b), POSITIVE),
    (2**a, SIGNED),
    (sympy.sin(a * b), SIGNED),
    (sympy.cos(a - c), SIGNED),
    (sympy.tan(a / 2), SIGNED),
    (sympy.exp(-a * b), SIGNED),
    (sympy.exp(a) / sympy.exp(b), SIGNED),
    (sympy.log(a * b), POSITIVE),
    (sympy.tanh(300 * a), SIGNED),
    (sympy.atan(a * c), SIGNED),
    (sympy.sinh(a), SIGNED),
    (sympy.cosh(b), SIGNED),
    (sympy.asin(a), INSIDE),
    (sympy.acos(a), INSIDE),
    (sympy.atan2(a, b), SIGNED),
    (a * sympy.pi + sympy.E * b + sympy.sqrt(2), SIGNED),
]


@pytest.mark.parametrize(("expression", "points"), SMOOTH, ids=lambda v: str(v)[:30])
def test_values_and_tangents_are_those_of_sympy(expression, points):
    for point in points:
        value, slope = run(expression, point)
        known, gradient = reference(expression, point)
        assert value == pytest.approx(known, rel=1e-13, abs=1e-14)
        assert slope == pytest.approx(gradient, rel=1e-12, abs=1e-13)


KINKED = [
    sympy.Abs(a - b),
    b * sympy.sign(a),
    sympy.Max(a, b, c),
    sympy.Min(a, b, c),
    sympy.Heaviside(a) * b,
    sympy.Piecewise((a * b, a < b), (c**2, True)),
    sympy.Piecewise((a, a <= 0), (b, a <= 0.5), (c, True)),
    sympy.Piecewise((a, a > b), (b, True)),
    sympy.Piecewise((a, a >= b), (c, True)),
    sympy.Piecewise((a, (a < b) & (b < c)), (c, True)),
    sympy.Piecewise((a, (a < b) | (b < c)), (c, True)),
    sympy.Piecewise((a, sympy.Not((a < b) & (b < c))), (c, True)),
]


@pytest.mark.parametrize("expression", KINKED, ids=str)
def test_laws_with_kinks_are_exact_on_either_side(expression):
    function = sympy.lambdify(VARIABLES, expression, "numpy")
    step = 1e-6
    for point in np.random.default_rng(4).uniform(-2.0, 2.0, (20, 3)):
        value, slope = run(expression, point)
        assert value == pytest.approx(float(function(*point)), rel=1e-13, abs=1e-14)
        differences = [
            (float(function(*(point + d))) - float(function(*(point - d)))) / (2 * step)
            for d in step * np.eye(3)
        ]
        assert slope == pytest.approx(differences, abs=1e-8)


def test_every_operation_is_reached_by_the_expressions_here():
    expressions = [*(e for e, _ in SMOOTH), *KINKED]
    used = set(tape_of(*expressions).code[:, 0].tolist())
    assert used == set(Op)


def _combine(children):
    pair = st.tuples(children, children)
    unary = st.sampled_from(
        [
            sympy.sin,
            sympy.cos,
            sympy.tanh,
            sympy.atan,
            lambda x: sympy.exp(-(x**2)),
            lambda x: sympy.sqrt(1 + x**2),
            lambda x: 1 / (1 + x**2),
            lambda x: sympy.log(2 + x**2),
            lambda x: x**3,
        ]
    )
    return st.one_of(
        pair.map(lambda p: p[0] + p[1]),
        pair.map(lambda p: p[0] - p[1]),
        pair.map(lambda p: p[0] * p[1]),
        pair.map(lambda p: p[0] / (1 + p[1] ** 2)),
        st.tuples(unary, children).map(lambda p: p[0](p[1])),
    )


EXPRESSIONS = st.recursive(
    st.sampled_from([a, b, c, sympy.Rational(1, 3), sympy.Integer(-2)]),
    _combine,
    max_leaves=8,
)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(EXPRESSIONS, st.tuples(*[st.floats(-1.5, 1.5)] * 3))
def test_random_expressions_against_the_complex_step(expression, point):
    # The imaginary part of f(x + ih)/h is the slope, free of cancellation.
    function = sympy.lambdify(VARIABLES, expression, "numpy")
    h = 1e-30
    value, slope = run(expression, point)
    size = 1.0 + abs(value)
    assert value == pytest.approx(complex(function(*point)).real, rel=1e-11, abs=1e-11)
    for k in range(3):
        shifted = [x + (1j * h if i == k else 0) for i, x in enumerate(point)]
        known = complex(function(*shifted)).imag / h
        assert slope[k] == pytest.approx(known, rel=1e-9, abs=1e-9 * size)


def test_equal_subexpressions_share_a_slot():
    law = sympy.tanh(a * b)
    assert len(tape_of(law, law + c, law * c).code) == 4


def test_definitions_are_followed_and_those_not_needed_left_out():
    s, r, unused = sympy.symbols("s r unused", real=True)
    definitions = [(s, a * b), (unused, sympy.exp(a)), (r, s**2 + c)]
    tape = tape_of(r, definitions=definitions)
    assert Op.EXP not in tape.code[:, 0]
    values, slopes = evaluate(tape, np.array([2.0, 3.0, 5.0]), np.eye(3))
    assert values[0] == 41.0
    assert slopes[0].tolist() == [36.0, 24.0, 1.0]


DEGREES = [
    (sympy.Integer(7), 0),
    (sympy.exp(c), 0),
    (c * a + b, 1),
    (sympy.sin(c) * a - b / c, 1),
    (a - a * c**2, 1),
    (a * b, 2),
    (a / b, 2),
    (a**2, 2),
    (sympy.sqrt(a), 2),
    (sympy.Abs(a), 2),
    (sympy.sign(b), 2),
    (sympy.Max(a, c), 2),
    (sympy.atan2(c, b), 2),
    (c**a, 2),
    (sympy.Piecewise((a, c > 0), (b, True)), 1),
    (sympy.Piecewise((a, a > 0), (b, True)), 2),
    (sympy.Piecewise((1, c > 0), (c, True)), 0),
]


@pytest.mark.parametrize(("expression", "degree"), DEGREES, ids=str)
def test_degree_says_constant_affine_or_nonlinear_in_what_is_active(expression, degree):
    assert tape_of(expression, active=(a, b)).degree.tolist() == [degree]


def test_slopes_where_a_law_has_none_in_the_textbook_sense():
    assert run(sympy.Abs(a), (0.0, 0.0, 0.0))[1][0] == 0.0
    assert run(sympy.sign(a), (0.0, 0.0, 0.0))[0] == 0.0
    assert run(sympy.exp(a), (800.0, 0.0, 0.0))[0] == math.inf
    assert math.isnan(run(sympy.sqrt(a), (-1.0, 0.0, 0.0))[0])
    assert math.isnan(run(sympy.log(a), (-1.0, 0.0, 0.0))[0])
    # A law like sqrt(|x|) starts at rest: its slope is huge there, never nan.
    assert math.isfinite(run(sympy.sqrt(sympy.Abs(a)), (0.0, 0.0, 0.0))[1][0])


def test_an_unknown_symbol_is_refused_by_name():
    with pytest.raises(EquationError, match="ghost"):
        tape_of(a + sympy.Symbol("ghost"))


def test_an_unknown_function_is_refused_by_name():
    with pytest.raises(EquationError, match=r"gamma.*no number form") as refusal:
        tape_of(b * sympy.gamma(a))
    assert "tanh" not in refusal.value.problem
    assert "hyperbolic" in refusal.value.remedy


@pytest.mark.parametrize("constant", [sympy.I, sympy.log(-2), sympy.zoo], ids=str)
def test_a_constant_that_is_not_a_real_number_is_refused(constant):
    with pytest.raises(EquationError, match="not a real number"):
        tape_of(a * constant + b)


def test_a_piecewise_without_a_last_case_is_refused():
    open_ended = sympy.Piecewise((a, a > 0), (b, a < -1))
    with pytest.raises(EquationError, match="undefined where no case holds") as refusal:
        tape_of(open_ended)
    assert "True" in refusal.value.remedy


def test_the_gate_sorts_what_a_model_is_made_of():
    g = BondGraph("cart", domain="translation")
    g.one("axle", Se("force"), I("m"), R("drag", law=sympy.Symbol("d") * f * abs(f)))
    g.measure("v", flow="axle")
    model = compile_model(derive(g.finish()))
    assert model.input_names == ("force",)
    assert set(model.parameter_names) == {"m", "d"}
    assert (model.n_states, model.n_unknowns) == (1, 0)
    assert not model.linear
    assert not model.instantaneous
    assert not model.needs_input_rates
