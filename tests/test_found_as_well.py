"""What was found as well is not what a finding may be instead."""

import pytest
from judged_candidates import BASE, RULE, judged

from bondgraph.diagnosis.answer.found import without_others
from bondgraph.diagnosis.evidence.confidence import probability
from bondgraph.diagnosis.search.round_found import Round

DROP = judged(0.60, physics="voltage_drop", place="winding")
SPRING = judged(0.59, physics="hardening_spring", place="blades")
SAME_SPRING = judged(0.595, physics="hardening_spring", place="rotor")
GRAVITY = judged(0.605, physics="gravity", place="rotor")
EVERY = (DROP, SPRING, SAME_SPRING, GRAVITY)


def found(*candidates, before=BASE):
    sure = probability(DROP, candidates, BASE, RULE)
    return Round(None, judged=candidates, chosen=DROP, probability=sure, before=before)


def test_it_and_what_is_not_told_from_it_are_no_rivals():
    told = without_others(found(*EVERY), {("hardening_spring", "blades")}, RULE)
    assert told.judged == (DROP, GRAVITY)
    assert told.probability > found(*EVERY).probability
    alone = without_others(
        found(DROP, SPRING, SAME_SPRING), {("hardening_spring", "blades")}, RULE
    )
    assert alone.probability == pytest.approx(1.0)


def test_where_nothing_else_was_found_all_stands():
    told = without_others(found(*EVERY), set(), RULE)
    assert told.judged == EVERY
    assert told.probability == found(*EVERY).probability


def test_what_the_finding_itself_may_be_elsewhere_is_kept():
    other, again = (judged(0.6, physics="voltage_drop", place=p) for p in ("x", "y"))
    told = without_others(found(DROP, other, again), {("voltage_drop", "x")}, RULE)
    assert told.judged == (DROP, again)


def test_what_was_not_judged_one_by_one_stays_as_sure_as_it_was():
    told = without_others(
        found(*EVERY, before=None), {("hardening_spring", "blades")}, RULE
    )
    assert told.judged == (DROP, GRAVITY)
    assert told.probability == found(*EVERY).probability
