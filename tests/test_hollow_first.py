"""A curve is told in place of laws the first of which has no number."""

from types import SimpleNamespace

import pytest
from judged_candidates import judged

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.search import looks
from bondgraph.diagnosis.search.looks import Look
from bondgraph.diagnosis.search.revising import hollow_first
from bondgraph.diagnosis.search.revising.hollow_first import in_place_of_hollow
from bondgraph.diagnosis.search.round_found import Round

AMID = judged(0.3, physics="added_compliance", place="collar")
BESIDE = judged(0.1, physics="added_compliance", place="group")
ROUGH = judged(0.2, physics=CURVE, place="group", complexity=6)


def instead(monkeypatch, rounds, curve_leaves, *, hollow=(AMID,)):
    """Return what is told in place of the rounds, where a curve can be drawn finely."""
    fine = judged(curve_leaves, physics=CURVE, place="group", complexity=12)
    empty = [one.candidate for one in hollow]
    for name, stand_in in {
        "ends_as_nothing": lambda _, one: one in empty,
        "drawn_beside": lambda _, __, judged, ___: (
            [(ROUGH, fine)] if ROUGH in judged else []
        ),
    }.items():
        monkeypatch.setattr(hollow_first, name, stand_in)
    return in_place_of_hollow(rounds, None)


def two_laws(*beside, first=AMID, removed=()):
    """Return rounds that chose one law after the other; the first one judged more."""
    return [
        Round(None, judged=(first, *beside), chosen=first),
        Round(None, judged=(BESIDE,), chosen=BESIDE, removed=removed),
        Round(None),
    ]


@pytest.mark.parametrize(("leaves", "told"), [(0.01, True), (0.12, True), (0.2, False)])
def test_a_curve_that_leaves_about_as_much_is_told(monkeypatch, leaves, told):
    found = instead(monkeypatch, two_laws(ROUGH), leaves)
    assert (found is not None) is told
    if told:
        assert (found.curve, found.index) == (ROUGH, 0)


@pytest.mark.parametrize(
    ("rounds", "hollow"),
    [
        (two_laws(ROUGH), ()),
        (two_laws(ROUGH), (BESIDE,)),
        (two_laws(), (AMID,)),
        (two_laws(ROUGH, removed=(AMID.candidate.hypothesis,)), (AMID, BESIDE)),
        (two_laws(AMID, first=ROUGH), (ROUGH,)),
        ([Round(None)], (AMID,)),
    ],
    ids=[
        "the first has a number", "only the second has none", "no curve came as near",
        "the first was taken out", "it is a curve itself", "nothing was found",
    ],
)  # fmt: skip
def test_there_is_none(monkeypatch, rounds, hollow):
    assert instead(monkeypatch, rounds, 0.01, hollow=hollow) is None


@pytest.mark.parametrize("has_number", [False, True])
def test_a_look_whose_laws_have_no_number_explains_nothing(monkeypatch, has_number):
    monkeypatch.setattr(looks, "ends_as_nothing", lambda *_: not has_number)
    seen = Look(two_laws(), SimpleNamespace())
    assert seen.is_named
    assert seen.is_told is has_number
