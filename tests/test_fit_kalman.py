"""Fits by innovations: a shaken machine in closed loop, simulated exactly in numpy."""

import numpy as np
import pytest
import sympy
from scipy.linalg import expm

from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    I,
    R,
    Recording,
    Sdirk3,
    Se,
    Sf,
    WholeRecordings,
    bind_to,
    fit,
    q,
)
from bondgraph.errors import FitError
from bondgraph.fitting.innovations import (
    InnovationStatus,
    fit_innovations,
    ljung_box,
)
from bondgraph.simulation.solvers import Hold

TRUE = {"m": 2.0, "k": 50.0, "b": 1.5}
SHAKEN, NOISE = 1.0, 1e-3
EXACT = FitSettings(hold=Hold.ZERO, solver=Sdirk3(substeps=2))


def servo():
    g = BondGraph("servo", domain="translation")
    k = sympy.Symbol("k")
    g.one("mass", Se("force"), I("m"), R("b"), C("spring", law=k * q))
    g.measure("x", displacement="mass")
    for name, value, unit in (("m", 2.6, "kg"), ("k", 40.0, "N/m"), ("b", 1, "N*s/m")):
        g.parameter(name, value, unit)
    return g.finish()


def moved_exactly(step):
    """Return how one step moves the state, and the Cholesky factor of its shaking.

    The matrices A, B and, after C. Van Loan (IEEE Trans. Autom. Control 23, 1978),
    ∫ exp(Fs) Q exp(Fs)ᵀ ds, of the mass under a held force.
    """
    m, k, b = TRUE.values()
    rates = np.array([[-b / m, -k], [1 / m, 0.0]])
    driven = np.zeros((3, 3))
    driven[:2, :2], driven[0, 2] = rates, 1.0
    moved = expm(driven * step)[:2]
    block = np.zeros((4, 4))
    block[:2, :2], block[0, 2], block[2:, 2:] = -rates, SHAKEN**2, rates.T
    both = expm(block * step)
    return moved, np.linalg.cholesky(both[2:, 2:].T @ both[:2, 2:])


def closed_loop(graph, *, seed, n=800, step=0.02, gain=60.0, size=0.2):
    """A position loop around a mass that a random force shakes, as a recording.

    `size` is the standard deviation of the reference in m, constant for half a second.
    """
    random = np.random.default_rng(seed)
    moved, shaking = moved_exactly(step)
    reference = np.repeat(size * random.normal(size=n // 25 + 1), 25)[:n]
    x, force, position = np.zeros(2), np.zeros(n), np.zeros(n)
    for i in range(n):
        position[i] = x[1] + NOISE * random.normal()
        force[i] = gain * (reference[i] - position[i])
        x = moved @ [*x, force[i]] + shaking @ random.normal(size=2)
    channels = {"force": (force, "N"), "x": (position, "m")}
    time = step * np.arange(n)
    return bind_to(graph, Recording.from_arrays("loop", time, channels))


def test_a_shaken_machine_in_closed_loop_is_recovered_without_bias():
    graph = servo()
    recording = closed_loop(graph, seed=3)
    found = fit_innovations(graph, [recording], settings=EXACT)
    assert found.status is InnovationStatus.CONVERGED
    for name, value in TRUE.items():
        estimate = found.estimate(name)
        assert abs(estimate.value - value) <= 3 * estimate.std, name
        assert estimate.std < 0.15 * value, name
    assert found.process_noise["p_m"] == pytest.approx(SHAKEN, rel=0.15)
    assert found.measurement_noise["x"] == pytest.approx(NOISE, rel=0.15)
    assert found.whiteness["x"] > 0.01
    assert np.var(found.innovations) == pytest.approx(1.0, rel=0.1)
    # What the simulation leaves is coloured by the machine.
    whole = FitSettings(horizon=WholeRecordings(), hold=Hold.ZERO, solver=EXACT.solver)
    residuals = fit(graph, [recording], settings=whole).fitted.residuals()[:, 0]
    assert ljung_box(residuals - residuals.mean()) < 1e-6


def test_whiteness_tells_white_from_coloured():
    random = np.random.default_rng(1)
    white = random.normal(size=2000)
    assert ljung_box(white) > 0.01
    assert ljung_box(white[1:] + 0.2 * white[:-1]) < 1e-6
    assert ljung_box(np.zeros(100)) == 1.0


def test_a_state_that_is_none_is_refused_by_name():
    graph = servo()
    recording = closed_loop(graph, seed=3, n=60)
    with pytest.raises(FitError, match="'p_x' is no state of 'servo'"):
        fit_innovations(graph, [recording], shaken=["p_x"])


def test_a_model_without_states_is_refused():
    g = BondGraph("brake", domain="rotation")
    g.one("axle", Sf("speed"), R("b"))
    g.measure("torque", effort="b")
    g.parameter("b", 1.0, "N*m*s")
    graph = g.finish()
    time = np.arange(20.0)
    channels = {"speed": (np.sin(time), "rad/s"), "torque": (np.sin(time), "N*m")}
    recording = bind_to(graph, Recording.from_arrays("made", time, channels))
    with pytest.raises(FitError, match="has no state to filter"):
        fit_innovations(graph, [recording])
