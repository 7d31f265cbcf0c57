"""A law that was fitted into a valley of its own is judged by a fit from anew."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from judged_candidates import BASE, RULE, judged

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.search.revising import fitted_anew as module
from bondgraph.diagnosis.search.revising.fitted_anew import fitted_anew
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.fitting.settings import FitSettings
from bondgraph.simulation.solvers import Hold, RungeKutta4


def fit(left):
    """Return a fit that leaves so much of one output, and noise of another."""
    residuals = np.column_stack([np.full(50, left), np.ones(50)])
    problem = SimpleNamespace(solver=RungeKutta4(), hold=Hold.ZERO)
    return SimpleNamespace(
        residuals=lambda: residuals,
        left=left,
        horizon=WholeRecordings(),
        problem=problem,
    )


@pytest.fixture
def after(monkeypatch):
    """Return a function that says what a round leaves once it was fitted anew."""

    def after(left, *, much=0.5, rounds=1):
        anew, rough = fit(left), judged(0.7)
        known = Candidate(rough.candidate.hypothesis, fit(0.4), 1)
        chosen = replace(rough, candidate=known)
        settings = SimpleNamespace(rule=RULE, settings=FitSettings())
        setting = SimpleNamespace(options=settings, base=None, noise=0, recordings=())
        monkeypatch.setattr(module, "left_beside", lambda *_: much)
        monkeypatch.setattr(module, "sharpened", lambda *_: anew)
        monkeypatch.setattr(module, "refitted", lambda *_: anew)
        monkeypatch.setattr(module, "restored", lambda *_: anew)
        monkeypatch.setattr(module, "Start", SimpleNamespace(where_ended=lambda _: 0))
        monkeypatch.setattr(module, "left_out_errors", errors)
        monkeypatch.setattr(module, "probability", lambda *_: 0.8)
        made = [Round(None, judged=(chosen,), chosen=chosen)] * rounds
        told, model = fitted_anew(made, chosen.candidate.fitted, setting)
        return told[-1].chosen.gain.value, model.left

    def errors(fitted, chunks):
        return BASE if fitted is None else LeftOutErrors(BASE.chunks * fitted.left)

    return after


def test_what_is_far_better_anew_is_told_as_it_is_there(after):
    gain, left = after(0.01)
    assert gain == pytest.approx(0.99)
    assert left == 0.01


def test_a_valley_hardly_deeper_or_little_left_or_two_laws_change_nothing(after):
    for unchanged in (after(0.35), after(0.01, much=0.01), after(0.01, rounds=2)):
        assert unchanged == (pytest.approx(0.3, abs=0.02), 0.4)
