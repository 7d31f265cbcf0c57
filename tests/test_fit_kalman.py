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
    Se,
    Sf,
    WholeRecordings,
    bind_to,
    fit,
    q,
)
from bondgraph.errors import FitError
from bondgraph.fitting.certainty.whiteness import ljung_box
from bondgraph.fitting.kalman.innovations import InnovationStatus, fit_innovations
from bondgraph.simulation.solvers import Hold, RungeKutta4

TRUE = {"m": 2.0, "k": 50.0, "b": 1.5}
SEEDS = range(100, 108)
SHAKEN, NOISE = 1.0, 1e-3
EXACT = FitSettings(hold=Hold.ZERO, solver=RungeKutta4())
WHOLE = FitSettings(horizon=WholeRecordings(), hold=Hold.ZERO, solver=RungeKutta4())


def servo():
    g = BondGraph("servo", domain="translation")
    k = sympy.Symbol("k")
    g.one("mass", Se("force"), I("m"), R("b"), C("spring", law=k * q))
    g.measure("x", displacement="mass")
    for name, value, unit in (("m", 2.6, "kg"), ("k", 40.0, "N/m"), ("b", 1, "N*s/m")):
        g.parameter(name, value, unit)
    return g.finish()


def moved_exactly(step, parameters, shaken):
    """Return how one step moves the state, and the covariance that shaking adds.

    The matrices A, B and, after C. Van Loan (IEEE Trans. Autom. Control 23, 1978),
    ∫ exp(Fs) Q exp(Fs)ᵀ ds, of the mass under a held force.
    """
    m, k, b = parameters
    rates = np.array([[-b / m, -k], [1 / m, 0.0]])
    driven = np.zeros((3, 3))
    driven[:2, :2], driven[0, 2] = rates, 1.0
    moved = expm(driven * step)[:2]
    block = np.zeros((4, 4))
    block[:2, :2], block[0, 2], block[2:, 2:] = -rates, shaken**2, rates.T
    both = expm(block * step)
    return moved, both[2:, 2:].T @ both[:2, 2:]


def closed_loop(graph, *, seed, n=800, step=0.02, gain=60.0, size=0.2):
    """A position loop around a mass that a random force shakes, as a recording.

    `size` is the standard deviation of the reference in m, constant for half a second.
    """
    random = np.random.default_rng(seed)
    moved, added = moved_exactly(step, TRUE.values(), SHAKEN)
    shaking = np.linalg.cholesky(added)
    reference = np.repeat(size * random.normal(size=n // 25 + 1), 25)[:n]
    x, force, position = np.zeros(2), np.zeros(n), np.zeros(n)
    for i in range(n):
        position[i] = x[1] + NOISE * random.normal()
        force[i] = gain * (reference[i] - position[i])
        x = moved @ [*x, force[i]] + shaking @ random.normal(size=2)
    channels = {"force": (force, "N"), "x": (position, "m")}
    time = step * np.arange(n)
    return bind_to(graph, Recording.from_arrays("loop", time, channels))


def exact_loss(recording, parameters, shaken, noise, step=0.02):
    """Return minus the log-likelihood by a textbook filter from a wide start."""
    moved, added = moved_exactly(step, parameters, shaken)
    measured, force = recording.outputs[:, 0], recording.inputs[:, 0]
    x, covariance, loss = np.zeros(2), 4.0 * np.eye(2), 0.0
    for y, u in zip(measured, force, strict=True):
        variance, error = covariance[1, 1] + noise**2, y - x[1]
        loss += 0.5 * (np.log(2 * np.pi * variance) + error**2 / variance)
        gain = covariance[:, 1] / variance
        x = moved @ [*(x + gain * error), u]
        covariance = covariance - variance * np.outer(gain, gain)
        covariance = moved[:, :2] @ covariance @ moved[:, :2].T + added
    return loss


def test_noise_and_parameters_of_one_shaken_loop_are_within_their_errors():
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
    residuals = fit(graph, [recording], settings=WHOLE).fitted.residuals()[:, 0]
    assert ljung_box(residuals - residuals.mean()) < 1e-6


def test_the_estimate_is_where_a_textbook_filter_finds_the_likelihood_highest():
    graph = servo()
    recording = closed_loop(graph, seed=3)
    found = fit_innovations(graph, [recording], settings=EXACT)
    at = np.array([found.estimate(name).value for name in TRUE])
    std = np.array([found.estimate(name).std for name in TRUE])
    noise = found.process_noise["p_m"], found.measurement_noise["x"]
    loss = exact_loss(recording, at, *noise)
    step = 0.1 * std
    for i in range(3):
        move = step * (np.arange(3) == i)
        above = exact_loss(recording, at + move, *noise) - loss
        below = exact_loss(recording, at - move, *noise) - loss
        # The parabola through the three is lowest within a fiftieth of a deviation.
        lowest = 0.5 * (below - above) / (below + above) * step[i]
        assert above + below > 0.0
        assert abs(lowest) < 0.02 * std[i]


def test_in_a_shaken_closed_loop_only_the_simulation_error_fit_is_seen_to_be_biased():
    """One rule for both, three standard errors of the mean of eight recordings."""
    graph = servo()
    by_innovations, by_simulation = [], []
    for seed in SEEDS:
        recording = closed_loop(graph, seed=seed, n=1000, size=0.1)
        one = fit_innovations(graph, [recording], settings=EXACT)
        other = fit(graph, [recording], settings=WHOLE)
        by_innovations.append([one.estimate(name).value for name in TRUE])
        by_simulation.append([other.estimate(name).value for name in TRUE])
    true = np.array([*TRUE.values()])

    def bias(found):
        error = np.array(found) - true
        return error.mean(axis=0), error.std(axis=0, ddof=1) / np.sqrt(len(error))

    innovations, its_error = bias(by_innovations)
    simulation, other_error = bias(by_simulation)
    told = f"{innovations} ± {its_error}, {simulation} ± {other_error}"
    assert (np.abs(innovations) <= 3 * its_error).all(), told
    assert simulation[2] > 3 * other_error[2], told


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
