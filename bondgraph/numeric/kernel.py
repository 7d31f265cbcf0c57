"""The gate, second half: one compiled kernel that runs any tape, with tangents.

`run` evaluates a tape and, in the same sweep, the derivative of every slot along
``n`` directions (forward mode). `integrate` steps a semi-explicit model

    r(w; x, u, p, t) = 0,   w = (ẋ, z)

with a diagonally implicit, stiffly accurate Runge-Kutta method: each stage solves for w
by Newton with the exact Jacobian, and the sensitivities to parameters and initial
states are those of the discrete solution (implicit function theorem), exact to rounding.
The kernel compiles once and is cached on disk; models never compile.
"""

import math

import numba
import numpy as np
from numba import njit

_OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": False}


@njit(**_OPTIONS)
def run(code, first, v, d, n):  # noqa: C901, PLR0912, PLR0915
    """Run the tape on values `v` and tangents ``d[slot, :n]``."""
    for i in range(code.shape[0]):
        op, a, b, c = code[i, 0], code[i, 1], code[i, 2], code[i, 3]
        s = first + i
        x = v[a]
        if op == 1:
            y = v[b]
            v[s] = x * y
            for k in range(n):
                d[s, k] = y * d[a, k] + x * d[b, k]
        elif op == 0:
            v[s] = x + v[b]
            for k in range(n):
                d[s, k] = d[a, k] + d[b, k]
        elif op == 28:
            v[s] = x - v[b]
            for k in range(n):
                d[s, k] = d[a, k] - d[b, k]
        elif op == 2:
            inverse = 1.0 / v[b]
            y = x * inverse
            v[s] = y
            for k in range(n):
                d[s, k] = (d[a, k] - y * d[b, k]) * inverse
        elif op == 26:
            chosen = b if x != 0.0 else c
            v[s] = v[chosen]
            for k in range(n):
                d[s, k] = d[chosen, k]
        elif op == 14 or op == 15:
            y = v[b]
            first_wins = x >= y if op == 14 else x <= y
            chosen = a if first_wins else b
            v[s] = v[chosen]
            for k in range(n):
                d[s, k] = d[chosen, k]
        elif op == 4:
            y = v[b]
            value = x**y
            v[s] = value
            da = y * x ** (y - 1.0) if y != 0.0 else 0.0
            db = value * math.log(x) if x > 0.0 else 0.0
            for k in range(n):
                d[s, k] = da * d[a, k] + db * d[b, k]
        elif op == 27:
            y = v[b]
            v[s] = math.atan2(x, y)
            norm = 1.0 / (x * x + y * y)
            for k in range(n):
                d[s, k] = (y * d[a, k] - x * d[b, k]) * norm
        elif 21 <= op <= 25:
            if op == 21:
                v[s] = 1.0 if x < v[b] else 0.0
            elif op == 22:
                v[s] = 1.0 if x <= v[b] else 0.0
            elif op == 23:
                v[s] = 1.0 if x != 0.0 and v[b] != 0.0 else 0.0
            elif op == 24:
                v[s] = 1.0 if x != 0.0 or v[b] != 0.0 else 0.0
            else:
                v[s] = 1.0 if x == 0.0 else 0.0
            for k in range(n):
                d[s, k] = 0.0
        else:
            slope = 0.0
            if op == 3:
                v[s] = x**b
                slope = b * x ** (b - 1) if b != 0 else 0.0
            elif op == 5:
                v[s] = math.sqrt(x) if x >= 0.0 else math.nan
                slope = 0.5 / max(v[s], 1e-150)
            elif op == 6:
                v[s] = math.sin(x)
                slope = math.cos(x)
            elif op == 7:
                v[s] = math.cos(x)
                slope = -math.sin(x)
            elif op == 8:
                v[s] = math.tan(x)
                slope = 1.0 + v[s] * v[s]
            elif op == 9:
                v[s] = math.exp(x) if x < 700.0 else math.inf
                slope = v[s]
            elif op == 10:
                v[s] = math.log(x) if x > 0.0 else math.nan
                slope = 1.0 / x
            elif op == 11:
                v[s] = math.tanh(x)
                slope = 1.0 - v[s] * v[s]
            elif op == 12:
                v[s] = abs(x)
                slope = 1.0 if x > 0.0 else (-1.0 if x < 0.0 else 0.0)
            elif op == 13:
                v[s] = 1.0 if x > 0.0 else (-1.0 if x < 0.0 else 0.0)
            elif op == 16:
                v[s] = math.atan(x)
                slope = 1.0 / (1.0 + x * x)
            elif op == 17:
                v[s] = math.sinh(x)
                slope = math.cosh(x)
            elif op == 18:
                v[s] = math.cosh(x)
                slope = math.sinh(x)
            elif op == 19:
                v[s] = math.asin(x)
                slope = 1.0 / math.sqrt(1.0 - x * x)
            elif op == 20:
                v[s] = math.acos(x)
                slope = -1.0 / math.sqrt(1.0 - x * x)
            for k in range(n):
                d[s, k] = slope * d[a, k]


