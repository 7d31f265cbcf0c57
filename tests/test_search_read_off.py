"""Laws with a name are laid along a curve that leads, and fitted from there."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, I, R, Se
from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.search.laws import read_off
from bondgraph.diagnosis.search.laws.laid_along import laid_along
from bondgraph.diagnosis.search.laws.read_off import curve_that_leads
from bondgraph.numeric.along import along
from bondgraph.physics.actuation import Saturation
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction
from bondgraph.physics.places.channels import InputPlace
from bondgraph.physics.places.junction import junction_place
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.unknown import UnknownRelation

RANGES = {"effort(force)": (-4.0, 4.0), "flow(cart)": (-2.0, 2.0)}
SIZES = {"effort(force)": 2.0, "flow(cart)": 1.0}
X = np.linspace(-2.0, 2.0, 80)
U = np.linspace(-4.0, 4.0, 80)


def cart():
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("mass", 2.0), R("damping", 0.5))
    g.measure("speed", flow="cart", unit="m/s")
    return g.finish()


def laws(place, *physics):
    return [law for one in physics for law in one.propose(place)]


def at_input(*physics):
    return laws(InputPlace(cart(), "force", Scales(SIZES, RANGES)), *physics)


def at_cart(*physics):
    return laws(junction_place(cart(), "cart", Scales(SIZES, RANGES)), *physics)


def test_an_expression_is_evaluated_at_all_points_with_its_slopes():
    x, a, b = sympy.symbols("x a b", real=True)
    values, slopes = along(a * sympy.Min(x, b), x, np.array([-1.0, 2.0, 5.0]), [a, b])(
        np.array([3.0, 4.0])
    )
    np.testing.assert_allclose(values, [-3.0, 6.0, 12.0])
    np.testing.assert_allclose(slopes, [[-1.0, 0.0], [2.0, 0.0], [4.0, 3.0]])


def test_unequal_limits_are_read_off_a_curve_that_is_flat_at_both_ends():
    (curve, *_) = at_input(UnknownRelation())
    line = U, 0.9 * np.clip(U, -3.0, 1.5)
    found = {
        law.words: told
        for law in at_input(Saturation())
        if (told := laid_along(law, curve, line)) is not None
    }
    words, (left, values) = min(found.items(), key=lambda item: item[1][0])
    assert "a limit each way" in words
    assert left < 0.02
    lower, upper = values.values()
    assert lower == pytest.approx(-3.0, rel=0.15)
    assert upper == pytest.approx(1.5, rel=0.15)


def test_dry_friction_is_read_off_whatever_goes_in_proportion_beside_it():
    curve = next(law for law in at_cart(UnknownRelation()) if law.visited)
    line = X, 3.0 * np.sign(X) - 0.7 * X
    (left, values) = laid_along(at_cart(CoulombFriction())[0], curve, line)
    assert left < 0.05
    assert next(iter(values.values())) == pytest.approx(3.0, rel=0.1)
    assert laid_along(at_cart(QuadraticDrag())[0], curve, line) is None


def test_dry_friction_is_read_off_a_line_that_something_else_bends_down():
    curve = next(law for law in at_cart(UnknownRelation()) if law.visited)
    line = X, 3.0 * np.sign(X) - 2.0 * np.maximum(X, 0.0) ** 2
    (left, values) = laid_along(at_cart(CoulombFriction())[0], curve, line)
    assert 0.3 < left < 0.75
    assert next(iter(values.values())) > 1.0


def test_a_law_of_another_kind_of_place_is_not_laid_along():
    curve = next(law for law in at_cart(UnknownRelation()) if law.visited)
    assert laid_along(at_input(Saturation())[0], curve, (X, X**2)) is None


def fitted(physics, cost, place="cart"):
    hypothesis = SimpleNamespace(physics=physics, place=place, is_slip=False)
    return SimpleNamespace(hypothesis=hypothesis, cost=cost)


def test_a_curve_leads_where_no_law_with_a_name_comes_near():
    curve = fitted(CURVE, 1.0)
    assert curve_that_leads([curve, fitted("drag", 3.0)]) is curve
    assert curve_that_leads([curve, fitted("drag", 1.1)]) is None
    assert curve_that_leads([curve, fitted("drag", 0.9)]) is None
    assert curve_that_leads([]) is None


def test_the_nearest_laws_are_fitted_from_there(monkeypatch):
    curve = next(law for law in at_cart(UnknownRelation()) if law.visited)
    there = SimpleNamespace(
        hypothesis=curve, cost=1.0, fitted=SimpleNamespace(values={"mass": 2.2})
    )
    monkeypatch.setattr(read_off, "law_curve", lambda *_: (X, 3.0 * np.sign(X)))
    proposed = at_cart(QuadraticDrag(), CoulombFriction())
    (trial,) = read_off.read_off([there], proposed)
    assert trial.hypothesis.physics == "coulomb_friction"
    values = trial.starts[0].values
    assert values["mass"] == 2.2
    assert values[trial.hypothesis.parameters[0]] == pytest.approx(3.0, rel=0.1)
    assert read_off.read_off([there, fitted("drag", 1.1)], proposed) == []
