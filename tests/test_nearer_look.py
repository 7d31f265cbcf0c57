"""A nearer look: where no one law explains windows, over shorter ones."""

from types import SimpleNamespace

import numpy as np
import pytest
from carts import free_cart, recorded

from bondgraph.diagnosis.diagnose import Options
from bondgraph.diagnosis.search import looks, nearer_look
from bondgraph.diagnosis.search.nearer_look import first_look
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.search.trials.surrogates import NEAR
from bondgraph.diagnosis.work.limit import Limit
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import WholeRecordings, Windows

SAMPLES = 400
NO_NOISE = np.zeros(1)


@pytest.fixture(scope="module")
def cart_with_friction():
    """Return the cart, recordings of one that rubs, and a fit over windows of it."""
    graph, recordings = free_cart(), [recorded(1, coulomb=1.5)]
    settings = FitSettings(horizon=Windows(SAMPLES))
    return graph, recordings, fit_model(graph, recordings, settings)


def looked(monkeypatch, cart, answers, options=None, seconds=None):
    """Return what a first look ends with, and the fits that were looked at.

    Parameters
    ----------
    answers
        What each look finds in turn: words, and the share that they leave.
    """
    graph, recordings, base = cart
    asked, left = [], iter(answers)

    def look(fitted, *_, another=False):
        word, share = next(left)
        law = SimpleNamespace(physics=word)
        chosen = SimpleNamespace(candidate=SimpleNamespace(hypothesis=law))
        asked.append((int(np.diff(fitted.problem.shots.edges).max()), another))
        rounds = [Round(fitted, chosen=chosen if word else None)]
        named = word not in (None, "unknown_relation")
        return SimpleNamespace(rounds=rounds, is_told=named, share=share)

    monkeypatch.setattr(nearer_look, "look", look)
    monkeypatch.setattr(looks, "remaining", lambda *_: seen_last(asked, answers))
    shop = SimpleNamespace(limit=Limit.after(seconds), progress=lambda _: None)
    chosen = options or Options()
    seen = first_look(graph, base, recordings, NO_NOISE, chosen, shop)
    return seen, asked


def seen_last(asked, answers):
    """Return the share that was left by the look before."""
    return answers[len(asked) - 1][1]


def test_windows_are_divided_where_no_one_law_explains_them(
    monkeypatch, cart_with_friction
):
    answers = [(None, 1.0), ("cogging", 0.01)]
    seen, asked = looked(monkeypatch, cart_with_friction, answers)
    assert asked == [(SAMPLES, True), (SAMPLES // NEAR, False)]
    assert seen.is_told


@pytest.mark.parametrize("nearer", [("cogging", 0.5), ("unknown_relation", 0.0)])
def test_what_a_nearer_look_does_not_explain_is_looked_at_with_pairs(
    monkeypatch, cart_with_friction, nearer
):
    answers = [(None, 1.0), nearer, ("two", 0.0)]
    _, asked = looked(monkeypatch, cart_with_friction, answers)
    assert asked[2:] == [(SAMPLES, False)]


def test_a_law_that_is_found_ends_the_look(monkeypatch, cart_with_friction):
    answers = [("coulomb_friction", 0.9)]
    _, asked = looked(monkeypatch, cart_with_friction, answers)
    assert asked == [(SAMPLES, True)]


def test_where_time_is_over_no_nearer_look_begins(monkeypatch, cart_with_friction):
    _, asked = looked(monkeypatch, cart_with_friction, [(None, 1.0)], seconds=0.0)
    assert asked == [(SAMPLES, True)]


def test_a_window_that_was_asked_for_is_not_divided(monkeypatch, cart_with_friction):
    options = Options(settings=FitSettings(horizon=Windows(SAMPLES)))
    _, asked = looked(monkeypatch, cart_with_friction, [(None, 1.0)], options)
    assert asked == [(SAMPLES, False)]


def test_what_is_within_noise_has_no_nearer_look(monkeypatch, cart_with_friction):
    graph, recordings, base = cart_with_friction
    for name, told in (("explainable", 0.4), ("within", True)):
        with monkeypatch.context() as patched:
            patched.setattr(nearer_look, name, lambda *_, told=told: told)
            _, asked = looked(patched, (graph, recordings, base), [(None, 1.0)] * 2)
        assert {samples for samples, _ in asked} == {SAMPLES}


def test_whole_recordings_are_not_divided(monkeypatch):
    graph, recordings = free_cart(), [recorded(1, coulomb=1.5)]
    base = fit_model(graph, recordings, FitSettings(horizon=WholeRecordings()))
    _, asked = looked(monkeypatch, (graph, recordings, base), [(None, 1.0)])
    assert asked[0][1] is False
