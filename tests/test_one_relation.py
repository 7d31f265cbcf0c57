"""A named law and a curve of its variable beside it are told as one relation."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from judged_candidates import judged

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.revising.one_relation import one_relation, pieces_of
from bondgraph.diagnosis.search.round_found import Round

SPEED, SWING = ("flow",), ("displacement",)


def along(variable, left=0.1, physics=CURVE, place="bit", **more):
    """Return a candidate that depends on one variable of its place."""
    return judged(left, physics=physics, place=place, depends_on=variable, **more)


LIMIT = along(SPEED, 0.18, physics="saturation")
IN_ITS_PLACE = along(SPEED, 0.04, complexity=6)
MENDS = along(SPEED, 0.01, complexity=30)


def rounds_of(first, second, *beside):
    """Return rounds that chose one after the other; the first one judged more."""
    return [
        Round(None, judged=(first, *beside), chosen=first),
        Round(None, judged=(second,), chosen=second),
        Round(None),
    ]


def test_the_curve_that_was_tried_in_the_laws_place_is_held_against_both():
    whole = one_relation(rounds_of(LIMIT, MENDS, IN_ITS_PLACE))
    assert whole.curve is IN_ITS_PLACE
    assert (whole.index, whole.named) == (0, MENDS)
    assert whole.times == pytest.approx(0.25, rel=0.05)


@pytest.mark.parametrize(
    "rounds",
    [
        rounds_of(LIMIT, MENDS),
        rounds_of(LIMIT, along(SWING, 0.01), IN_ITS_PLACE),
        rounds_of(LIMIT, along(SPEED, 0.01, place="head"), IN_ITS_PLACE),
        rounds_of(LIMIT, along(SPEED, 0.01, physics="drag"), IN_ITS_PLACE),
        rounds_of(along(SPEED, 0.18, physics="coulomb_friction"), MENDS, IN_ITS_PLACE),
        rounds_of(along((), 0.18, physics="play"), along((), 0.01), IN_ITS_PLACE),
        rounds_of(MENDS, LIMIT, IN_ITS_PLACE),
        rounds_of(LIMIT, MENDS, along(SPEED, support=Support.REFUTED)),
        rounds_of(LIMIT, MENDS, along(SWING)),
        rounds_of(LIMIT, MENDS, along(SPEED, place="head")),
        [Round(None, judged=(LIMIT, IN_ITS_PLACE), chosen=LIMIT), Round(None)],
        [Round(None)],
    ],
    ids=[
        "no curve was tried there", "of another variable", "elsewhere",
        "another law with a name", "dry friction", "of no one variable",
        "the curve came first", "refuted", "tried of another variable",
        "tried elsewhere", "no curve beside it", "nothing found",
    ],
)  # fmt: skip
def test_there_is_none(rounds):
    assert one_relation(rounds) is None


@pytest.mark.parametrize("fine", [False, True])
def test_a_law_gave_way_to_a_curve_that_is_not_drawn_yet(fine):
    first, second, last = rounds_of(LIMIT, MENDS, IN_ITS_PLACE)
    edit = SimpleNamespace(parameters=(SimpleNamespace(std=0.2 if fine else None),))
    hypothesis = SimpleNamespace(**{**vars(MENDS.candidate.hypothesis), "edit": edit})
    candidate = SimpleNamespace(**{**vars(MENDS.candidate), "hypothesis": hypothesis})
    second = replace(
        second,
        chosen=replace(MENDS, candidate=candidate),
        removed=(LIMIT.candidate.hypothesis,),
    )
    whole = one_relation([first, second, last])
    assert (whole is None) is fine
    if not fine:
        assert (whole.curve, whole.index) == (IN_ITS_PLACE, 0)


def test_pieces_are_the_laws_that_a_curve_was_tried_in_the_place_of():
    law = LIMIT.candidate.hypothesis
    assert pieces_of(rounds_of(LIMIT, MENDS, IN_ITS_PLACE)) == (law,)
    # Beside any other law a curve is drawn as finely as any.
    assert pieces_of(rounds_of(LIMIT, MENDS)) == ()
    assert pieces_of([Round(None)]) == ()
