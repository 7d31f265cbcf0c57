"""Transfer functions in three forms, matrices of them, and the descriptor form."""

import numpy as np
import pytest
import sympy
from catalogue import CASES, agree, expression, random_graph, somewhere

from bondgraph import BondGraph, C, FinishedGraph, I, R, Se, Sf, derive, f, linearise
from bondgraph.equations.algebra.factors import Factor, PoleZeroGain
from bondgraph.equations.transfer.descriptor import descriptor
from bondgraph.equations.transfer.linear import Form
from bondgraph.equations.transfer.transfer_function import s
from bondgraph.errors import BondGraphError, EquationError

LINEAR = pytest.mark.parametrize(
    "case", [c for c in CASES if c.linear], ids=lambda c: c.name
)


def named(name: str) -> FinishedGraph:
    return next(case for case in CASES if case.name == name).graph()


def two_tanks() -> FinishedGraph:
    graph = BondGraph("two tanks")
    graph.zero("left", Sf("in_left"), C("a1"))
    graph.zero("right", Sf("in_right"), C("a2"), R("leak"))
    graph.one("pipe", R("valve"))
    graph.join("left", "pipe")
    graph.join("pipe", "right")
    graph.measure("low", effort="right")
    graph.measure("high", effort="left")
    graph.measure("through", flow="pipe")
    return graph.finish()


@LINEAR
def test_every_form_is_the_same_function(case) -> None:
    for transfer in linearise(derive(case.graph())).transfer_matrix():
        for form in (
            transfer.textbook,
            transfer.polynomial,
            transfer.pole_zero_gain.expression,
        ):
            assert agree(form, transfer.expression)


@LINEAR
def test_the_matrix_holds_the_single_transfer_functions(case) -> None:
    system = linearise(derive(case.graph()))
    matrix = system.transfer_matrix()
    assert matrix.shape == (len(system.outputs), len(system.inputs))
    for i, output in enumerate(system.outputs):
        for j, source in enumerate(system.inputs):
            single = system.transfer_function(output, source)
            assert matrix[output, source] == single == matrix[i, j]


def test_a_matrix_by_hand() -> None:
    matrix = linearise(derive(two_tanks())).transfer_matrix()
    bottom = "(a1*a2*leak*valve*s**2 + (a1*leak + a1*valve + a2*leak)*s + 1)"
    for place, text in {
        ("low", "in_left"): f"leak/{bottom}",
        ("low", "in_right"): f"leak*(a1*valve*s + 1)/{bottom}",
        ("high", "in_right"): f"leak/{bottom}",
        ("through", "in_right"): f"-a1*leak*s/{bottom}",
    }.items():
        assert agree(matrix[place].expression, expression(text))
    first = matrix["low", "in_left"].denominator_coefficients
    assert all(entry.denominator_coefficients == first for entry in matrix)
    assert "in_left" in str(matrix)
    assert r"\begin{matrix}" in matrix._repr_latex_()
    values = {"a1": 1.0, "a2": 2.0, "leak": 3.0, "valve": 0.5}
    gains = matrix.at(0.7j, values)
    assert gains[0][1] == pytest.approx(matrix["low", "in_right"].at(0.7j, values))
    with pytest.raises(EquationError, match="no output 'lo'"):
        matrix["lo", "in_left"]
    with pytest.raises(EquationError, match="no input 7"):
        matrix[0, 7]


def test_forms_for_reading() -> None:
    transfer = linearise(derive(named("lowerleg"))).transfer_function()
    form = transfer.pole_zero_gain
    inertia = expression("jl + jt + jw*kw**2 + (jm + jg)*(kg*kw)**2")
    assert [factor.degree for factor in form.poles] == [1, 1]
    zero, slow = (factor.roots[0] for factor in form.poles)
    assert zero == 0
    assert agree(slow, -expression("c") / inertia)
    assert agree(form.gain, transfer.gain)
    assert str(form).startswith("theta/torque = gain*1/(s*(")
    assert r"\cdot" in form._repr_latex_()
    plain = str(transfer.polynomial)
    assert "s**2" in plain


