"""A slope where a law switches is a slope only if it is one on either side."""

import pytest
import sympy
from sympy import Abs, Eq, Gt, Heaviside, Max, Ne, Piecewise, sign

from bondgraph import BondGraph, C, I, R, Se, Sf, derive, linearise, q
from bondgraph.errors import EquationError

a, b, k = sympy.symbols("a b k", real=True)


def slope(law, at=0):
    """Return the slope of a spring's law, read from the linear system it is in."""
    graph = BondGraph("sprung")
    graph.one("body", Se("push"), I("m"), R("rub"), C("spring", law=law))
    system = linearise(derive(graph.finish()), at={"q_spring": at})
    states = list(system.states)
    found = system.A[states.index("p_m"), states.index("q_spring")]
    return sympy.simplify(-found)


SMOOTH = {
    "a square that turns round": (q * Abs(q), 0),
    "a line and that": (k * q + q * Abs(q), k),
    "by its sign": (k * q + q**2 * sign(q), k),
    "a step": (k * q + q**2 * Heaviside(q), k),
    "below": (Piecewise((k * q, q < 0), (k * q + q**2, True)), k),
    "up to": (Piecewise((k * q, q <= 0), (k * q + q**2, True)), k),
    "above": (Piecewise((k * q + q**2, q > 0), (k * q, True)), k),
    "from": (Piecewise((k * q + q**2, q >= 0), (k * q, True)), k),
    "the other way round": (Piecewise((k * q, Gt(0, q)), (k * q + q**2, True)), k),
    "all but one point": (Piecewise((0, Eq(q, 0)), (k * q, True)), k),
    "at one point": (Piecewise((k * q, Ne(q, 0)), (0, True)), k),
    "an end stop that is soft": (k * q + Max(0, q) ** 2, k),
    "halves of one line": (
        Piecewise((k * q, q < 0), (0, True)) + Piecewise((0, Gt(0, q)), (k * q, True)),
        k,
    ),
    "two that make up for each other": (
        a * Abs(q) + Piecewise((k * q, q < 0), (k * q - 2 * a * q, True)),
        k - a,
    ),
    "one switch in another": (
        k * q + Piecewise((q**2, q + Abs(q) < 1), (q, True)),
        k,
    ),
    "one that depends on parameters alone": (k * q * Heaviside(a), k * Heaviside(a)),
}
KINKED = {
    "a modulus": (Abs(q), "q_spring"),
    "an end stop": (k * Max(0, q), "q_spring"),
    "two slopes": (Piecewise((k * q, q < 0), (2 * k * q, True)), "q_spring"),
    "two slopes from above": (Piecewise((k * q, q > 0), (b * q, True)), "q_spring"),
    "halves that are none": (
        Piecewise((k * q, q < 0), (0, True))
        + Piecewise((0, Gt(0, q)), (2 * k * q, True)),
        "q_spring",
    ),
}


@pytest.mark.parametrize(("law", "expected"), SMOOTH.values(), ids=SMOOTH)
def test_what_has_one_slope_on_either_side_has_it(law, expected):
    assert sympy.simplify(slope(law) - expected) == 0


@pytest.mark.parametrize(("law", "where"), KINKED.values(), ids=KINKED)
def test_what_has_two_slopes_is_refused_where_it_switches(law, where):
    with pytest.raises(EquationError, match="kink at") as told:
        slope(law)
    assert f"{where} = 0" in told.value.problem
    # Beside the point it has a slope, that of its side.
    right = law.subs(q, 2 * q) - law
    for place in (-1, 1):
        expected = right.subs(q, place) / place
        assert sympy.simplify(slope(law, place) - expected) == 0


def test_a_jump_is_refused_and_so_is_a_step_without_a_slope():
    with pytest.raises(EquationError, match="jump"):
        slope(Piecewise((k * q, q < 0), (k * q + 1, True)))
    with pytest.raises(EquationError):
        slope(k * q + sign(q))
    assert slope(Piecewise((k * q, q < 0), (k * q + 1, True)), 1) == k


def test_kinks_of_two_springs_are_told_apart():
    graph = BondGraph("two springs")
    graph.zero("left", Sf("u"), C("one", law=q * Abs(q)), R("r"))
    graph.zero("right", Sf("v"), C("two", law=k * Abs(q)), R("g"))
    with pytest.raises(EquationError, match="q_two = 0") as told:
        linearise(derive(graph.finish()))
    assert "q_one" not in told.value.problem
    assert told.value.about == ("q_two",)
