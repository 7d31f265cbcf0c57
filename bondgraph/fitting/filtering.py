"""What a fit by innovations climbs: all samples filtered at given parameters and noise.

The transitions between samples and their exact slopes come from all samples simulated
at once, each from the state that the filter last estimated there; filter and simulation
take turns until these states stand still (the iterated extended Kalman filter, Bell and
Cathey, IEEE Trans. Autom. Control 38, 1993).
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.growing import cut_finer
from bondgraph.fitting.horizon import SHORTEST
from bondgraph.fitting.levenberg_marquardt import settle
from bondgraph.fitting.multiple_shooting import with_states_read
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.solving import first_guess
from bondgraph.simulation.shooting import Shots, shoot

Array = NDArray[np.float64]
TURNS = 6
STILL = 1e-6


@dataclass(frozen=True, slots=True)
class Filtered:
    """Innovations, their variances, (n, ny), and the filtered states, (n, nx)."""

    innovations: Array
    variances: Array
    states: Array

    @property
    def loss(self) -> float:
        """Minus the log-likelihood, without its constant."""
        if not (self.variances > 0.0).all():
            return math.inf
        terms = np.log(self.variances) + self.innovations**2 / self.variances
        total = 0.5 * float(terms.sum())
        return total if math.isfinite(total) else math.inf


@dataclass(frozen=True, slots=True)
class Unknowns:
    """Parameters, and logarithms of the two kinds of noise."""

    theta: Array
    process: Array
    noise: Array

    def stacked(self) -> Array:
        """Return all numbers in one array."""
        return np.concatenate([self.theta, self.process, self.noise])

    def moved(self, step: Array) -> "Unknowns":
        """Return them after a step."""
        a = len(self.theta)
        b = a + len(self.process)
        return Unknowns(
            self.theta + step[:a], self.process + step[a:b], self.noise + step[b:]
        )


@dataclass(frozen=True, slots=True)
class Setting:
    """What stays the same during the fit.

    Parameters
    ----------
    pairs
        Every sample with the next one, as windows of their own.
    shaken
        Indices of the states that a disturbance moves.
    initial, spread
        Where each recording starts, and its variances.
    scale
        The size of each state, (nx,).
    """

    problem: FitProblem
    pairs: Shots
    shaken: NDArray[np.int64]
    initial: Array
    spread: Array
    scale: Array


def filtered(setting: Setting, at: Unknowns, near: Array | None) -> Filtered:
    """Filter and simulate by turns until the states stand still."""
    states = _first_states(setting) if near is None else near
    for _ in range(TURNS):
        found = _once(setting, at, states)
        if not math.isfinite(found.loss):
            return found
        change = np.abs(found.states - states) / setting.scale
        states = found.states
        if change.max() <= STILL:
            break
    return found


def _first_states(setting: Setting) -> Array:
    """Return the states at every sample of short windows, each settled."""
    shots = cut_finer(setting.problem.shots, SHORTEST)
    short = replace(setting.problem, shots=shots)
    theta = setting.problem.start[setting.problem.free]
    _, at = settle(short, theta, first_guess(short, theta))
    return at.states


def _once(setting: Setting, at: Unknowns, around: Array) -> Filtered:
    """Simulate from the points `around` and filter along these transitions."""
    from bondgraph.fitting.kalman_filter import run_filter  # noqa: PLC0415  (numba)

    problem, pairs = setting.problem, setting.pairs
    shot = shoot(
        with_states_read(problem.model),
        pairs,
        parameters=problem.with_parameters(at.theta),
        initial=around,
        directions=np.zeros(0, np.int64),
        solver=problem.solver,
        hold=problem.hold,
    )
    ny, nx = len(problem.sigma), problem.model.n_states
    first, after = np.array(pairs.edges[:-1]), np.array(pairs.edges[1:]) - 1
    starts = np.zeros(len(first), dtype=np.int64)
    starts[list(problem.shots.edges[:-1])] = 1
    process = np.zeros(nx)
    process[setting.shaken] = np.exp(2.0 * at.process)
    n = len(first)
    innovations, variances = np.zeros((n, ny)), np.ones((n, ny))
    states = np.zeros((n, nx))
    run_filter(
        np.ascontiguousarray(problem.shots.outputs),
        np.ascontiguousarray(shot.outputs[first, :ny]),
        np.ascontiguousarray(shot.sensitivities[first, :ny]),
        np.ascontiguousarray(shot.outputs[after, ny:]),
        np.ascontiguousarray(shot.sensitivities[after, ny:]),
        np.ascontiguousarray(around),
        pairs.time[after] - pairs.time[first],
        starts,
        setting.initial,
        setting.spread,
        process,
        np.exp(2.0 * at.noise),
        innovations,
        variances,
        states,
    )
    return Filtered(innovations, variances, states)
