"""Laws in the direction they are not written in: right, or refused by name.

The truth is the law itself: what a formula or a solver gives for the flow must have the
recorded effort as its value. Laws that give one effort at two flows must be refused.
"""

import numpy as np
import pytest
import sympy
from sympy import Abs, Heaviside, Max, Min, Mod, Piecewise, floor, sign, tanh

from bondgraph import BondGraph, I, R, Se, Sf, derive, simulate_inputs
from bondgraph.equations.chain_rule import derivative
from bondgraph.equations.deriving.inversion import Laws
from bondgraph.equations.reduction import reduce
from bondgraph.errors import EquationError
from bondgraph.simulation.trouble import RunStatus
from bondgraph.structure.signals import displacement, e, f, t

a, b, c = sympy.symbols("a b c", real=True)
VALUES = {"a": 0.7, "b": 0.4, "c": 0.9}
KNOWN = {a: 0.7, b: 0.4, c: 0.9}
EFFORTS = -3.987 + 0.2 * np.arange(41)
TIME = np.linspace(0.0, 1.0, len(EFFORTS))

TURNED = {
    "two pieces": Piecewise((f, f < 1), (2 * f - 1, True)),
    "pieces that include their edge": Piecewise((f, f <= 1), (2 * f - 1, True)),
    "the number on the left": Piecewise((f, sympy.Gt(1, f)), (2 * f - 1, True)),
    "pieces from above": Piecewise((3 * f - 2, f > 1), (f, f > -1), (2 * f + 1, True)),
    "an edge that is a parameter": Piecewise(
        (a * f, f < c), (b * f + (a - b) * c, True)
    ),
    "pieces that fall": Piecewise((-f, f < 1), (-2 * f + 1, True)),
    "dry beside viscous": a * f + b * sign(f),
    "dry and a bias": a * f + b * sign(f) + c,
    "the modulus without a name": a * f + b * f**2 * Abs(f) / f,
    "a power and a line": f**3 + f,
    "a step that is smooth": tanh(3 * f) + a * f,
    "a dead zone beside a line": Max(f - 1, 0) + a * f,
    "a line that parameters switch": Max(f - 1, 0) + (a + Heaviside(c - a)) * f,
    "falling": -(f**3) - a * f,
    "a root": sign(f) * sympy.sqrt(Abs(f)),
}
REFUSED = {
    "a jump up": Piecewise((f, f < 0), (f + 1, True)),
    "a jump down": Piecewise((f, f < 0), (f - 1, True)),
    "a jump between slopes": Piecewise((f, f < 0), (2 * f - 1, True)),
    "a jump in a term": f + Piecewise((0, f < 1), (-1, True)),
    "a jump at a second edge": Piecewise((f, f < 0), (2 * f, f < 1), (f, True)),
    "pieces that turn back": Piecewise((f, f < 1), (2 - f, True)),
    "a flat piece": Piecewise((f, f < 1), (1, True)),
    "pieces over a range": Piecewise((f, (f > -1) & (f < 1)), (2 * f, True)),
    "edges both ways": Piecewise((f, f < -1), (2 * f + 3, f > 1), (f, True)),
    "dry the wrong way": a * f - b * sign(f),
    "stairs down": f - floor(f) / 2,
    "a saw": f + Mod(f, 1),
    "a step down": f - Heaviside(f),
    "flat below": Max(f, 0),
    "flat above": Min(f, 1),
    "a wave": sympy.sin(f),
    "flat on one side": f + Abs(f),
}


def line(law: sympy.Expr, *others: R):
    """Return a source of effort over a resistance with this law, its current read."""
    graph = BondGraph("line", domain="electrical")
    graph.one("line", Se("u"), R("r", law=law), *others)
    graph.measure("current", flow="line")
    for symbol in law.free_symbols - {f}:
        graph.parameter(symbol.name, VALUES[symbol.name], "1", bounds=(0, 10))
    return graph.finish()


def efforts(law: sympy.Expr, flows):
    """Return the efforts that a law has just beside flows, least and largest."""
    known = sympy.lambdify(f, law.subs({n: VALUES[str(n)] for n in (a, b, c)}), "numpy")
    sides = np.array([[known(x - 1e-9), known(x + 1e-9)] for x in flows])
    return sides.min(axis=1), sides.max(axis=1)


@pytest.mark.parametrize("name", TURNED)
def test_a_law_turned_round_has_the_effort_that_was_asked_for(name):
    run = simulate_inputs(line(TURNED[name]), TIME, inputs={"u": EFFORTS})
    assert run.status is RunStatus.SUCCESSFUL, run.reason
    low, high = efforts(TURNED[name], run.output("current"))
    assert (low - 1e-6 <= EFFORTS).all()
    assert (high + 1e-6 >= EFFORTS).all()


@pytest.mark.parametrize("name", REFUSED)
def test_a_law_that_gives_one_effort_twice_or_never_is_refused_by_name(name):
    with pytest.raises(EquationError, match="no unique inverse") as refused:
        derive(line(REFUSED[name]))
    assert refused.value.about == ("r",)


