"""What is said of a model's own numbers where the fit has left or would leave them."""

import pytest

from bondgraph import BondGraph, C, I, R, Se, Sf
from bondgraph.diagnosis.answer.stated import at_bounds, contradicted, driven_away
from bondgraph.fitting.result import Estimate


def cart(**mass):
    g = BondGraph("cart", domain="translation")
    g.one("body", Se("push"), I("mass"), R("grease"))
    g.parameter("mass", 2.0, "kg", **mass)
    g.parameter("grease", 1.0, "N*s/m", bounds=(0, 5))
    g.measure("speed", flow="body")
    return g.finish()


def ended(name, value, std=0.01, unit="kg"):
    return Estimate(name=name, value=value, std=std, unit=unit, start=2.0)


@pytest.mark.parametrize(
    ("value", "said"), [(1.0, "mass at 1 kg"), (4.0, "mass at 4 kg"), (3.999, None)]
)
def test_a_value_at_a_stated_bound_is_told(value, said):
    notes = at_bounds(cart(bounds=(1, 4)), [ended("mass", value)])
    assert len(notes) == (said is not None)
    assert said is None or said in notes[0]


def test_several_values_at_bounds_make_one_sentence():
    graph = cart(bounds=(1, 4))
    both = [ended("mass", 4.0), ended("grease", 5.0, unit="N*s/m")]
    (note,) = at_bounds(graph, both)
    assert "mass at 4 kg and grease at 5 N*s/m." in note


def test_no_friction_and_no_bound_and_what_was_added_are_nothing_to_tell():
    free = ended("mass", 4.0)
    assert at_bounds(cart(), [free]) == ()
    none = ended("grease", 0.0, unit="N*s/m")
    assert at_bounds(cart(bounds=(1, 4)), [none, ended("coulomb_body", 4.0)]) == ()


@pytest.mark.parametrize(
    ("value", "word"), [(2.6, "added_inertia"), (2.4, None), (1.4, "unknown_relation")]
)
def test_a_stated_value_five_standard_deviations_off_is_a_finding(value, word):
    found = contradicted(cart(std=0.1), [ended("mass", value)])
    assert [one.physics for one in found] == ([] if word is None else [word])
    for one in found:
        assert one.place == "mass"
        assert "stated 2 ± 0.1 kg" in one.statement


def test_a_value_without_a_tolerance_contradicts_nothing():
    assert contradicted(cart(bounds=(1, 4)), [ended("mass", 3.9)]) == ()


@pytest.mark.parametrize(
    ("before", "after", "std", "told"),
    [
        (2.2, 7.0, 0.1, True),  # With a law that takes it back.
        (2.2, 5.0, 0.1, False),
        (2.2, 0.2, 0.001, False),  # What the law does the mass need not do.
        (7.5, 7.0, 0.1, False),  # It had run there for want of something else.
        (2.2, 7.0, 1.0, False),  # Hardly known.
    ],
)
def test_an_element_that_does_far_more_only_with_what_was_found_is_told(
    before, after, std, told
):
    without, now = ended("mass", before), ended("mass", after, std)
    notes = driven_away(cart(), [without], [now, ended("coulomb_body", 4.0)])
    assert len(notes) == told
    if told:
        assert "mass is 7 kg, without it 2.2 kg, near the stated 2 kg" in notes[0]


def test_a_spring_does_more_where_it_gives_way_less():
    g = BondGraph("valve", domain="hydraulic")
    g.zero("tank", Sf("pump"), C("store"), R("outlet"))
    g.one("line", Se("head"), C("bladder"))
    g.join("line", "tank")
    g.measure("level", effort="tank")
    for name, unit in (("store", "m^3/Pa"), ("outlet", "Pa*s/m^3")):
        g.parameter(name, 2.0, unit)
    g.parameter("bladder", 2.0, "m^3/Pa")
    graph = g.finish()
    for name, more in (("store", 8.0), ("outlet", 0.5), ("bladder", 0.5)):
        first, last = ended(name, 2.0), ended(name, more, 0.001)
        assert len(driven_away(graph, [first], [last])) == 1
        less = ended(name, 4.0 / more, 0.001)
        assert driven_away(graph, [first], [less]) == ()
