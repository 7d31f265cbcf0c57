"""Coloured or rounded noise on a perfect model is no discovery; structure is."""

from dataclasses import replace

import numpy as np
import pytest
from concealed import multisine
from scipy.signal import lfilter

from bondgraph import BondGraph, C, FitSettings, I, R, Recording, Se, Windows, bind_to
from bondgraph.diagnosis.adequacy.adequacy import adequacy
from bondgraph.diagnosis.adequacy.coloured import Autoregression, coloured, reflections
from bondgraph.diagnosis.adequacy.records import AdequacyStatus
from bondgraph.fitting.estimate import fit_model
from bondgraph.fitting.horizon import WholeRecordings

TIME = np.arange(0.0, 5.0, 0.005)
MASS, VISCOUS, STIFFNESS = 1.3, 2.0, 40.0


def cart(*, sprung):
    graph = BondGraph("cart", domain="translation")
    graph.one("wheel", Se("force"), I("mass"), R("viscous"))
    if sprung:
        graph.put(C("spring"), on="wheel")
        graph.parameter("spring", 1 / 35, "m/N", bounds=(1e-6, 10))
    graph.measure("position", displacement="wheel")
    graph.parameter("mass", 1.05, "kg", bounds=(0.01, 100))
    graph.parameter("viscous", 2.4, "N*s/m", bounds=(0, 100))
    return graph.finish()


def motion(seed, *, sprung, bent=0.0):
    """Return force and position; `bent` is a cubic drag, in N s³/m³.

    Classical Runge-Kutta on a grid fine enough for the solver's own error not to count.
    """
    force = multisine(TIME, seed, 6.0)
    stiffness = STIFFNESS if sprung else 0.0

    def rate(state, drive):
        x, v = state
        return np.array([v, (drive - VISCOUS * v - bent * v**3 - stiffness * x) / MASS])

    state, position = np.zeros(2), np.empty(len(TIME))
    h = TIME[1]
    for k in range(len(TIME)):
        position[k] = state[0]
        if k + 1 < len(TIME):
            u, w = force[k], force[k + 1]
            a = rate(state, u)
            b = rate(state + h / 2 * a, (u + w) / 2)
            c = rate(state + h / 2 * b, (u + w) / 2)
            d = rate(state + h * c, w)
            state = state + h / 6 * (a + 2 * b + 2 * c + d)
    return force, position


def answered(force, position, *, sprung, seed=0, draws=199, level=0.01):
    graph = cart(sprung=sprung)
    channels = {"force": (force, "N"), "position": (position, "m")}
    recording = bind_to(graph, Recording.from_arrays("cart", TIME, channels))
    horizon = WholeRecordings() if sprung else Windows(100)
    fitted = fit_model(graph, [recording], FitSettings(horizon=horizon))
    return adequacy(fitted, [recording], seed=seed, draws=draws, level=level)


@pytest.mark.parametrize("sprung", [True, False])
def test_coloured_noise_on_a_perfect_model_is_no_discovery(sprung):
    p_values = []
    force, position = motion(1, sprung=sprung)
    for seed in range(20):
        random = np.random.default_rng(seed)
        white = random.standard_normal((2, len(TIME)))
        slow = 2e-3 * np.sqrt(1 - 0.95**2) * lfilter([1], [1, -0.95], white[0])
        measured = position + slow + 1e-4 * white[1]
        answer = answered(
            force, measured, sprung=sprung, seed=seed, draws=99, level=0.02
        )
        p_values.append(answer.p_value)
        if answer.p_value > 0.02:
            assert answer.status is AdequacyStatus.COLOURED
            assert "correlates" in " ".join(answer.reasons)
    # Of 20 draws of a uniform p-value, more than 2 below 0.02 have chance 0.007; more
    # than 5 below 0.1 have chance 0.01.
    assert np.sum(np.array(p_values) <= 0.02) <= 2
    assert np.sum(np.array(p_values) <= 0.1) <= 5


def test_white_noise_is_adequate_and_a_bent_law_is_not():
    noise = 2e-4 * np.random.default_rng(5).standard_normal(len(TIME))
    force, position = motion(1, sprung=False)
    fine = answered(force, position + noise, sprung=False)
    assert fine.status is AdequacyStatus.ADEQUATE
    assert fine.output("position").ratio == pytest.approx(1.0, abs=0.1)
    force, position = motion(1, sprung=False, bent=0.5)
    bent = answered(force, position + noise, sprung=False)
    assert bent.status is AdequacyStatus.STRUCTURE
    assert bent.deciding.variable in ("flow(wheel)", "flow(force)")
    assert bent.deciding.share > 0.8
    assert bent.p_value <= 0.01


def test_a_coarse_encoder_on_a_perfect_model_is_no_discovery():
    p_values = []
    force, position = motion(2, sprung=False)
    for seed in range(6):
        step = 2e-3 * (1 + 0.1 * seed)
        read = np.rint(position / step) * step
        answer = answered(force, read, sprung=False, seed=seed, draws=99)
        assert answer.output("position").quantisation == pytest.approx(step, rel=1e-3)
        p_values.append(answer.p_value)
    assert min(p_values) > 0.01


def test_a_fit_that_stopped_early_is_told_from_structure():
    force, position = motion(1, sprung=True)
    noise = 2e-4 * np.random.default_rng(6).standard_normal(len(TIME))
    graph = cart(sprung=True)
    channels = {"force": (force, "N"), "position": (position + noise, "m")}
    recording = bind_to(graph, Recording.from_arrays("cart", TIME, channels))
    done = fit_model(graph, [recording], FitSettings(horizon=WholeRecordings()))
    optimum = replace(done.optimum, theta=1.02 * done.optimum.theta, converged=False)
    early = replace(done, optimum=optimum)
    answer = adequacy(early, [recording], draws=99)
    assert answer.status is AdequacyStatus.NOT_CONVERGED
    assert answer.unconverged > 0.5


def test_reflections_of_an_autoregression_are_found_again():
    model = Autoregression(np.array([0.9, -0.3]), np.zeros(2))
    draw = coloured(model, np.random.default_rng(0).standard_normal((200_000, 1)))
    lags = [draw[k:, 0] @ draw[: len(draw) - k, 0] for k in range(4)]
    found, variance = reflections(np.array(lags) / lags[0])
    np.testing.assert_allclose(found, [0.9, -0.3, 0.0], atol=0.01)
    assert variance[-1] == pytest.approx((1 - 0.81) * (1 - 0.09), rel=0.05)
