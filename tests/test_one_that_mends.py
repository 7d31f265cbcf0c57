"""A first law that may only mend what has run away: one law at two places instead."""

import time
from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.evidence.gain import Gain
from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.search import making as module
from bondgraph.diagnosis.search.making import or_two
from bondgraph.diagnosis.search.revising.removal import Pruned
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.work.limit import Limit

FITTED = object()


def told(gain, physics="lag"):
    """Return a round that has chosen a law which takes away so much."""
    law = SimpleNamespace(hypothesis=object(), fitted=FITTED)
    chosen = SimpleNamespace(gain=Gain(gain, 0.1, 0.0), candidate=law, physics=physics)
    return Round(None, chosen=chosen)


def asked(monkeypatch, found, pair, *, first=True, away=True, left=0.5):
    """Return what is made of a round, and whether kindred pairs alone were tried."""
    made, tried, _ = timed(monkeypatch, found, pair, first=first, away=away, left=left)
    return made, tried


def timed(monkeypatch, found, pair, *, first=True, away=True, left=0.5):
    """Return the same, and how many of a hundred seconds the pairs had."""
    tried, had = [], []

    def two_rounds(*given, kindred):
        tried.append(kindred)
        had.append(given[-1].limit.end - time.monotonic())
        return pair

    monkeypatch.setattr(module, "two_rounds", two_rounds)
    monkeypatch.setattr(module, "run_away", lambda *_: {"mass": 1.0} if away else {})
    monkeypatch.setattr(module, "left_beside", lambda *_: left)
    monkeypatch.setattr(module, "_left_with", lambda *_: Pruned(FITTED, (), ()))
    setting = SimpleNamespace(
        base=None,
        noise=np.zeros(1),
        is_first=first,
        options=SimpleNamespace(rule=Rule()),
    )
    reached = SimpleNamespace(current=None, added=())
    one = ((found,), FITTED, ())
    shop = SimpleNamespace(limit=Limit.after(100.0))
    made, *_ = or_two(setting, reached, one, {}, shop)
    return made, tried, had


@pytest.mark.parametrize(("by_two", "taken"), [(0.7, True), (0.55, False)])
def test_one_law_at_two_places_is_told_where_it_leaves_less(monkeypatch, by_two, taken):
    found, half = told(0.5), 1.0 - (1.0 - by_two) ** 0.5
    pair = (told(half), told(half))
    made, tried = asked(monkeypatch, found, pair)
    assert tried == [True]
    assert len(made) == (2 if taken else 1)
    assert (made[0] is found) is not taken


@pytest.mark.parametrize(
    "known",
    [{"first": False}, {"away": False}, {"left": 0.2}],
    ids=lambda k: next(iter(k)),
)
def test_no_pair_is_tried_for_a_law_that_stands(monkeypatch, known):
    found = told(0.5)
    made, tried = asked(monkeypatch, found, (told(0.9), told(0.9)), **known)
    assert made == (found,)
    assert not tried


def test_for_a_curve_any_two_laws_are_tried(monkeypatch):
    _, tried = asked(monkeypatch, told(0.5, CURVE), (), first=False)
    assert tried == [False]


@pytest.mark.parametrize(("first", "seconds"), [(True, 100.0), (False, 50.0)])
def test_beside_what_was_found_pairs_leave_half_of_the_time(
    monkeypatch, first, seconds
):
    *_, had = timed(monkeypatch, told(0.5, CURVE), (), first=first)
    assert had == [pytest.approx(seconds, abs=1.0)]