@njit(**_OPTIONS)
def factor(a, n, pivot):
    """Factor ``a[:n, :n]`` in place (LU, partial pivoting); return False if singular."""
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        pivot[k] = best
        if not abs(a[best, k]) > 1e-300:
            return False
        if best != k:
            for j in range(n):
                a[k, j], a[best, j] = a[best, j], a[k, j]
        for i in range(k + 1, n):
            a[i, k] /= a[k, k]
            for j in range(k + 1, n):
                a[i, j] -= a[i, k] * a[k, j]
    return True


@njit(**_OPTIONS)
def substitute(a, n, pivot, b, m):
    """Solve in place for the `m` columns of ``b[:n, :m]`` after `factor`."""
    for k in range(n):
        best = pivot[k]
        if best != k:
            for j in range(m):
                b[k, j], b[best, j] = b[best, j], b[k, j]
    for k in range(n):
        for i in range(k + 1, n):
            for j in range(m):
                b[i, j] -= a[i, k] * b[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(m):
            b[k, j] /= a[k, k]
        for i in range(k):
            for j in range(m):
                b[i, j] -= a[i, k] * b[k, j]


@njit(**_OPTIONS)
def _solve_stage(code, first, rate, residual, nx, nz, linear, h, base, w, v, d, lu, pivot, rhs, weight):  # noqa: E501
    """Solve r(w) = 0 with x = base + h ẋ; return whether Newton converged.

    On return `v`, `d` hold values and derivatives along w at the solution, and `lu` the
    factored Jacobian dr/dw.
    """
    nw = nx + nz
    damping = 1.0
    last = math.inf
    step = np.zeros(nw)
    for iteration in range(40):
        for i in range(nx):
            v[i] = base[i] + h * w[i]
            v[nx + i] = w[i]
        for i in range(nz):
            v[2 * nx + i] = w[nx + i]
        run(code, first, v, d, nw)
        for i in range(nx):
            rhs[i, 0] = w[i] - v[rate[i]]
        for i in range(nz):
            rhs[nx + i, 0] = v[residual[i]]
        if iteration > 0 and not linear:
            # Affine-invariant monotonicity test with the previous Jacobian.
            substitute(lu, nw, pivot, rhs, 1)
            size = 0.0
            for i in range(nw):
                size = max(size, abs(rhs[i, 0]) / weight[i])
            if not size <= (1.0 - 0.25 * damping) * last and damping > 1e-4:
                for i in range(nw):
                    w[i] += (damping - 0.5 * damping) * step[i]
                damping *= 0.5
                continue
            for i in range(nx):
                rhs[i, 0] = w[i] - v[rate[i]]
            for i in range(nz):
                rhs[nx + i, 0] = v[residual[i]]
        for j in range(nw):
            for i in range(nx):
                lu[i, j] = -d[rate[i], j]
            for i in range(nz):
                lu[nx + i, j] = d[residual[i], j]
        for i in range(nx):
            lu[i, i] += 1.0
        if not factor(lu, nw, pivot):
            return False
        substitute(lu, nw, pivot, rhs, 1)
        last = 0.0
        for i in range(nw):
            if not math.isfinite(rhs[i, 0]):
                return False
            step[i] = rhs[i, 0]
            weight[i] = max(weight[i], abs(w[i]))
            last = max(last, abs(step[i]) / weight[i])
        damping = min(1.0, 2.0 * damping) if iteration > 0 else 1.0
        for i in range(nw):
            w[i] -= damping * step[i]
        if linear or (last <= 1e-7 and damping == 1.0):
            for i in range(nx):
                v[i] = base[i] + h * w[i]
                v[nx + i] = w[i]
            for i in range(nz):
                v[2 * nx + i] = w[nx + i]
            return True
    return False


@njit(**_OPTIONS)
def integrate(  # noqa: C901, PLR0912, PLR0915
    dynamics, n_constants, rate, residual, linear, instantaneous,
    output, n_output_constants, read, constants, output_constants,
    nx, nz, nu, p, directions, time, u, zero_hold, a, c, substeps, x0, y, s, states,
):  # fmt: skip
    """Simulate one window; return the number of samples completed.

    Parameters
    ----------
    dynamics, output
        Tape code for (rates, residuals) and for the outputs; `rate`, `residual` and
        `read` are their result slots. Variables: x, ẋ, z, u, u̇, p, t.
    linear
        Whether r is affine in w and x, so that one Newton step solves a stage.
    instantaneous
        Whether an output depends on ẋ or z, so that these are solved at each sample.
    directions
        Indices into `p` of the parameters whose sensitivities are wanted; those of the
        initial states follow.
    a, c
        Runge-Kutta matrix (lower triangular, constant diagonal, last row = weights).
    y, s, states
        Results: outputs (n, ny), sensitivities (n, ny, nq + nx), states (n, nx).
    """
    n, ny, nq = len(time), y.shape[1], len(directions)
    nw, nd, stages = nx + nz, nq + nx, len(c)
    at_u, at_p = 2 * nx + nz, 2 * nx + nz + 2 * nu
    n_variables = at_p + len(p) + 1
    first = n_variables + n_constants
    first_out = n_variables + n_output_constants
    slots, slots_out = first + dynamics.shape[0], first_out + output.shape[0]
    with_tangents = s.shape[0] > 0
    n_sens = nd if with_tangents else 0

    v, vo = np.zeros(slots), np.zeros(slots_out)
    d, do = np.zeros((slots, max(nw, 1))), np.zeros((slots_out, max(nw, 1)))
    dq, dqo = np.zeros((slots, max(n_sens, 1))), np.zeros((slots_out, max(n_sens, 1)))
    v[n_variables:first] = constants
    vo[n_variables:first_out] = output_constants
    v[at_p : at_p + len(p)] = p
    vo[at_p : at_p + len(p)] = p
    if with_tangents:
        for k in range(nq):
            dq[at_p + directions[k], k] = 1.0
            dqo[at_p + directions[k], k] = 1.0
    lu, pivot = np.zeros((nw, nw)), np.zeros(nw, dtype=np.int64)
    rhs, sens = np.zeros((nw, 1)), np.zeros((nw, max(n_sens, 1)))
    weight = np.full(nw, 1e-12)
    x, w = x0.copy(), np.zeros(nw)
    dx = np.zeros((nx, max(n_sens, 1)))
    if with_tangents:
        for i in range(nx):
            dx[i, nq + i] = 1.0
    k_stage = np.zeros((stages, nx))
    dk_stage = np.zeros((stages, nx, max(n_sens, 1)))
    base, dbase = np.zeros(nx), np.zeros((nx, max(n_sens, 1)))

    for sample in range(n):
        # Outputs at this sample.
        nxt = min(sample + 1, n - 1)
        span = time[nxt] - time[sample]
        for i in range(nu):
            slope = 0.0
            if not zero_hold and span > 0.0:
                slope = (u[nxt, i] - u[sample, i]) / span
            v[at_u + i] = u[sample, i]
            v[at_u + nu + i] = slope
            vo[at_u + i] = u[sample, i]
            vo[at_u + nu + i] = slope
        v[n_variables - 1] = time[sample]
        vo[n_variables - 1] = time[sample]
        if instantaneous and nw > 0:
            for j in range(nw):
                for i in range(2 * nx + nz):
                    d[i, j] = 0.0
                d[nx + j, j] = 1.0
            if not _solve_stage(dynamics, first, rate, residual, nx, nz, linear, 0.0, x, w, v, d, lu, pivot, rhs, weight):  # noqa: E501
                return sample
        for i in range(nx):
            vo[i] = x[i]
            vo[nx + i] = w[i]
        for i in range(nz):
            vo[2 * nx + i] = w[nx + i]
        if with_tangents:
            if instantaneous and nw > 0:
                for m in range(n_sens):
                    for i in range(nx):
                        dq[i, m] = dx[i, m]
                    for i in range(nw):
                        dq[nx + i, m] = 0.0
                run(dynamics, first, v, dq, n_sens)
                for m in range(n_sens):
                    for i in range(nx):
                        sens[i, m] = dq[rate[i], m]
                    for i in range(nz):
                        sens[nx + i, m] = -dq[residual[i], m]
                substitute(lu, nw, pivot, sens, n_sens)
            for m in range(n_sens):
                for i in range(nx):
                    dqo[i, m] = dx[i, m]
                for i in range(nw):
                    dqo[nx + i, m] = sens[i, m] if instantaneous else 0.0
        run(output, first_out, vo, dqo, n_sens)
        for j in range(ny):
            y[sample, j] = vo[read[j]]
            if with_tangents:
                for m in range(n_sens):
                    s[sample, j, m] = dqo[read[j], m]
        for i in range(nx):
            states[sample, i] = x[i]
        if sample == n - 1 or nx == 0:
            continue
        # Step to the next sample.
        h = span / substeps
        for sub in range(substeps):
            t0 = time[sample] + sub * h
            for stage in range(stages):
                ts = t0 + c[stage] * h
                fraction = 0.0 if zero_hold else (ts - time[sample]) / span
                for i in range(nu):
                    v[at_u + i] = u[sample, i] + fraction * (u[nxt, i] - u[sample, i])
                v[n_variables - 1] = ts
                for i in range(nx):
                    base[i] = x[i]
                    for j in range(stage):
                        base[i] += h * a[stage, j] * k_stage[j, i]
                gamma = h * a[stage, stage]
                for j in range(nw):
                    for i in range(2 * nx + nz):
                        d[i, j] = 0.0
                    if j < nx:
                        d[j, j] = gamma
                    d[nx + j, j] = 1.0
                if not _solve_stage(dynamics, first, rate, residual, nx, nz, linear, gamma, base, w, v, d, lu, pivot, rhs, weight):  # noqa: E501
                    return sample
                for i in range(nx):
                    k_stage[stage, i] = w[i]
                if with_tangents:
                    for m in range(n_sens):
                        for i in range(nx):
                            dbase[i, m] = dx[i, m]
                            for j in range(stage):
                                dbase[i, m] += h * a[stage, j] * dk_stage[j, i, m]
                            dq[i, m] = dbase[i, m]
                        for i in range(nw):
                            dq[nx + i, m] = 0.0
                    run(dynamics, first, v, dq, n_sens)
                    for m in range(n_sens):
                        for i in range(nx):
                            sens[i, m] = dq[rate[i], m]
                        for i in range(nz):
                            sens[nx + i, m] = -dq[residual[i], m]
                    substitute(lu, nw, pivot, sens, n_sens)
                    for m in range(n_sens):
                        for i in range(nx):
                            dk_stage[stage, i, m] = sens[i, m]
            for i in range(nx):
                for j in range(stages):
                    x[i] += h * a[stages - 1, j] * k_stage[j, i]
                if not math.isfinite(x[i]):
                    return sample
            if with_tangents:
                for m in range(n_sens):
                    for i in range(nx):
                        for j in range(stages):
                            dx[i, m] += h * a[stages - 1, j] * dk_stage[j, i, m]
    return n


def compile_now() -> None:
    """Load numba's cached kernel (or compile it), so that later calls are quick."""
    assert numba.__version__
