"""What the search refuses, and how a curve is divided."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, C, I, R, Se
from bondgraph.diagnosis.search.laws.drawing import lines_in
from bondgraph.diagnosis.search.revising.removal import gone_from
from bondgraph.diagnosis.search.trials.trying import UNSOLVED, _or_refused
from bondgraph.errors import BondGraphError, EquationError
from bondgraph.physics.bias import ConstantBias
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.physics.position import Spring
from bondgraph.physics.smooth import Smooth
from bondgraph.physics.unknown import BOTH_WAYS, UnknownRelation
from bondgraph.structure.parameters import Parameter


def cart():
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("mass"), R("damper"), C("compliance"))
    g.measure("position", displacement="cart")
    return g.finish()


def law(**strengths):
    return SimpleNamespace(
        strengths=tuple(strengths), physics="load_dependent_friction", place="rod"
    )


FOUND = "load_dependent_friction at rod"


def test_a_law_that_leaves_nothing_of_an_earlier_one_is_its_rival():
    earlier, before = law(mu=1.0), {"mu": 0.08}
    known = {"mu": 1e-4, "bend": 0.1}
    for mu, said in ((0.001, FOUND), (-0.05, None)):
        after = {"mu": mu, "bend": 0.5}
        assert gone_from(before, after, known, [earlier], {}) == said
    # What was taken out or has no strength of its own says nothing.
    assert gone_from(before, {"bend": 0.5}, known, [earlier], {}) is None
    assert gone_from(before, {"mu": 0.0}, known, [law()], {}) is None


def test_a_law_that_is_not_told_from_none_any_more_is_gone():
    earlier, before = law(mu=1.0), {"mu": 0.019}
    for mu, std, said in (
        (0.007, 0.004, FOUND),
        (0.007, 0.001, None),
        # Hardly known, but as large as it was: the data say less, not otherwise.
        (0.018, 0.012, None),
    ):
        assert gone_from(before, {"mu": mu}, {"mu": std}, [earlier], {}) == said


def test_all_strengths_of_a_law_must_be_gone():
    wide, before = law(coulomb=1.0, mu=1.0), {"coulomb": 2.0, "mu": 0.1}
    assert gone_from(before, {"coulomb": 1e-3, "mu": 0.1}, {}, [wide], {}) is None
    assert gone_from(before, {"coulomb": 1e-3, "mu": 1e-3}, {}, [wide], {}) == FOUND


def test_a_law_of_the_model_itself_may_not_go_for_a_later_finding():
    given = {
        "friction": Parameter(name="friction", value=5.0, unit="N", bounds=(0, 100)),
        "offset": Parameter(name="offset", value=1.0, unit="N"),
    }
    before = {"friction": 3.2, "offset": 0.9}
    stds = {"friction": 0.1, "offset": 0.1}
    gone = {"friction": 0.0, "offset": 0.9}
    assert gone_from(before, gone, stds, [], given) == "parameter friction"
    # What was hardly there before the addition has not gone by it.
    assert gone_from({"friction": 0.3}, gone, stds, [], given) is None
    # What had come down already and is a third of that is still there.
    little = {"friction": 0.4, "offset": 0.9}
    assert gone_from({"friction": 1.2}, little, stds, [], given) is None
    # Nor one of which the recordings do not tell that it is none.
    wide = {"friction": 0.4}
    assert gone_from({"friction": 1.0}, gone, wide, [], given) is None
    # An offset may be zero, and a friction that was swollen may shrink.
    assert gone_from(before, {"friction": 0.9, "offset": 0.0}, stds, [], given) is None


def test_slips_are_the_only_hypotheses_without_a_number():
    slips = {
        hypothesis.words
        for place in all_places(cart(), Scales())
        for physics in LIBRARY
        for hypothesis in physics.propose(place)
        if hypothesis.is_slip
    }
    assert slips
    assert all("is recorded" in w or "reads" in w for w in slips), slips


def test_no_law_contains_itself_and_no_two_contain_each_other():
    here = [
        hypothesis
        for place in all_places(cart(), Scales())
        for physics in LIBRARY
        for hypothesis in physics.propose(place)
    ]
    pairs = [(a, b) for a in here for b in here if a.contains(b)]
    assert not [a.told_by for a, b in pairs if b.contains(a)]
    # One law in two forms: the one with more numbers contains the other.
    forms = [(a, b) for a, b in pairs if a.physics == b.physics]
    assert forms
    assert all(len(a.parameters) > len(b.parameters) for a, b in forms)


def test_a_spring_without_stiffness_is_a_constant_bias():
    slider = BondGraph("slider", domain="translation")
    slider.one("slider", Se("force"), I("mass"), R("damper"))
    slider.measure("position", displacement="slider")
    (place,) = (p for p in all_places(slider.finish(), Scales()) if p.name == "slider")
    (bias,) = ConstantBias().propose(place)
    (spring,) = Spring().propose(place)
    assert spring.contains(bias)
    assert set(spring.strengths) - set(bias.parameters) == {"stiffness_slider"}
    # Beside a constant source its own preload would be the same number twice.
    (beside,) = (
        hypothesis
        for where in all_places(bias.apply(slider.finish()), Scales())
        if where.name == "slider"
        for hypothesis in Spring().propose(where)
    )
    assert beside.parameters == ("stiffness_slider",)


def curves(smooth=None):
    return {
        (h.place, h.words): h
        for place in all_places(cart(), Scales())
        for h in UnknownRelation(smooth).propose(place)
    }


def drawn(hypothesis, values, ends=(-0.49, 0.49), points=41):
    """Return the law within the range visited, with such values of what is fitted."""
    known = {p.name: p.value for p in hypothesis.edit.parameters if p.exact}
    known |= values
    symbols = sorted(hypothesis.law.free_symbols, key=str)
    (x,) = [s for s in symbols if s.name not in known][:1]
    rest = {s: known.get(s.name, 1.0) for s in symbols if s is not x}
    curve = sympy.lambdify(x, hypothesis.law.subs(rest))
    at = np.linspace(*ends, points)
    return np.broadcast_to(curve(at), at.shape)


def test_a_smooth_curve_begins_as_the_first_one():
    draw = np.random.default_rng(1)
    for key, first in curves().items():
        count = len(first.strengths)
        heights = draw.normal(size=count)
        second = curves(Smooth((*heights, 0.0, 0.0), 4, 1.0))[key]
        # Level and slope, and a bend at every knot but the ends; friction jumps, in
        # place of one bend.
        jumps = "function of velocity" in key[1]
        assert len(second.strengths) == 4 * (count - 1) + 1
        assert any("_jump_" in name for name in second.strengths) == jumps
        before = drawn(first, dict(zip(first.strengths, heights, strict=True)))
        assert np.allclose(before, drawn(second, second.starts[0]), atol=1e-9), key


@pytest.mark.parametrize("stem", ["curve", "curve_slope_b", "curve_level"])
@pytest.mark.parametrize("place", ["tank", "level_gauge", "slope", "bend_level_1"])
def test_the_lines_of_a_curve_are_known_wherever_it_is(stem, place):
    parts = ("jump", "level", "slope", "bend_1", "bend_12")
    names = {part: f"{stem}_{part}_{place}" for part in parts}
    lines = {names["slope"]: "slope", names["level"]: "level"}
    assert lines_in(tuple(names.values())) == lines
    del names["jump"], names["level"], lines[f"{stem}_level_{place}"]
    assert lines_in(tuple(names.values())) == lines


@pytest.mark.parametrize("odd", [False, True])
def test_no_number_of_a_smooth_curve_is_told_by_its_others(odd):
    smooth = Smooth((0.0, 1.0, 3.0, 2.0, 1.0, 4.0, 0.0, 2.0), 1, 1.0, odd=odd)
    of_one = [one for (_, words), one in curves(smooth).items() if "function" in words]
    assert len(of_one) == 2
    for curve in of_one:
        own = curve.strengths
        each = [{name: float(name == one) for name in own} for one in own]
        parts = [drawn(curve, one, (-3.0, 3.0), 2001) for one in each]
        assert np.linalg.matrix_rank(parts) == len(own), curve.words


def test_a_curve_that_is_the_same_both_ways_begins_as_half_of_what_turns_round():
    draw = np.random.default_rng(2)
    odd_ones = 0
    for key, first in curves().items():
        heights = draw.normal(size=len(first.strengths))
        smooth = Smooth((*heights, 0.0, 0.0), 4, 1.0, odd=True)
        place = [h for h in curves(smooth).values() if h.place == key[0]]
        (odd,) = [h for h in place if h.words == key[1] + BOTH_WAYS] or [None]
        if odd is None:
            continue
        odd_ones += 1
        there = drawn(odd, odd.starts[0])
        assert np.allclose(there, -np.array(there)[::-1], atol=1e-9)
        before = np.array(
            drawn(first, dict(zip(first.strengths, heights, strict=True)))
        )
        assert np.allclose(there, (before - before[::-1]) / 2, atol=1e-9), key
        wholly = curves(Smooth((*heights, 0.0, 0.0), 4, 1.0))[key]
        assert len(odd.strengths) < 0.6 * len(wholly.strengths)
    assert odd_ones == 3  # of the speed, the displacement, and the force commanded


def test_only_a_curve_that_goes_both_ways_can_be_the_same_both_ways():
    odd = Smooth((0.0, 1.0), 4, 1.0, odd=True)
    assert odd.is_odd_over((-1.0, 2.0))
    assert not odd.is_odd_over((-0.1, 2.0))
    assert not odd.is_odd_over((0.5, 2.0))
    assert not Smooth((0.0, 1.0), 4, 1.0).is_odd_over((-1.0, 2.0))


def test_a_rougher_curve_may_bend_more_and_is_no_larger():
    heights = (0.0, 1.0, 2.0, 2.0, 1.0, 0.0, 0.0, 0.0)
    for key, smooth in curves(Smooth(heights, 4, 1.0)).items():
        rough = curves(Smooth(heights, 4, 10.0))[key]
        for one, other in zip(
            smooth.edit.parameters, rough.edit.parameters, strict=True
        ):
            times = 10.0 if "bend" in one.name else 1.0
            assert one.exact or other.std == pytest.approx(times * one.std)


def test_what_is_said_of_a_law_that_cannot_be_solved_holds_no_formula():
    def unsolved():
        raise EquationError("The law e = a*tanh(f) gives e.", (), "Write it in e.")

    def unsimulated():
        raise BondGraphError("It could not be simulated.", (), "Give other values.")

    assert _or_refused(unsolved) == {"refused": UNSOLVED}
    assert _or_refused(unsimulated) == {"refused": "It could not be simulated."}
