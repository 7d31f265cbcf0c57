"""A finding whose numbers are gone where all recordings are fitted is in doubt."""

from types import SimpleNamespace

import pytest

from bondgraph.diagnosis.answer.all_together import doubted_together
from bondgraph.diagnosis.records import Finding
from bondgraph.fitting.result import Estimate


def numbers(*values):
    return tuple(
        Estimate(name=name, value=value, std=std, unit="1", start=None)
        for name, value, std in values
    )


def finding(physics="drag", *, size=2.0):
    return Finding(
        physics=physics,
        place="ball",
        element="drag",
        statement="Drag at ball was left out: a force.",
        probability=0.8,
        law="size*f",
        estimates=numbers(("size", size, 0.1)),
    )


def told(one, *everywhere):
    together = SimpleNamespace(estimates=numbers(*everywhere))
    return doubted_together([one], together)


def test_a_number_that_held_out_recordings_do_not_want_is_half_as_probable():
    for std in (0.1, None):
        (one,) = told(finding(), ("mass", 1.0, 0.1), ("size", 0.05, std))
        assert one.probability == pytest.approx(0.4)
        assert "may have been left out" in one.statement
        assert "no number of it that is told from none" in one.statement


@pytest.mark.parametrize(
    ("one", "size"),
    [(finding(), 1.5), (finding(size=0.1), 0.05), (finding("unknown_relation"), 0.05)],
    ids=["it stays", "it had none", "a curve's points are told together"],
)
def test_of_all_others_nothing_is_said(one, size):
    assert told(one, ("size", size, 0.1)) == [one]


def test_nothing_is_said_where_there_is_no_such_fit():
    assert doubted_together([finding()], None) == [finding()]
    assert told(finding(), ("mass", 1.0, 0.1)) == [finding()]


def test_what_held_out_recordings_speak_against_is_not_doubted_twice():
    together = SimpleNamespace(estimates=numbers(("size", 0.05, 0.1)))
    (one,) = doubted_together([finding()], together, stands=False)
    assert one.probability == pytest.approx(0.8)
    assert "no number of it" in one.statement
