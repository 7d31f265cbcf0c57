"""What remembers is tried over whole recordings, or stretches where these drift."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bondgraph import BondGraph, C, I, R, Recording, Se, Windows, bind_to
from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.search.base.stretches import WINDOWS, long_error, stretch
from bondgraph.diagnosis.search.trials.worth import (
    LOST_FROM_THE_START,
    RUINED,
    fault_of,
)
from bondgraph.fitting.estimate import FitSettings, fit_model

STEP, SAMPLES, WINDOW = 0.01, 2400, 100


def cart(*, held):
    g = BondGraph("cart", domain="translation")
    springs = (C("spring"),) if held else ()
    g.one("cart", Se("force"), I("mass"), R("viscous"), *springs)
    g.measure("position", displacement="cart")
    g.parameter("mass", 2.0, "kg", bounds=(0.1, 50))
    g.parameter("viscous", 1.0, "N*s/m", bounds=(0, 50))
    if held:
        g.parameter("spring", 0.05, "m/N", bounds=(1e-3, 10))
    return g.finish()


def pushed(*, held, wind):
    """Return the fit to a cart that a wind pushes which nobody recorded, and its data.

    Parameters
    ----------
    wind
        Its force, which turns every ten seconds.
    """
    time = np.arange(SAMPLES) * STEP
    force = 3.0 * np.sin(1.7 * time) + 2.0 * np.sin(4.1 * time)
    speed, x, position = 0.0, 0.0, np.zeros(SAMPLES)
    for k, push in enumerate(force + wind * np.sign(np.sin(0.2 * np.pi * time))):
        position[k] = x
        back = x / 0.05 if held else 0.0
        speed += STEP * (push - back - speed) / 2.0
        x += STEP * speed
    noise = 1e-4 * np.random.default_rng(2).standard_normal(SAMPLES)
    channels = {"force": (force, "N"), "position": (position + noise, "m")}
    graph = cart(held=held)
    bound = [bind_to(graph, Recording.from_arrays("run", time, channels))]
    settings = FitSettings(horizon=Windows(WINDOW))
    return fit_model(graph, bound, settings), bound


@pytest.fixture(scope="module")
def free():
    return pushed(held=False, wind=0.5)


def test_a_machine_that_is_held_is_tried_over_whole_recordings():
    fitted, recordings = pushed(held=True, wind=0.0)
    assert stretch(fitted, recordings) is None
    assert long_error(fitted, recordings, None) < 0.02


def test_one_that_is_free_is_tried_over_stretches_of_several_windows(free):
    fitted, recordings = free
    samples = stretch(fitted, recordings)
    assert samples == WINDOWS * WINDOW
    over_stretches = long_error(fitted, recordings, samples)
    assert over_stretches < 0.8 * long_error(fitted, recordings, None)


def test_a_law_that_ruins_stretches_is_lost_and_one_that_does_not_holds(free):
    fitted, recordings = free

    def as_candidate(viscous):
        theta = fitted.optimum.theta.copy()
        theta[fitted.problem.free_names.index("viscous")] = viscous
        changed = replace(fitted, optimum=replace(fitted.optimum, theta=theta))
        return Candidate(SimpleNamespace(physics="drag"), changed, 1)

    samples = stretch(fitted, recordings)
    known = long_error(fitted, recordings, samples)
    near, far = as_candidate(fitted.values["viscous"]), as_candidate(40.0)
    assert long_error(far.fitted, recordings, samples) > RUINED * known
    assert fault_of(fitted, near, recordings, 8) is None
    assert fault_of(fitted, far, recordings, 8) == LOST_FROM_THE_START


def test_a_model_without_states_has_nothing_to_drift_off():
    g = BondGraph("damper", domain="translation")
    g.one("rod", Se("force"), R("viscous"))
    g.measure("speed", flow="rod")
    g.parameter("viscous", 2.0, "N*s/m", bounds=(0.1, 50))
    graph = g.finish()
    force = np.sin(0.1 * np.arange(400))
    channels = {"force": (force, "N"), "speed": (force / 2.0, "m/s")}
    run = Recording.from_arrays("run", STEP * np.arange(400), channels)
    bound = [bind_to(graph, run)]
    assert stretch(fit_model(graph, bound, FitSettings()), bound) is None
