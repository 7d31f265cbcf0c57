"""What a search has found stays: over its windows, and where quarters are left out."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import sympy
from carts import free_cart, recorded

from bondgraph import BondGraph, I, R, Se, f
from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.evidence.numbers import none_told
from bondgraph.diagnosis.search.base import horizons
from bondgraph.diagnosis.search.base.short_runs import (
    keeps_what_windows_show,
    left_of_windows,
)
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.trials import worth
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import Windows

WINDOWED = FitSettings(horizon=Windows(100))


def rubbing_cart():
    """The cart with the dry friction that is hidden in its recordings."""
    graph = BondGraph("cart", domain="translation")
    dry = sympy.Symbol("dry") * sympy.tanh(f / 0.01)
    graph.one("wheel", Se("force"), I("mass"), R("viscous"), R("rubbing", law=dry))
    graph.measure("position", displacement="wheel")
    graph.parameter("mass", 1.05, "kg", bounds=(0.01, 100))
    graph.parameter("viscous", 2.4, "N*s/m", bounds=(0, 100))
    graph.parameter("dry", 0.1, "N", bounds=(0, 10))
    return graph.finish()


@pytest.fixture(scope="module")
def cart():
    """Return recordings, the base model and the right one, both fitted to windows."""
    recordings = [recorded(3, coulomb=1.0)]
    fits = [fit_model(g, recordings, WINDOWED) for g in (free_cart(), rubbing_cart())]
    return recordings, *fits


def let_go(fitted):
    """Return a model that has lost its friction, and otherwise is as it was."""
    problem, optimum = fitted.problem, fitted.optimum
    names = problem.free_names
    theta = np.where(np.array(names) == "dry", 0.0, optimum.theta)
    return replace(fitted, optimum=replace(optimum, theta=theta))


def test_what_a_fit_has_let_go_of_is_missed_in_windows(cart):
    _, base, right = cart
    assert left_of_windows(right, base) < 0.05 * base.optimum.cost
    assert keeps_what_windows_show(right, right, base)
    assert not keeps_what_windows_show(let_go(right), right, base)


def test_where_windows_show_little_nothing_is_lost(cart):
    _, base, right = cart
    assert keeps_what_windows_show(base, let_go(right), base)


def test_a_last_fit_that_lets_go_of_what_was_found_is_not_handed_on(cart, monkeypatch):
    recordings, base, right = cart
    monkeypatch.setattr(horizons, "fit_model", lambda *_: let_go(right))
    monkeypatch.setattr(horizons, "SAME", np.inf)
    assert horizons.sharpened(right, recordings, Options(), base) is right


@pytest.mark.parametrize(
    ("left", "fault"),
    [
        ((5.0, 5.0, 5.0, 5.0), None),
        ((5.0, 5.0, 5.0, 50.0), None),
        ((15.0, 15.0, 5.0, 5.0), None),
        ((15.0, 20.0, 5.0, 5.0), "left out in one"),
    ],
)
def test_what_makes_quarters_worse_that_are_left_out_is_not_the_one(
    cart, monkeypatch, left, fault
):
    recordings, base, right = cart

    def errors(fitted, chunks, *, in_one):
        assert in_one
        return LeftOutErrors(np.repeat((10.0,) * 4 if fitted is base else left, 2))

    monkeypatch.setattr(worth, "left_out_errors", errors)
    candidate = Candidate(SimpleNamespace(physics="drag"), right, 1)
    said = worth.fault_of(base, candidate, recordings, 8)
    assert said is None if fault is None else fault in said


def test_a_scale_of_one_is_no_number():
    assert none_told([("sensor_scale_level", 1.0001, 0.0005)])
    assert not none_told([("sensor_scale_level", 1.01, 0.0005)])
    assert not none_told([("leak_level", 1.0001, 0.0005)])


def test_how_fast_a_swing_of_no_mass_is_is_no_number():
    frequency = ("mode_frequency_arm", 8.16, 0.17)
    assert none_told([("mode_inertia_arm", 0.0011, 0.0025), frequency])
    assert not none_told([("mode_inertia_arm", 0.0011, 0.0002), frequency])
    assert not none_told([frequency])
