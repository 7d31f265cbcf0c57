"""What a Kalman filter of a fit works on, and what it finds."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.kalman.kalman_choices import Extended, KalmanFilter
from bondgraph.fitting.kalman.unscented import Beliefs
from bondgraph.fitting.problem import FitProblem
from bondgraph.simulation.shooting import Shots

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Filtered:
    """Innovations, their variances, (n, ny), and the filtered states, (n, nx).

    ``beliefs`` are those of an unscented filter.
    """

    innovations: Array
    variances: Array
    states: Array
    beliefs: Beliefs | None = None

    @property
    def loss(self) -> float:
        """Minus the log-likelihood, without its constant."""
        if not (self.variances > 0.0).all():
            return math.inf
        terms = np.log(self.variances) + self.innovations**2 / self.variances
        total = 0.5 * float(terms.sum())
        return total if math.isfinite(total) else math.inf


@dataclass(frozen=True, slots=True, eq=False)
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


@dataclass(frozen=True, slots=True, eq=False)
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
    kalman
        Which filter.
    """

    problem: FitProblem
    pairs: Shots
    shaken: NDArray[np.int64]
    initial: Array
    spread: Array
    scale: Array
    kalman: KalmanFilter = field(default_factory=Extended)


def starts_of(setting: Setting) -> NDArray[np.int64]:
    """Return 1 at the first sample of each recording, 0 at all others."""
    edges = setting.problem.shots.edges
    starts = np.zeros(edges[-1], dtype=np.int64)
    starts[list(edges[:-1])] = 1
    return starts


def process_of(setting: Setting, at: Unknowns) -> Array:
    """Return the intensity of the process noise of every state, as variances."""
    process = np.zeros(len(setting.scale))
    process[setting.shaken] = np.exp(2.0 * at.process)
    return process
