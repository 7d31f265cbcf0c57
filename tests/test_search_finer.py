"""A curve's nearest rival is drawn finely as well, for few knots tell few places."""

import pytest
from judged_candidates import BASE, judged

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.laws import finer
from bondgraph.diagnosis.search.laws.finer import drawn_as_near, finest_of

ROUGH = judged(0.130, physics=CURVE, place="input", complexity=7)
RIVAL = judged(0.132, physics=CURVE, place="plant", complexity=8)


@pytest.fixture
def drawn(monkeypatch):
    """Return a function that says what curves leave once they are drawn finely."""

    def drawn(**left):
        def as_fine_as_told(bench, chosen, before):
            share = left[chosen.place]
            return judged(share, physics=CURVE, place=chosen.place)

        monkeypatch.setattr(finer, "as_fine_as_told", as_fine_as_told)

    return drawn


def places(judged, chosen=ROUGH):
    found = finest_of(None, chosen, judged, BASE)
    return [one.place for one in found.values()]


def test_the_place_is_the_one_where_a_fine_curve_predicts_better(drawn):
    drawn(input=0.10, plant=0.01)
    assert places([ROUGH, RIVAL]) == ["plant", "input"]
    drawn(input=0.10, plant=0.12)
    assert places([ROUGH, RIVAL]) == ["input", "plant"]


def test_each_stays_told_in_place_of_what_it_was_drawn_from(drawn):
    drawn(input=0.10, plant=0.01)
    found = finest_of(None, ROUGH, [ROUGH, RIVAL], BASE)
    assert found[id(ROUGH)].place == "input"
    assert found[id(RIVAL)].place == "plant"


def test_what_is_far_behind_or_not_supported_or_there_as_well_is_no_rival(drawn):
    drawn(input=0.10, plant=0.01)
    worse = judged(0.6, physics=CURVE, place="plant")
    unsure = judged(0.12, Support.UNDECIDED, physics=CURVE, place="plant")
    other = judged(0.131, physics=CURVE, place="input")
    named = judged(0.131, physics="drag", place="plant")
    assert places([ROUGH, worse, unsure, other, named]) == ["input"]


def of(left, *signals):
    """Return a curve at the input, of these signals."""
    curve = judged(left, physics=CURVE, place="input")
    curve.candidate.hypothesis.depends_on = signals
    return curve


def test_a_curve_of_something_else_at_the_same_place_is_a_rival_if_as_plain(
    monkeypatch,
):
    rough, speed = of(0.130, "displacement(input)", "flow(input)"), of(0.131, "flow")

    def as_fine_as_told(bench, chosen, before):
        return of(0.01 if chosen in (speed, swapped) else 0.1)

    swapped = of(0.131, "displacement(input)", "flow(input)")
    monkeypatch.setattr(finer, "as_fine_as_told", as_fine_as_told)
    found = finest_of(None, rough, [rough, speed], BASE)
    assert [*found] == [id(speed), id(rough)]
    assert [*finest_of(None, speed, [speed, swapped], BASE)] == [id(speed)]


def test_a_law_with_a_name_has_no_rival_drawn(drawn):
    drawn(input=0.10, plant=0.01)
    law = judged(0.13, physics="drag", place="input")
    assert places([law, RIVAL], law) == ["input"]


def test_a_curve_of_the_laws_own_variable_is_drawn_however_near_it_comes(monkeypatch):
    law = judged(0.05, physics="hardening_spring", place="input")
    law.candidate.hypothesis.depends_on = ("displacement",)
    own, other = of(0.4, "displacement"), of(0.4, "flow")
    elsewhere = judged(0.4, physics=CURVE, place="plant")
    elsewhere.candidate.hypothesis.depends_on = ("displacement",)
    monkeypatch.setattr(finer, "as_fine_as_told", lambda bench, chosen, before: chosen)
    drawn = drawn_as_near(None, law, [law, own, other, elsewhere], BASE)
    assert [curve for curve, _ in drawn] == [own]
