"""A Kalman filter over linearised transitions, compiled.

Outputs are taken one after another with scalar updates in Joseph's form, so the
covariance stays symmetric and positive, and an output that was not measured is passed
over. What a disturbance adds between two samples, ∫ Φ Q Φᵀ, is taken by Simpson's
rule, exact for one that is integrated twice. Products are written out: those of numpy
take longer to compile than all else here.
"""

import math

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, compiled, lean


@lean
def _update(
    x: Array, covariance: Array, row: Array, error: float, noise: float, work: Array
) -> float:
    """Take in one scalar measurement in place; return the innovation's variance."""
    nx = len(x)
    gain, variance = work[0], noise
    for i in range(nx):
        gain[i] = 0.0
        for j in range(nx):
            gain[i] += covariance[i, j] * row[j]
        variance += row[i] * gain[i]
    for i in range(nx):
        gain[i] /= variance
        x[i] += gain[i] * error
    keep = work[1 : nx + 1]
    for i in range(nx):
        for j in range(nx):
            keep[i, j] = (1.0 if i == j else 0.0) - gain[i] * row[j]
    _carry(keep, covariance, work[nx + 1 :])
    for i in range(nx):
        for j in range(nx):
            covariance[i, j] += noise * gain[i] * gain[j]
    return variance


@lean
def _carry(a: Array, covariance: Array, work: Array) -> None:
    """Replace P by A P Aᵀ."""
    nx = len(covariance)
    for i in range(nx):
        for j in range(nx):
            work[i, j] = 0.0
            for k in range(nx):
                work[i, j] += a[i, k] * covariance[k, j]
    for i in range(nx):
        for j in range(nx):
            covariance[i, j] = 0.0
            for k in range(nx):
                covariance[i, j] += work[i, k] * a[j, k]


@lean
def _advance(
    covariance: Array, a: Array, process: Array, step: float, work: Array
) -> None:
    """Carry the covariance over one step, and add what the disturbance does in it."""
    nx = len(covariance)
    sixth = step / 6.0
    for i in range(nx):
        covariance[i, i] += sixth * process[i]
    _carry(a, covariance, work)
    for i in range(nx):
        covariance[i, i] += sixth * process[i]
        for j in range(nx):
            for k in range(nx):
                half_i = 0.5 * (a[i, k] + (1.0 if i == k else 0.0))
                half_j = 0.5 * (a[j, k] + (1.0 if j == k else 0.0))
                covariance[i, j] += 4.0 * sixth * half_i * process[k] * half_j
    for i in range(nx):
        for j in range(i):
            both = 0.5 * (covariance[i, j] + covariance[j, i])
            covariance[i, j] = covariance[j, i] = both


@lean
def _begin(x: Array, covariance: Array, initial: Array, spread: Array) -> None:
    """Write what is known at the beginning of a window."""
    for i in range(len(x)):
        x[i] = initial[i]
        for j in range(len(x)):
            covariance[i, j] = spread[i] if i == j else 0.0


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
        State there, one row per window, and its variances, (nx,).
    process, noise
        Intensities of the process noise (variance per second) and variances of the
        measurement noise.
    """
    n, ny, nx = measured.shape[0], measured.shape[1], around.shape[1]
    x, ahead, window = np.zeros(nx), np.zeros(nx), -1
    covariance, work = np.zeros((nx, nx)), np.zeros((2 * nx + 1, nx))
    for k in range(n):
        if starts[k] == 1:
            window += 1
            _begin(x, covariance, initial[window], spread)
        for j in range(ny):
            innovations[k, j], variances[k, j] = 0.0, 1.0
            if math.isfinite(measured[k, j]):
                error = measured[k, j] - read[k, j]
                for i in range(nx):
                    error -= slopes[k, j, i] * (x[i] - around[k, i])
                variances[k, j] = _update(
                    x, covariance, slopes[k, j], error, noise[j], work
                )
                innovations[k, j] = error
        for i in range(nx):
            states[k, i] = x[i]
            ahead[i] = moved[k, i]
            for j in range(nx):
                ahead[i] += transitions[k, i, j] * (x[j] - around[k, j])
        x[:] = ahead
        _advance(covariance, transitions[k], process, steps[k], work)