def test_quadratic_poles_are_formulas_where_they_can_be_read() -> None:
    transfer = linearise(derive(named("rlc_series"))).transfer_function("v", "u")
    (factor,) = transfer.pole_zero_gain.poles
    l, r, c = (sympy.Symbol(n, real=True) for n in "lrc")
    for root in factor.roots:
        put = somewhere({l, r, c})
        value = complex(root.subs(put))
        polynomial = l * c * value**2 + r * c * value + 1
        assert abs(complex(polynomial.subs(put))) < 1e-12
    drive = linearise(derive(named("two_mass_drive"))).transfer_function()
    assert [f.degree for f in drive.pole_zero_gain.poles] == [1, 2]


# Size ---------------------------------------------------------------------------


def ladder(stages: int, shared: bool = False) -> FinishedGraph:
    graph = BondGraph("ladder")
    e_, q_ = sympy.symbols("f q")
    for k in range(stages):
        one = R(f"r{k}", law=sympy.Symbol("r") * e_) if shared else R(f"r{k}")
        graph.one(f"n{k}", one)
        two = C(f"c{k}", law=q_ / sympy.Symbol("c")) if shared else C(f"c{k}")
        graph.zero(f"m{k}", two)
        graph.join(f"n{k}", f"m{k}")
        if k:
            graph.join(f"m{k - 1}", f"n{k}")
    graph.put(Se("u"), on="n0")
    graph.measure("v", effort=f"m{stages - 1}")
    return graph.finish()


def test_the_limit_is_the_number_of_terms_not_of_states() -> None:
    # With one r and one c, forty states are forty terms.
    transfer = linearise(derive(ladder(40, shared=True))).transfer_function()
    assert len(transfer.denominator_coefficients) == 41
    # RC ladder of equal stages: the first coefficient after 1 is n (n + 1)/2 rc.
    assert agree(
        transfer.denominator_coefficients[-2] / transfer.denominator_coefficients[-1],
        expression("820*r*c"),
    )
    with pytest.raises(EquationError, match=r"more than \d+ terms.*StateSpace"):
        linearise(derive(ladder(16))).transfer_function()


def test_eight_stages_with_their_own_parameters_are_still_a_formula() -> None:
    transfer = linearise(derive(ladder(8))).transfer_function()
    terms = sum(len(sympy.Add.make_args(c)) for c in transfer.denominator_coefficients)
    assert terms == fibonacci(17)
    values = {f"r{k}": 1.0 for k in range(8)} | {f"c{k}": 1.0 for k in range(8)}
    # By hand: each stage multiplies (V, I) by [[1 + s, 1], [s, 1]].
    stage = np.array([[1.0 + 0.3j, 1.0], [0.3j, 1.0]])
    chain = np.linalg.matrix_power(stage, 8)
    assert transfer.at(0.3j, values) == pytest.approx(1 / chain[0, 0])


def fibonacci(n: int) -> int:
    a, b = 0, 1
    for _ in range(n):
        a, b = b, a + b
    return a


# Descriptor form ------------------------------------------------------------------


def equal(one, other) -> bool:
    """Return whether two transfer functions are the same at arbitrary numbers."""
    if all(c == 0 for c in one.numerator_coefficients):
        return all(c == 0 for c in other.numerator_coefficients)
    return agree(one.expression, other.expression)


@LINEAR
def test_the_descriptor_form_has_the_same_transfer_functions(case) -> None:
    equations = derive(case.graph())
    system, form = linearise(equations), descriptor(equations)
    assert form.states == system.states
    assert form.E.shape[0] == len(form.states) + len(form.unknowns)
    for one, other in zip(
        system.transfer_matrix(), form.transfer_matrix(), strict=True
    ):
        assert equal(one, other), (one, other)


@pytest.mark.parametrize("seed", range(40))
def test_random_graphs_have_one_transfer_matrix_in_both_forms(seed: int) -> None:
    try:
        equations = derive(random_graph(seed).finish())
        system = linearise(equations)
    except BondGraphError:
        return  # conflicts and singular graphs are other tests' concern
    pairs = zip(
        system.transfer_matrix(), descriptor(equations).transfer_matrix(), strict=True
    )
    for one, other in pairs:
        assert equal(one, other), (one, other)


