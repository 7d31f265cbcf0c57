"""A finding whose numbers are gone where all recordings are fitted is told as such."""

from types import SimpleNamespace

import pytest

from bondgraph.diagnosis.answer.all_together import gone_together
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
        statement="",
        law="size*f",
        estimates=numbers(("size", size, 0.1)),
    )


def told(one, *everywhere):
    return list(gone_together([one], SimpleNamespace(estimates=numbers(*everywhere))))


def test_a_number_that_held_out_recordings_do_not_want_is_told():
    for std in (0.1, None):
        (note,) = told(finding(), ("mass", 1.0, 0.1), ("size", 0.05, std))
        assert "no number of drag at ball that is told from none" in note


@pytest.mark.parametrize(
    ("one", "size"),
    [(finding(), 1.5), (finding(size=0.1), 0.05), (finding("unknown_relation"), 0.05)],
    ids=["it stays", "it had none", "a curve's points are told together"],
)
def test_of_all_others_nothing_is_said(one, size):
    assert told(one, ("size", size, 0.1)) == []


def test_nothing_is_said_where_there_is_no_such_fit():
    assert list(gone_together([finding()], None)) == []
    assert told(finding(), ("mass", 1.0, 0.1)) == []
