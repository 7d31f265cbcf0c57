"""Initial states are settled window by window, and what is settled is left alone."""

from dataclasses import replace

import numpy as np
import pytest

from bondgraph import BondGraph, I, R, Recording, Se, bind_to, f
from bondgraph.fitting import settling
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import Windows
from bondgraph.fitting.settling import settle

SAMPLES, WINDOW = 400, 40


def problem():
    """Return that of a cart with square drag, pushed to and fro."""
    g = BondGraph("cart", domain="translation")
    drag = R("drag", law=3.0 * f * (1.0 + f**2))
    g.one("wheels", Se("force"), I("mass"), drag)
    g.measure("speed", flow="wheels")
    g.parameter("mass", 2.0, "kg", std=0.0)
    time = 0.01 * np.arange(SAMPLES)
    force = 8.0 * np.sin(4.0 * time)
    speed = np.sin(4.0 * time - 0.8) + 0.01 * np.sin(90.0 * time)
    channels = {"force": (force, "N"), "speed": (speed, "m/s")}
    finished = g.finish()
    recording = bind_to(finished, Recording.from_arrays("pushed", time, channels))
    return fit_model(
        finished, [recording], FitSettings(horizon=Windows(WINDOW))
    ).problem


@pytest.fixture(scope="module")
def posed():
    return problem()


@pytest.fixture
def begun(posed):
    """Return initial states, far off in one window and near in the others."""
    states = np.zeros((posed.shots.n_windows, posed.model.n_states))
    near, _ = settle(posed, posed.start[posed.free], states)
    near[3] += 40.0
    return near


def test_each_window_is_settled_as_if_it_were_alone(posed, begun):
    theta = posed.start[posed.free]
    states, at = settle(posed, theta, begun)
    for window in range(posed.shots.n_windows):
        alone = replace(posed, shots=posed.shots.subset(np.array([window])))
        own, there = settle(alone, theta, begun[window : window + 1])
        rows = posed.shots.slices[window]
        assert own[0] == pytest.approx(states[window], rel=1e-6)
        assert there.cost[0] == pytest.approx(at.cost[window], rel=1e-6)
        assert there.residuals == pytest.approx(at.residuals[rows], rel=1e-6)


def test_what_was_given_is_not_written_over(posed, begun):
    given = begun.copy()
    settle(posed, posed.start[posed.free], begun)
    assert (begun == given).all()


def test_a_window_that_is_settled_is_not_simulated_again(posed, begun, monkeypatch):
    simulated = []
    own = settling.linearise_windows

    def counted(problem, theta, initial):
        simulated.append(problem.shots.n_windows)
        return own(problem, theta, initial)

    monkeypatch.setattr(settling, "linearise_windows", counted)
    settle(posed, posed.start[posed.free], begun)
    assert simulated[0] == posed.shots.n_windows
    assert set(simulated[1:]) == {1}
    assert len(simulated) > 3
