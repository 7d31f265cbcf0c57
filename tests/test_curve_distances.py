"""How far a variable is from a knot: what sympy finds, without looking for a sign."""

import pytest
import sympy

from bondgraph.physics.curves import _distance
from bondgraph.structure.signals import displacement, f, parameter_symbol, q

WIDTH = parameter_symbol("width")
LENGTH = sympy.Symbol("length", positive=True)
ANYTHING = sympy.Symbol("anything")

WITHOUT_A_SIGN = (
    f,
    f / WIDTH,
    displacement("x") / WIDTH,
    f * q / WIDTH,
    # Of a difference and its opposite sympy keeps one, by the names in it.
    *(x / parameter_symbol(name) for x in (f, q) for name in ("a", "curve_x", "zeta")),
)
OTHERS = (
    LENGTH,
    -LENGTH / 2,
    q**2,
    q**2 - 1,
    f + q,
    2 * f / WIDTH,
    sympy.sqrt(q),
    ANYTHING,
    sympy.I * f,
)


@pytest.mark.parametrize("knot", [-1.0, -0.3, 0.0, 0.7])
@pytest.mark.parametrize("x", [*WITHOUT_A_SIGN, *OTHERS], ids=str)
def test_a_distance_is_what_sympy_makes_of_it(x, knot):
    assert _distance(x, knot) == sympy.Abs(x - knot)


def test_no_sign_is_looked_for_where_there_is_none(monkeypatch):
    def asked(_):
        raise AssertionError("sympy was asked for a sign")

    monkeypatch.setattr(sympy.Abs, "eval", asked)
    apart = [_distance(x, 0.613) for x in WITHOUT_A_SIGN]
    assert all(isinstance(distance, sympy.Abs) for distance in apart)
    with pytest.raises(AssertionError, match="asked"):
        _distance(LENGTH, 0.613)
