"""Stretches that begin in motion are not taken for stretches that begin stuck."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from bondgraph import BondGraph, I, R, Recording, Se, bind_to
from bondgraph.fitting import long_runs
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import Windows
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.structure.signals import f

MASS, DRY, DAMPING, STEP = 2.0, 3.0, 4.0, 0.01
WIDTHS = (0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4)
NOISE = 1e-4


def cart():
    """Return a cart with dry friction that is widened to be smooth."""
    coulomb, width = sympy.symbols("coulomb width")
    g = BondGraph("cart", domain="translation")
    dry = R("dry", law=coulomb * sympy.tanh(f / width))
    g.one("wheels", Se("force"), I("mass"), R("damping"), dry)
    g.measure("position", displacement="wheels")
    g.parameter("mass", MASS, "kg", bounds=(0.1, 10))
    g.parameter("damping", DAMPING, "N*s/m", bounds=(0, 100))
    g.parameter("coulomb", DRY, "N", bounds=(0, 100))
    g.parameter("width", WIDTHS[0], "m/s", std=0.0)
    return g.finish()


def pushed():
    """Return a recording of it, by small steps: it moves when most stretches begin."""
    time = np.arange(1600) * STEP
    force = 9.0 * np.sin(1.1 * time) + 4.0 * np.sin(2.9 * time + 1.0)
    position, speed, where = np.zeros(time.size), 0.0, 0.0
    for k in range(time.size):
        position[k] = where
        for fine in np.linspace(time[k], time[k] + STEP, 100, endpoint=False):
            push = np.interp(fine, time, force) - DAMPING * speed
            dry = np.clip(push + MASS * speed / (STEP / 100), -DRY, DRY)
            speed += (push - dry) / MASS * STEP / 100
            where += speed * STEP / 100
    position += NOISE * np.random.default_rng(5).standard_normal(time.size)
    channels = {"force": (force, "N"), "position": (position, "m")}
    return bind_to(cart(), Recording.from_arrays("pushed", time, channels))


@pytest.fixture(scope="module")
def fitted():
    """Return the cart's fit with friction as sharp as a search makes it, in turn."""
    recording = pushed()
    fit = fit_model(cart(), [recording], FitSettings(horizon=Windows(50)))
    at = fit.problem.model.parameter_names.index("width")
    for width in WIDTHS[1:]:
        start = fit.parameters
        start[at] = width
        problem = replace(fit.problem, start=start)
        known = fit.optimum
        optimum = minimise(problem, known.theta, known.initial)
        fit = replace(fit, problem=problem, optimum=optimum)
    return fit, recording


def error(model, recording):
    """Return the root mean square error over stretches of eight windows."""
    simulated = long_runs.simulate_stretches(model, [recording], 400)
    return np.sqrt(np.mean((simulated.measured - simulated.outputs) ** 2))


def test_a_stretch_begins_in_the_motion_that_the_fit_knows(fitted):
    assert error(*fitted) < 5 * NOISE


def test_from_rest_alone_it_would_be_lost(fitted, monkeypatch):
    monkeypatch.setattr(long_runs, "FAR", np.inf)
    assert error(*fitted) > 50 * NOISE
