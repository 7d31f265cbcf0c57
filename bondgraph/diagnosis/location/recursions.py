"""Recursions along a chain of linear steps, compiled. Loads numba: import it late.

Arrays follow `bondgraph.diagnosis.virtual.chain`: row k of ``phi``, ``gamma`` and
``jump`` belongs to the step that leads to sample k, over which a source keeps the value
it had at sample k - 1.
"""

import math

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, compiled


@compiled
def respond(  # noqa: C901
    phi: Array, read: Array, linked: Integers, forcing: Array, direct: Array, out: Array
) -> None:
    """Write the outputs' response to `forcing` of the states and `direct` of outputs.

    ``forcing`` is (n, nx, m), ``direct`` and ``out`` (n, ny, m). Where ``linked[k]`` is
    0 the states start from ``forcing[k]``.
    """
    n, nx, m = forcing.shape
    ny = read.shape[1]
    state, new = np.zeros((nx, m)), np.zeros((nx, m))
    for k in range(n):
        for i in range(nx):
            for c in range(m):
                new[i, c] = forcing[k, i, c]
            if linked[k]:
                for j in range(nx):
                    slope = phi[k, i, j]
                    if slope != 0.0:
                        for c in range(m):
                            new[i, c] += slope * state[j, c]
        state[:, :] = new
        for o in range(ny):
            for c in range(m):
                out[k, o, c] = direct[k, o, c]
            for j in range(nx):
                slope = read[k, o, j]
                if slope != 0.0:
                    for c in range(m):
                        out[k, o, c] += slope * state[j, c]


@compiled
def respond_to_features(  # noqa: C901, PLR0912
    phi: Array, read: Array, linked: Integers, gamma: Array, direct: Array,
    features: Array, out: Array,
) -> None:  # fmt: skip
    """Write the outputs' response to a source whose signal is each of `features`.

    ``gamma`` is (n, nx), ``direct`` (n, ny), ``features`` (n, m), ``out`` (n, ny, m).
    """
    n, nx = gamma.shape
    m, ny = features.shape[1], read.shape[1]
    state, new = np.zeros((nx, m)), np.zeros((nx, m))
    for k in range(n):
        for i in range(nx):
            for c in range(m):
                new[i, c] = 0.0
            if linked[k]:
                for c in range(m):
                    new[i, c] = gamma[k, i] * features[k - 1, c]
                for j in range(nx):
                    slope = phi[k, i, j]
                    if slope != 0.0:
                        for c in range(m):
                            new[i, c] += slope * state[j, c]
        state[:, :] = new
        for o in range(ny):
            for c in range(m):
                out[k, o, c] = direct[k, o] * features[k, c]
            for j in range(nx):
                slope = read[k, o, j]
                if slope != 0.0:
                    for c in range(m):
                        out[k, o, c] += slope * state[j, c]


@compiled
def _predict(  # noqa: C901, PLR0912
    phi: Array, gamma: Array, gamma_theta: Array, jump: Array, decay: float,
    variance: float, x: Array, p: Array, work: Array, nx: int,
) -> None:  # fmt: skip
    """Advance mean and covariance of (x, s, θ) by one step, in place."""
    d = len(x)
    nq = d - nx - 1
    mean = np.zeros(nx)
    for i in range(nx):
        total = jump[i] + gamma[i] * x[nx]
        for j in range(nx):
            total += phi[i, j] * x[j]
        for j in range(nq):
            total += gamma_theta[i, j] * x[nx + 1 + j]
        mean[i] = total
        for c in range(d):
            value = gamma[i] * p[nx, c]
            for j in range(nx):
                value += phi[i, j] * p[j, c]
            for j in range(nq):
                value += gamma_theta[i, j] * p[nx + 1 + j, c]
            work[i, c] = value
    for c in range(d):
        work[nx, c] = decay * p[nx, c]
        for j in range(nq):
            work[nx + 1 + j, c] = p[nx + 1 + j, c]
    for r in range(d):
        for i in range(nx):
            value = work[r, nx] * gamma[i]
            for j in range(nx):
                value += work[r, j] * phi[i, j]
            for j in range(nq):
                value += work[r, nx + 1 + j] * gamma_theta[i, j]
            p[r, i] = value
        p[r, nx] = work[r, nx] * decay
        for j in range(nq):
            p[r, nx + 1 + j] = work[r, nx + 1 + j]
    p[nx, nx] += variance * (1.0 - decay * decay)
    for r in range(d):
        for c in range(r):
            value = 0.5 * (p[r, c] + p[c, r])
            p[r, c] = value
            p[c, r] = value
    for i in range(nx):
        x[i] = mean[i]
    x[nx] = decay * x[nx]


@compiled
def _restart(x: Array, p: Array, prior: Array, variance: float, nx: int) -> None:
    """Begin another recording: nothing is known of x and s, all of θ is kept."""
    for i in range(nx + 1):
        x[i] = 0.0
        for c in range(len(x)):
            p[i, c] = 0.0
            p[c, i] = 0.0
        p[i, i] = prior[i] if i < nx else variance