def mesh(stages: int) -> FinishedGraph:
    graph = BondGraph("mesh")
    graph.one("r0", Se("u"), R("series0"))
    for k in range(stages):
        graph.zero(f"n{k}", R(f"shunt{k}"))
        graph.join(f"r{k}", f"n{k}")
        graph.one(f"r{k + 1}", R(f"series{k + 1}"))
        graph.join(f"n{k}", f"r{k + 1}")
    graph.put(C("store"), on=f"r{stages}")
    graph.measure("v", effort="store")
    return graph.finish()


def test_a_resistive_mesh_is_sparser_as_a_descriptor() -> None:
    equations = derive(mesh(3))
    system = linearise(equations)
    assert system.sparser is Form.DESCRIPTOR
    assert system.descriptor_terms < system.terms
    assert linearise(derive(named("rlc_series"))).sparser is Form.STATE_SPACE
    form = descriptor(equations)
    assert len(form.unknowns) > 0
    assert equal(system.transfer_function(), form.transfer_function())


def test_a_descriptor_solves_by_hand() -> None:
    graph = BondGraph("two masses")
    graph.one("shaft", Se("force"), I("m1"), I("m2"), R("b"))
    graph.measure("v", flow="shaft")
    graph.measure("inner", effort="m2")
    form = descriptor(derive(graph.finish()))
    values = {"m1": 2.0, "m2": 3.0, "b": 0.5}
    put = {sympy.Symbol(n, real=True): v for n, v in values.items()}
    E, A, B, C_, D = (
        np.array(m.xreplace(put), dtype=complex)
        for m in (form.E, form.A, form.B, form.C, form.D)
    )
    found = C_ @ np.linalg.solve(0.7j * E - A, B) + D
    assert found[:, 0] == pytest.approx(
        [1 / (5.0 * 0.7j + 0.5), 3.0 * 0.7j / (5.0 * 0.7j + 0.5)]
    )
    assert agree(
        form.transfer_function("inner").expression, expression("m2*s/((m1 + m2)*s + b)")
    )
    assert form.transfer_function("v").denominator_coefficients[0].has(s) is False


def test_entries_are_counted_from_both_ends_and_no_further() -> None:
    matrix = linearise(derive(CASES[0].graph())).transfer_matrix()
    rows, columns = matrix.shape
    assert matrix[-rows, -columns] is matrix[0, 0]
    assert matrix[rows - 1, columns - 1] is matrix[-1, -1]
    for row in (rows, -rows - 1):
        with pytest.raises(EquationError, match="has no output"):
            matrix[row, 0]


def test_a_gain_is_in_front_as_it_is() -> None:
    form = PoleZeroGain(
        name="g",
        gain=sympy.Integer(2),
        zeros=(Factor((sympy.S.One, sympy.S.One), 1),),
        poles=(),
    )
    assert form.expression.args == (2, s + 1)


def test_the_coefficients_have_no_number_in_common_and_numbers_lead_with_one() -> None:
    graph = BondGraph("cart")
    graph.one("body", Se("push"), I("m"), R("rub", law=2 * sympy.Symbol("b") * f))
    graph.measure("v", flow="body")
    finished = graph.finish()
    form = linearise(derive(finished)).transfer_function()
    b, m = sympy.symbols("b m", real=True)
    assert form.denominator_coefficients == (m, 2 * b)
    heavy = BondGraph("heavy cart")
    law = sympy.Symbol("m") * f * 3
    heavy.one("body", Se("push"), I("i", law=law), R("rub", law=2 * f))
    heavy.measure("v", flow="body")
    form = linearise(derive(heavy.finish())).transfer_function()
    assert form.denominator_coefficients == (3 * m, 2)
    numbers = BondGraph("numbers")
    numbers.one("body", Se("push"), I("i", law=4 * f), R("rub", law=2 * f))
    numbers.measure("v", flow="body")
    form = linearise(derive(numbers.finish())).transfer_function()
    assert form.denominator_coefficients == (1, sympy.Rational(1, 2))
    assert form.numerator_coefficients == (sympy.Rational(1, 4),)


def test_a_refusal_is_about_the_name_that_was_given_or_the_model() -> None:
    system = linearise(derive(two_tanks()))
    with pytest.raises(EquationError, match="say which one") as told:
        system.transfer_function(input="in_left")
    assert told.value.about == ("two tanks",)
    with pytest.raises(EquationError, match="no output 'lw'") as told:
        system.transfer_function("lw", "in_left")
    assert told.value.about == ("lw",)