@pytest.mark.parametrize(
    ("value", "bounds", "law"),
    [
        (1.0, (-1, 1), c * f + f**3),
        (1.0, (-0.5, 3), c * f + f**3),
        (-1.0, (-1, 0.5), c * f - f**3),
        (-1.0, (-1, 1), c * f - f**3),
    ],
)
def test_what_may_have_either_sign_within_its_bounds_is_not_turned_round(
    value, bounds, law
):
    graph = BondGraph("line", domain="electrical")
    graph.one("line", Se("u"), R("r", law=law))
    graph.parameter("c", value, "1", bounds=bounds)
    with pytest.raises(EquationError, match="no unique inverse"):
        derive(graph.finish())


@pytest.mark.parametrize(
    ("value", "bounds", "law"),
    [
        (1.0, (0, 2), c * f + f**3),
        (None, (0, 2), c * f + f**3),
        (-1.0, (-2, 0), c * f - f**3),
    ],
)
def test_what_has_one_sign_within_its_bounds_is_turned_round(value, bounds, law):
    graph = BondGraph("line", domain="electrical")
    graph.one("line", Se("u"), R("r", law=law))
    graph.parameter("c", value, "1", bounds=bounds)
    assert len(derive(graph.finish()).unknowns) == 1


def test_pieces_of_one_slope_stay_an_unknown_in_the_equations_one_reads():
    law = Piecewise((f, f < 1), (f + 1, True))
    graph = line(law, R("series"))
    reduced = reduce(derive(graph.with_parameters({"series": 2.0})))
    (unknown,), (residual,) = reduced.unknowns, reduced.residuals
    (output,) = reduced.outputs
    u, series = sympy.symbols("u series", real=True)
    # 2 i + i (+ 1 beyond i = 1): at u = 2.5 i is 5/6, and at 7 it is 2.
    for value, current in ((2.5, 2.5 / 3), (7.0, 2.0)):
        at = {u: value, series: 2.0, unknown: value - 2.0 * current}
        assert float(residual.subs(at)) == pytest.approx(0.0, abs=1e-12)
        assert float(output.expression.subs(at)) == pytest.approx(current)


def test_the_modulus_of_a_logarithm_is_differentiated_as_a_real_one():
    # d|log f|/df = sign(log f) / f; sympy leaves it open, because f may be negative.
    x = sympy.Symbol("x", real=True)
    for expression in (Abs(sympy.log(x + 3)) * x, sign(sympy.log(x + 3)) + x):
        slope = derivative(expression, x)
        for point in (-2.5, -1.3, 0.4, 2.0):
            near = [float(expression.subs(x, point + d).evalf()) for d in (-1e-6, 1e-6)]
            assert float(slope.subs(x, point).evalf()) == pytest.approx(
                (near[1] - near[0]) / 2e-6, rel=1e-6
            )


def formula_of(law):
    graph = BondGraph("line", domain="electrical")
    element = R("r", law=law)
    graph.one("line", Se("u"), element)
    for symbol in law.free_symbols - {f}:
        graph.parameter(symbol.name, VALUES[symbol.name], "1", bounds=(0, 10))
    return Laws(graph.finish()).explicit(element, f)


@pytest.mark.parametrize(
    "name",
    [
        "two pieces",
        "an edge that is a parameter",
        "dry beside viscous",
        "dry and a bias",
    ],
)
def test_what_rises_in_pieces_or_beside_dry_friction_has_a_formula(name):
    law = TURNED[name]
    formula = formula_of(law)
    assert formula is not None
    for value in (-3.1, -0.2, 0.3, 2.2):
        low, high = efforts(law, [float(formula.subs({**KNOWN, e: value}))])
        assert low[0] - 1e-6 <= value <= high[0] + 1e-6


def test_a_law_that_reads_something_else_is_judged_by_its_own_slope():
    graph = BondGraph("line", domain="electrical")
    graph.one("wheel", I("j"), R("rub"))
    law = (2 + sympy.sin(displacement("wheel"))) * f + f**3
    graph.one("line", Se("u"), R("r", law=law))
    # Of what is read nothing is known, so that its coefficient may have either sign.
    with pytest.raises(EquationError, match="no unique inverse"):
        derive(graph.finish())
    graph = BondGraph("line", domain="electrical")
    graph.one("line", Se("u"), R("r", law=(1 + t**2) * f + f**3))
    assert derive(graph.finish()).unknowns


def test_the_remedy_is_one_that_the_element_can_have():
    graph = BondGraph("line")
    graph.one("line", Se("u"), R("r", law=sympy.sin(f)))
    with pytest.raises(EquationError) as told:
        derive(graph.finish())
    assert told.value.remedy.endswith("put a storage beside it that gives it its flow.")
    graph = BondGraph("node")
    graph.zero("node", Sf("u"), R("r", law=sympy.sin(e)))
    with pytest.raises(EquationError) as told:
        derive(graph.finish())
    assert told.value.remedy.endswith(
        "put a storage beside it that gives it its effort."
    )