@compiled
def filter_chain(  # noqa: C901, PLR0912
    phi: Array, gamma: Array, gamma_theta: Array, jump: Array, follows: Integers,
    read: Array, direct: Array, read_theta: Array, residual: Array, noise: Array,
    decay: Array, variance: float, prior: Array, theta_prior: Array,
    means: Array, covariances: Array, gains: Array, spreads: Array, errors: Array,
) -> tuple[float, float, int]:  # fmt: skip
    """Run the Kalman filter for (δx, s, δθ); return Σ log F, Σ v²/F and their count.

    ``decay[k]`` is exp(-Δt/τ) of the step to sample k, `variance` that of s. What the
    smoother needs is kept where ``means`` has n rows. Σ log F is infinite where the
    covariance does not stay positive.
    """
    n, nx = gamma.shape
    ny, nq = read.shape[1], gamma_theta.shape[2]
    d = nx + 1 + nq
    keep = means.shape[0] == n
    x, p, work = np.zeros(d), np.zeros((d, d)), np.zeros((d, d))
    h, gain = np.zeros(d), np.zeros(d)
    for j in range(nq):
        p[nx + 1 + j, nx + 1 + j] = theta_prior[j]
    logs, squares, count = 0.0, 0.0, 0
    for k in range(n):
        if follows[k]:
            _predict(
                phi[k], gamma[k], gamma_theta[k], jump[k], decay[k], variance,
                x, p, work, nx,
            )  # fmt: skip
        else:
            _restart(x, p, prior, variance, nx)
        if keep:
            means[k] = x
            covariances[k] = p
        for o in range(ny):
            if keep:
                spreads[k, o] = -1.0
            if not math.isfinite(residual[k, o]):
                continue
            h[:nx] = read[k, o]
            h[nx] = direct[k, o]
            h[nx + 1 :] = read_theta[k, o]
            error, spread = residual[k, o], noise[o]
            for i in range(d):
                gain[i] = 0.0
                for j in range(d):
                    gain[i] += p[i, j] * h[j]
            for i in range(d):
                error -= h[i] * x[i]
                spread += h[i] * gain[i]
            if not spread > 0.0:
                return math.inf, 0.0, count
            logs += math.log(spread)
            squares += error * error / spread
            count += 1
            for i in range(d):
                x[i] += gain[i] * error / spread
                for j in range(i + 1):
                    value = p[i, j] - gain[i] * gain[j] / spread
                    p[i, j] = value
                    p[j, i] = value
            if keep:
                for i in range(d):
                    gains[k, o, i] = gain[i] / spread
                spreads[k, o] = spread
                errors[k, o] = error
    return logs, squares, count


@compiled
def smooth_chain(  # noqa: C901, PLR0912
    phi: Array, gamma: Array, gamma_theta: Array, follows: Integers, read: Array,
    direct: Array, read_theta: Array, decay: Array, means: Array, covariances: Array,
    gains: Array, spreads: Array, errors: Array, smoothed: Array, deviation: Array,
) -> None:  # fmt: skip
    """Write smoothed means (n, d) and the variance of s (n,) from what a filter kept.

    The backward recursion of Bryson and Frazier, which inverts nothing: Λ and λ are
    the curvature and slope of what later samples say about the state.
    """
    n, d = means.shape
    nx, ny = phi.shape[1], read.shape[1]
    slope, curve = np.zeros(d), np.zeros((d, d))
    h, row, work = np.zeros(d), np.zeros(d), np.zeros((d, d))
    for k in range(n - 1, -1, -1):
        for o in range(ny - 1, -1, -1):
            if spreads[k, o] < 0.0:
                continue
            h[:nx] = read[k, o]
            h[nx] = direct[k, o]
            h[nx + 1 :] = read_theta[k, o]
            gain = gains[k, o]
            pull, bend = 0.0, 0.0
            for i in range(d):
                row[i] = 0.0
                for j in range(d):
                    row[i] += curve[i, j] * gain[j]
            for i in range(d):
                pull += gain[i] * slope[i]
                bend += gain[i] * row[i]
            for i in range(d):
                slope[i] -= h[i] * (pull + errors[k, o] / spreads[k, o])
            for i in range(d):
                for j in range(d):
                    curve[i, j] += (
                        h[i] * h[j] * (bend + 1.0 / spreads[k, o])
                        - h[i] * row[j]
                        - row[i] * h[j]
                    )
        for i in range(d):
            total = means[k, i]
            for j in range(d):
                total -= covariances[k, i, j] * slope[j]
            smoothed[k, i] = total
        own = covariances[k, nx, nx]
        for i in range(d):
            for j in range(d):
                own -= covariances[k, nx, i] * curve[i, j] * covariances[k, j, nx]
        deviation[k] = own
        _retreat(
            phi[k], gamma[k], gamma_theta[k], decay[k], follows[k], slope, curve, work,
            nx,
        )  # fmt: skip


@compiled
def _retreat(
    phi: Array, gamma: Array, gamma_theta: Array, decay: float, follows: int,
    slope: Array, curve: Array, work: Array, nx: int,
) -> None:  # fmt: skip
    """Take slope and curvature back over one step: AᵀΛA and Aᵀλ."""
    d = len(slope)
    if not follows:
        for i in range(nx + 1):
            slope[i] = 0.0
            for j in range(d):
                curve[i, j] = 0.0
                curve[j, i] = 0.0
        return
    a = np.zeros((d, d))
    for i in range(nx):
        for j in range(nx):
            a[i, j] = phi[i, j]
        a[i, nx] = gamma[i]
        for j in range(d - nx - 1):
            a[i, nx + 1 + j] = gamma_theta[i, j]
    a[nx, nx] = decay
    for j in range(nx + 1, d):
        a[j, j] = 1.0
    work[:, :] = curve @ a
    curve[:, :] = a.T @ work
    slope[:] = a.T @ slope
