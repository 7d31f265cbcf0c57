"""A Kalman filter over linearised transitions, compiled.

Outputs are taken one after another with scalar updates in Joseph's form, so the
covariance stays symmetric and positive, and an output that was not measured is passed
over. What a disturbance adds between two samples, ∫ Φ Q Φᵀ, is taken by Simpson's
rule, exact for one that is integrated twice.
"""

import math

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, compiled


@compiled
def _update(
    x: Array, covariance: Array, row: Array, error: float, noise: float
) -> float:
    """Take in one scalar measurement in place; return the innovation's variance."""
    nx = len(x)
    seen = covariance @ row
    variance = noise + np.dot(row, seen)
    gain = seen / variance
    for i in range(nx):
        x[i] += gain[i] * error
    keep = np.eye(nx) - np.outer(gain, row)
    covariance[:, :] = keep @ covariance @ keep.T + noise * np.outer(gain, gain)
    return float(variance)


@compiled
def run_filter(
    measured: Array, read: Array, slopes: Array, moved: Array, transitions: Array,
    around: Array, steps: Array, starts: Integers, initial: Array, spread: Array,
    process: Array, noise: Array, innovations: Array, variances: Array, states: Array,
) -> None:  # fmt: skip
    """Filter all windows; write innovations, their variances and filtered states.

    Parameters
    ----------
    measured
        (n, ny), NaN where nothing was measured.
    read, slopes
        Outputs at the points `around`, (n, ny), and their slopes, (n, ny, nx).
    moved, transitions
        States one sample later, from `around`, (n, nx), and their slopes (n, nx, nx).
    steps
        Seconds to the next sample, (n,).
    starts
        1 at the first sample of a window.
    initial, spread
        State and variances (nx,) there, one row per window.
    process, noise
        Intensities of the process noise (variance per second) and variances of the
        measurement noise.
    """
    n, ny, nx = measured.shape[0], measured.shape[1], around.shape[1]
    x, covariance, window = np.zeros(nx), np.zeros((nx, nx)), -1
    for k in range(n):
        if starts[k] == 1:
            window += 1
            x[:] = initial[window]
            covariance[:, :] = np.diag(spread)
        for j in range(ny):
            innovations[k, j], variances[k, j] = 0.0, 1.0
            if math.isfinite(measured[k, j]):
                row = slopes[k, j].copy()
                error = measured[k, j] - read[k, j] - row @ (x - around[k])
                variances[k, j] = _update(x, covariance, row, error, noise[j])
                innovations[k, j] = error
        states[k] = x
        a = transitions[k].copy()
        x = moved[k] + a @ (x - around[k])
        middle = 0.5 * (a + np.eye(nx))
        shaken = steps[k] / 6.0 * np.diag(process)
        covariance = a @ (covariance + shaken) @ a.T + shaken
        covariance += 4.0 * (middle @ shaken @ middle.T)
        covariance = 0.5 * (covariance + covariance.T)
