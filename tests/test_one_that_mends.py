"""A first law that may only mend what has run away: one law at two places instead."""

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

FITTED = object()


def told(gain, physics="lag"):
    """Return a round that has chosen a law which takes away so much."""
    law = SimpleNamespace(hypothesis=object(), fitted=FITTED)
    chosen = SimpleNamespace(gain=Gain(gain, 0.1, 0.0), candidate=law, physics=physics)
    return Round(None, chosen=chosen)


def asked(monkeypatch, found, pair, *, first=True, away=True, left=0.5):
    """Return what is made of a round, and whether kindred pairs alone were tried."""
    tried = []

    def two_rounds(*_, kindred):
        tried.append(kindred)
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
    made, *_ = or_two(setting, reached, one, {}, None)
    return made, tried


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
