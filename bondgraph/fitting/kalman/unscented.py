"""One turn of the unscented filter: points simulated all at once, then filtered.

A filter spreads points around what it believes at each sample, so it must go sample by
sample. Here the beliefs of the last turn say where the points lie; they are simulated
together, regressed (statistical linearisation), and filtered, and the turns go on until
the beliefs stand still. Where they do, transitions are regressed around the very
estimates that the filter has before each step, and outputs around its predictions:
that is the unscented filter, in a few simulations instead of one per sample.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.kalman.kalman_choices import Unscented
from bondgraph.fitting.problem import FitProblem
from bondgraph.numeric.states_read import with_states_read
from bondgraph.simulation.shooting import Shots, shoot

Array = NDArray[np.float64]
FLAT = 1e-9  # of a state's size, the least spread of points


@dataclass(frozen=True, slots=True, eq=False)
class Beliefs:
    """Means and covariances, (n, nx) and (n, nx, nx), before and after each sample."""

    predicted: Array
    before: Array
    states: Array
    after: Array


@dataclass(frozen=True, slots=True, eq=False)
class Regression:
    """A function of points as a plane: means, slopes and the covariance left."""

    mean: Array
    slopes: Array
    left: Array


def points(mean: Array, covariance: Array, scale: Array, rule: Unscented) -> Array:
    """Return points spread like a belief, ``[sample, point, state]``."""
    units = _units(len(scale), rule)
    spread: Array = np.einsum("pi,nji->npj", units, _root(covariance, scale))
    return mean[:, None, :] + spread


def regressed(
    values: Array, covariance: Array, scale: Array, rule: Unscented
) -> Regression:
    """Return the regression of ``[sample, point, value]`` on the states."""
    nx = len(scale)
    units, weights = _units(nx, rule), _weights(nx, rule)
    mean = np.einsum("p,npj->nj", weights, values)
    off = values - mean[:, None, :]
    along = np.einsum("p,npj,pi->nji", weights, off, units)
    left = np.einsum("p,npj,npk->njk", weights, off, off)
    left -= along @ along.transpose(0, 2, 1)
    root = _root(covariance, scale)
    slopes = np.linalg.solve(root.transpose(0, 2, 1), along.transpose(0, 2, 1))
    return Regression(mean, slopes.transpose(0, 2, 1), left)


def _units(nx: int, rule: Unscented) -> Array:
    reach = np.sqrt(nx + rule.centre) * np.eye(nx)
    return np.concatenate([np.zeros((1, nx)), reach, -reach])


def _weights(nx: int, rule: Unscented) -> Array:
    total = nx + rule.centre
    return np.array([rule.centre / total, *(2 * nx * [0.5 / total])])


def _root(covariance: Array, scale: Array) -> Array:
    least = np.diag((FLAT * scale) ** 2)
    return np.linalg.cholesky(covariance + least).astype(np.float64)


def simulated(
    problem: FitProblem, theta: Array, shots: Shots, spread: Array, *, last: bool
) -> Array:
    """Return outputs (or states, at the `last` sample) of points in each window.

    Parameters
    ----------
    spread
        Initial states, ``[window, point, state]``.
    """
    count, each, nx = spread.shape
    lengths = shots.lengths
    rows = np.repeat(np.arange(count), each)
    starts = shots.edge_array[:-1][rows]
    sizes = lengths[rows] if last else np.ones(len(rows), np.int64)
    edges = np.concatenate([[0], np.cumsum(sizes)])
    index = np.repeat(starts - edges[:-1], sizes) + np.arange(edges[-1])
    many = Shots(
        shots.time[index],
        shots.inputs[index],
        np.zeros((len(index), 0)),
        tuple(edges.tolist()),
    )
    shot = shoot(
        with_states_read(problem.model),
        many,
        parameters=problem.with_parameters(theta),
        initial=spread.reshape(-1, nx),
        directions=None,
        solver=problem.solver,
        hold=problem.hold,
    )
    ny = len(problem.sigma)
    found = shot.outputs[edges[1:] - 1]
    values: Array = found[:, ny:] if last else found[:, :ny]
    return values.reshape(count, each, -1)
