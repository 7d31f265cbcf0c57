"""Moving a machine through a recording: many small steps between two samples.

A machine has coordinates q with flows v (``M(q, v) dv/dt = F``) and stores z
(``dz/dt = g``). One small step is Moreau's midpoint rule: positions half a step on,
smooth efforts at the middle, dry efforts as impulses by projection on the interval of
what they can bear, with several dry laws by Gauss-Seidel sweeps. It is of second order
where the motion is smooth and holds exactly where it sticks.

Between two samples the applied input is constant (zero-order hold). A loop may be
closed: the controller sees what the sensor gives, noise and steps included.
"""

import math

import numpy as np

from benchmarks.concealed.compiling import MARCH, PUSH, compiled
from benchmarks.concealed.laws import DRY, dry_limits, remember, smooth_effort

SWEEPS = 8

IN_NONE, IN_BIAS, IN_SATURATION, IN_DEAD_ZONE, IN_LAG, IN_DELAY = range(6)
IN_SPEED_GAIN, IN_SCALE = 6, 7
OUT_NONE, OUT_SCALE, OUT_BIAS, OUT_CUBIC, OUT_LAG, OUT_DELAY, OUT_CLIP = range(7)
OUT_DRIFT = 7


@compiled()
def solve_spd(M, b, n):
    """Solve M x = b in place of b for a small positive definite M (Cholesky)."""
    for i in range(n):
        for j in range(i + 1):
            total = M[i, j]
            for k in range(j):
                total -= M[i, k] * M[j, k]
            M[i, j] = math.sqrt(total) if i == j else total / M[j, j]
    for i in range(n):
        for k in range(i):
            b[i] -= M[i, k] * b[k]
        b[i] /= M[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            b[i] -= M[k, i] * b[k]
        b[i] /= M[i, i]


@compiled()
def through_input(kind, a, command, commands, k, into, dt, state, speed):
    """Return what reaches the machine of a commanded input, `into` s after sample k."""
    applied = command
    if kind == IN_BIAS:
        applied = command + a[0]
    elif kind == IN_SCALE:
        applied = command * (1.0 + a[0])
    elif kind == IN_SATURATION:
        applied = min(max(command, -a[0]), a[0])
    elif kind == IN_DEAD_ZONE:
        applied = np.sign(command) * max(abs(command) - a[0], 0.0)
    elif kind == IN_LAG:
        applied = state
    elif kind == IN_DELAY:
        index = math.floor(k + (into - a[0]) / dt)
        applied = commands[max(index, 0)]
    elif kind == IN_SPEED_GAIN:
        applied = command * (1.0 + a[0] * math.tanh((speed / a[1]) ** 2))
    return applied


@compiled()
def through_sensor(kind, a, reading, fine, at, h, state):
    """Return what a sensor gives for the true `reading`; `fine` holds the past."""
    given = reading
    if kind == OUT_SCALE:
        given = reading * (1.0 + a[0])
    elif kind == OUT_BIAS:
        given = reading + a[0]
    elif kind == OUT_CUBIC:
        given = reading + a[0] * reading**3
    elif kind == OUT_LAG:
        given = state
    elif kind == OUT_DELAY:
        given = fine[max(at - int(a[0] / h), 0)]
    elif kind == OUT_CLIP:
        given = min(max(reading, -a[0]), a[0])
    elif kind == OUT_DRIFT:
        given = reading + a[0] * at * h
    return given


@compiled(PUSH)
def push(  # noqa: PLR0912, C901 - one loop over laws, kept in one piece for speed
    forces, masses, q, v, z, u, p, acceleration, slots, h, v_at, z_at,
    v_new, z_new, F, g, load, stored, M,
):  # fmt: skip
    """Write flows and stores a step `h` on, with rates taken at (q, v_at, z_at)."""
    kind, row, cell, a, loaded, memory = slots
    n = v.size
    F[:] = 0.0
    g[:] = 0.0
    forces(q, v_at, z_at, u, p, acceleration, F, g, load, stored)
    for k in range(kind.size):
        if kind[k] >= DRY:
            continue
        if cell[k] >= 0:
            effort = stored[cell[k]]
            g[cell[k]] -= smooth_effort(kind[k], a[k], 0.0, effort, memory[k])
            continue
        s, w = 0.0, 0.0
        for i in range(n):
            s += row[k, i] * q[i]
            w += row[k, i] * v_at[i]
        effort = smooth_effort(kind[k], a[k], s, w, memory[k])
        for i in range(n):
            F[i] -= row[k, i] * effort
    for i in range(z.size):
        z_new[i] = z[i] + h * g[i]
    if n == 0:
        return
    masses(q, v_at, p, M)
    solve_spd(M, F, n)
    for i in range(n):
        v_new[i] = v[i] + h * F[i]
    if not np.any(kind >= DRY):
        return
    impulse, ease = np.zeros(kind.size), np.zeros(kind.size)
    answer = row.copy()
    for k in range(kind.size):
        if kind[k] >= DRY:
            masses(q, v_at, p, M)
            solve_spd(M, answer[k], n)
            for i in range(n):
                ease[k] += row[k, i] * answer[k, i]
    for _ in range(SWEEPS):
        moved = 0.0
        for k in range(kind.size):
            if kind[k] < DRY:
                continue
            s, w, middle = 0.0, 0.0, 0.0
            for i in range(n):
                s += row[k, i] * q[i]
                w += row[k, i] * v_new[i]
                middle += row[k, i] * v_at[i]
            forward, backward = dry_limits(kind[k], a[k], s, middle, load[loaded[k]])
            wanted = impulse[k] - w / ease[k]
            wanted = min(max(wanted, -h * backward), h * forward)
            change = wanted - impulse[k]
            impulse[k] = wanted
            moved = max(moved, abs(change * ease[k]))
            for i in range(n):
                v_new[i] += answer[k, i] * change
        if moved < 1e-15:
            break


@compiled(MARCH)
def march(  # noqa: PLR0912, PLR0915, C901 - the time loop of the whole simulation
    forces, masses, readings, p, start, slots, inputs, sensors, control,
    feed, reference, noise, early, dt, fine,
):  # fmt: skip
    """Return commands (nu, N), readings (N, ny), states (N, q v z), motion at places.

    Parameters
    ----------
    start
        (q, v, z) at the first sample.
    slots
        (kind, row, cell, numbers, load index, memory) of the laws at places.
    inputs, sensors
        (kind, numbers) per input and per output: what sits in the signal path.
    control
        (kp, kd, channel, derivative time) per controlled input, then limit and step of
        every command; a controlled input is ``feed + kp (reference - y) - kd dy/dt`` of
        its channel.
    reference
        (N, nu), of which as many columns are read as there are controllers.
    noise
        (N, ny) added before quantisation; the last row of `sensors` numbers has the
        step.
    early
        (N, ny) small steps by which a sample is taken too early (jitter).
    """
    q, v, z = start[0].copy(), start[1].copy(), start[2].copy()
    kind, row, cell, a, _, memory = slots
    in_kind, in_a = inputs
    out_kind, out_a, out_step = sensors
    kp, kd, channel, tau, limit, step = control
    N, nu, ny, n = feed.shape[0], feed.shape[1], noise.shape[1], q.size
    h = dt / fine
    commands, given = np.zeros((nu, N)), np.zeros((N, ny))
    truth = np.zeros((ny, (N - 1) * fine + 1))
    places = row.shape[0]
    trail = np.zeros((N, 2 * places))
    states = np.zeros((N, 2 * n + z.size))
    y, u = np.zeros(ny), np.zeros(nu)
    in_state, out_state = feed[0].copy(), np.zeros(ny)
    acceleration = np.zeros(n)
    v_new, v_mid, F = np.zeros(n), np.zeros(n), np.zeros(n)
    z_new, z_mid, g = np.zeros(z.size), np.zeros(z.size), np.zeros(z.size)
    load, stored, M = np.zeros(8), np.zeros(max(z.size, 1)), np.zeros((n, n))
    slope, before = np.zeros(kp.size), np.zeros(kp.size)
    for k in range(N):
        readings(q, v, z, u, p, acceleration, y)
        if k == 0:
            out_state[:] = y
        for j in range(ny):
            truth[j, k * fine] = y[j]
            at = max(k * fine - early[k, j], 0)
            true = truth[j, at]
            true = through_sensor(
                out_kind[j], out_a[j], true, truth[j], at, h, out_state[j]
            )
            given[k, j] = true + noise[k, j]
            if out_step[j] > 0.0:
                given[k, j] = np.round(given[k, j] / out_step[j]) * out_step[j]
        for i in range(places):
            for j in range(n):
                trail[k, 2 * i] += row[i, j] * q[j]
                trail[k, 2 * i + 1] += row[i, j] * v[j]
            if cell[i] >= 0:
                trail[k, 2 * i + 1] = stored[cell[i]]
        states[k, :n], states[k, n : 2 * n], states[k, 2 * n :] = q, v, z
        for j in range(nu):
            commands[j, k] = feed[k, j]
        for j in range(kp.size):
            sensed = given[k, channel[j]]
            if k == 0:
                before[j] = sensed
            share = dt / (dt + tau[j])
            slope[j] += share * ((sensed - before[j]) / dt - slope[j])
            before[j] = sensed
            commands[j, k] += kp[j] * (reference[k, j] - sensed) - kd[j] * slope[j]
            commands[j, k] = min(max(commands[j, k], -limit), limit)
            if step > 0.0:
                commands[j, k] = np.round(commands[j, k] / step) * step
        if k == 0:
            for j in range(nu):
                in_state[j] = commands[j, 0]
        if k + 1 == N:
            break
        for i in range(fine):
            speed = v[0] if n > 0 else z[0]
            for j in range(nu):
                command = commands[j, k]
                if in_kind[j] == IN_LAG:
                    fade = math.exp(-h / in_a[j, 0])
                    middle = command + (in_state[j] - command) * math.sqrt(fade)
                    in_state[j] = command + (in_state[j] - command) * fade
                    u[j] = middle
                else:
                    u[j] = through_input(
                        in_kind[j], in_a[j], command, commands[j], k,
                        (i + 0.5) * h, dt, in_state[j], speed,
                    )  # fmt: skip
            for j in range(n):
                q[j] += 0.5 * h * v[j]
            push(forces, masses, q, v, z, u, p, acceleration, slots, h, v, z,
                 v_new, z_new, F, g, load, stored, M)  # fmt: skip
            v_mid[:] = 0.5 * (v + v_new)
            z_mid[:] = 0.5 * (z + z_new)
            push(forces, masses, q, v, z, u, p, acceleration, slots, h, v_mid, z_mid,
                 v_new, z_new, F, g, load, stored, M)  # fmt: skip
            v_mid[:] = 0.5 * (v + v_new)
            for j in range(n):
                acceleration[j] = (v_new[j] - v[j]) / h
            for m in range(kind.size):
                s, w = 0.0, 0.0
                for j in range(n):
                    s += row[m, j] * (q[j] + 0.5 * h * v_new[j])
                    w += row[m, j] * v_mid[j]
                remember(kind[m], a[m], s, w, memory[m], h)
            for j in range(n):
                q[j] += 0.5 * h * v_new[j]
            v[:] = v_new
            z[:] = z_new
            if not (np.all(np.isfinite(v)) and np.all(np.isfinite(z))):
                given[:] = np.nan
                return commands, given, states, trail
            readings(q, v, z, u, p, acceleration, y)
            for j in range(ny):
                truth[j, k * fine + i + 1] = y[j]
                if out_kind[j] == OUT_LAG:
                    fade = math.exp(-h / out_a[j, 0])
                    out_state[j] = y[j] + (out_state[j] - y[j]) * fade
    return commands, given, states, trail
