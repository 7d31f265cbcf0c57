"""Kalman steps over statistically linearised outputs and transitions.

Where points spread like the estimate do not lie on a plane, what is left of them is
covariance of its own. Innovations of several outputs at one sample are told one given
those before it (the Cholesky factor), so that their likelihoods multiply.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """Mean (nx,) and covariance (nx, nx) of the states."""

    mean: Array
    covariance: Array


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """A function near a point: its mean there, its slopes, and the covariance left."""

    around: Array
    mean: Array
    slopes: Array
    left: Array


def taken_in(
    belief: Belief, measured: Array, plane: Plane, noise: Array
) -> tuple[Belief, Array, Array]:
    """Return the belief after a sample, its innovations and their variances.

    Parameters
    ----------
    measured
        (ny,), NaN where nothing was measured: such innovations are 0 of variance 1.
    noise
        Variances of the measurement noise.
    """
    innovations, variances = np.zeros(len(measured)), np.ones(len(measured))
    there = np.flatnonzero(np.isfinite(measured))
    if not len(there):
        return belief, innovations, variances
    rows = plane.slopes[there]
    own = plane.left[np.ix_(there, there)] + np.diag(noise[there])
    error = (measured - plane.mean)[there] - rows @ (belief.mean - plane.around)
    total = rows @ belief.covariance @ rows.T + own
    root = np.linalg.cholesky(total)
    size = np.diag(root)
    innovations[there] = np.linalg.solve(root, error) * size
    variances[there] = size**2
    gain = np.linalg.solve(total, rows @ belief.covariance).T
    keep = np.eye(len(belief.mean)) - gain @ rows
    covariance = keep @ belief.covariance @ keep.T + gain @ own @ gain.T
    return Belief(belief.mean + gain @ error, covariance), innovations, variances


def carried_on(belief: Belief, plane: Plane, step: float, process: Array) -> Belief:
    """Return the belief `step` seconds later.

    Parameters
    ----------
    process
        Intensities of the process noise, variance per second; what they add is taken by
        Simpson's rule.
    """
    a = plane.slopes
    middle = 0.5 * (a + np.eye(len(a)))
    shaken = step / 6.0 * np.diag(process)
    later = a @ (belief.covariance + shaken) @ a.T + shaken + plane.left
    later += 4.0 * (middle @ shaken @ middle.T)
    mean = plane.mean + a @ (belief.mean - plane.around)
    return Belief(mean, 0.5 * (later + later.T))
