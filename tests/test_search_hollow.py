"""A finding that ends as nothing is taken out, if another suffices without it."""

from types import SimpleNamespace

import numpy as np
import pytest
from rubbing_slider import proposed, slider

from bondgraph import Recording, bind_to
from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising import hollow
from bondgraph.diagnosis.search.revising.hollow import ends_as_nothing, without_hollow
from bondgraph.diagnosis.search.revising.removal import fitted_with
from bondgraph.diagnosis.search.round_found import Round, accepted
from bondgraph.diagnosis.work.limit import Limit
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.drag import QuadraticDrag
from bondgraph.physics.friction import CoulombFriction

DRAG = 3.0


def searched(friction):
    """Return the rounds of a search that found dry friction and then drag."""
    graph = slider()
    time = np.arange(1500) * 0.01
    speed = 0.5 * np.sin(1.3 * time) * np.sin(0.2 * time + 1)
    noise = 0.01 * np.random.default_rng(3).standard_normal(time.size)
    rubs = friction * np.tanh(speed / 0.002)
    force = 1.5 * speed + DRAG * speed * np.abs(speed) + rubs + noise
    channels = {"speed": (speed, "m/s"), "force": (force, "N")}
    run = bind_to(graph, Recording.from_arrays("run", time, channels))
    base = fit_model(graph, [run], FitSettings())
    rub = proposed(base, CoulombFriction())
    rubbing = fitted_with(base, base, [rub], rub.starts[0])
    drag = proposed(rubbing, QuadraticDrag())
    start = {**rub.starts[0], **drag.starts[-1]}
    final = fitted_with(base, rubbing, [rub, drag], start)
    rounds = [
        Round(before, chosen=SimpleNamespace(candidate=Candidate(law, after, 1)))
        for before, law, after in ((base, rub, rubbing), (rubbing, drag, final))
    ]
    return [*rounds, Round(final)], final, [run], rub, drag


def candidates(rounds):
    """Return what the rounds have chosen."""
    return [one.chosen.candidate for one in rounds if one.chosen is not None]


def test_a_law_that_came_first_and_ends_as_nothing_is_taken_out():
    rounds, final, runs, rub, drag = searched(0.0)
    first, second = candidates(rounds)
    assert ends_as_nothing(final, first)
    assert not ends_as_nothing(final, second)
    left, without = without_hollow(rounds, final, runs, Options(), Limit())
    assert [one.chosen.candidate.hypothesis for one in accepted(left)] == [drag]
    assert left[-1].removed == (rub,)
    assert not set(rub.parameters) & set(without.values)
    (size,) = drag.strengths
    assert without.values[size] == pytest.approx(DRAG, rel=0.02)


def test_laws_that_are_there_stay():
    rounds, final, runs, _, _ = searched(0.4)
    assert not ends_as_nothing(final, candidates(rounds)[0])
    left, same = without_hollow(rounds, final, runs, Options(), Limit())
    assert left == rounds
    assert same is final


def test_the_only_finding_stays_and_is_told_as_it_is():
    rounds, final, runs, _, _ = searched(0.0)
    alone = [rounds[0], Round(final)]
    assert ends_as_nothing(final, candidates(alone)[0])
    assert without_hollow(alone, final, runs, Options(), Limit())[0] == alone


@pytest.mark.parametrize(("size", "nothing"), [(1e-16, True), (0.03, False)])
def test_a_law_without_strength_is_nothing_whatever_form_it_keeps(
    monkeypatch, size, nothing
):
    # Hysteresis without a force, and a share of it that would be told well.
    law = SimpleNamespace(
        parameters=("size", "share"),
        strengths=("size",),
        silent_starts=(),
        physics="",
        place="",
    )
    found = SimpleNamespace(
        hypothesis=law, fitted=SimpleNamespace(values={"size": 0.05, "share": 0.6})
    )
    final = SimpleNamespace(
        problem=SimpleNamespace(free_names=("size", "share")),
        optimum=SimpleNamespace(theta=np.array([size, 0.5])),
        values={"size": size, "share": 0.5},
    )
    std = SimpleNamespace(std=np.array([4e-12, 0.09]))
    monkeypatch.setattr(hollow, "uncertainty", lambda *_: std)
    assert ends_as_nothing(final, found) is nothing
