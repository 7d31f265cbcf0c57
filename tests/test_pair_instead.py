"""Two laws in place of a row of laws that still leave what is no noise."""

from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph.diagnosis.diagnose import Options
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.search.revising import pair_instead as module
from bondgraph.diagnosis.search.revising.pair_instead import pair_instead
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.work.limit import Limit


def told(left):
    """Return a round that has chosen a law with which so much is left."""
    errors = LeftOutErrors(np.full(4, left / 4.0), samples=1)
    law = SimpleNamespace(hypothesis=object())
    return Round(None, chosen=SimpleNamespace(errors=errors, candidate=law))


def asked(monkeypatch, chain, pair, *, seconds=None, noisy=False, left=0.2):
    """Return what takes the place of a chain, and whether pairs were tried."""
    tried = []

    def two_rounds(*_):
        tried.append(True)
        return pair

    monkeypatch.setattr(module, "two_rounds", two_rounds)
    monkeypatch.setattr(module, "explainable", lambda *_: 0.1 if noisy else 0.9)
    monkeypatch.setattr(module, "left_beside", lambda *_: left)
    shop = SimpleNamespace(limit=Limit.after(seconds), progress=lambda _: None)
    rounds = [*map(told, chain), Round(None)]
    return pair_instead(rounds, [], np.zeros(1), Options(), shop), bool(tried)


@pytest.mark.parametrize(
    ("chain", "left_by_two", "taken"),
    [
        ((0.6, 0.4, 0.3), 0.2, True),
        ((0.6, 0.4, 0.3), 0.35, False),
        ((0.6, 0.4, 0.3), 0.28, False),
    ],
)
def test_two_laws_that_leave_less_take_the_place_of_those_found(
    monkeypatch, chain, left_by_two, taken
):
    pair = (told(0.5), told(left_by_two))
    instead, tried = asked(monkeypatch, chain, pair)
    assert tried
    assert instead == (list(pair) if taken else None)


@pytest.mark.parametrize(
    ("chain", "known"),
    [
        ((0.6, 0.3), {}),
        ((0.6, 0.4, 0.3), {"noisy": True}),
        ((0.6, 0.4, 0.3), {"left": 0.005}),
        ((0.6, 0.4, 0.3), {"seconds": 0.0}),
    ],
)
def test_no_pair_is_tried_where_little_is_left_or_no_time(monkeypatch, chain, known):
    instead, tried = asked(monkeypatch, chain, (told(0.5), told(0.1)), **known)
    assert instead is None
    assert not tried


def test_where_no_pair_is_supported_the_row_stays(monkeypatch):
    instead, tried = asked(monkeypatch, (0.6, 0.4, 0.3), ())
    assert instead is None
    assert tried
