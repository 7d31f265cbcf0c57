"""Moving a machine through a recording: many small steps between two samples.

A machine has coordinates q with flows v (``M(q, v) dv/dt = F``) and stores z
(``dz/dt = g``). One small step is Moreau's midpoint rule: positions half a step on,
smooth efforts at the middle, dry efforts as impulses by projection on the interval of
what they can bear, with several dry laws by Gauss-Seidel sweeps. It is of second order
where the motion is smooth and holds exactly where it sticks.

Between two samples the applied input is constant (zero-order hold).
"""

import math

import numpy as np

from benchmarks.concealed.compiling import MARCH, PUSH, compiled
from benchmarks.concealed.laws import DRY, dry_limits, remember, smooth_effort
from benchmarks.concealed.paths import command, drive, lag_readings, sense

SWEEPS = 8


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


@compiled()
def advance(forces, masses, p, u, slots, h, state, spare):
    """Move the state one small step on; `spare` is room to work in."""
    q, v, z, acceleration, stored = state
    v_new, v_mid, F, z_new, z_mid, g, load, M = spare
    kind, row, _, a, _, memory = slots
    n = v.size
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


@compiled()
def note(state, slots, motion, states):
    """Write down a sample's motion at the places and the whole state."""
    q, v, z, _, stored = state
    row, cell = slots[1], slots[2]
    n = v.size
    for i in range(row.shape[0]):
        for j in range(n):
            motion[2 * i] += row[i, j] * q[j]
            motion[2 * i + 1] += row[i, j] * v[j]
        if cell[i] >= 0:
            motion[2 * i + 1] = stored[cell[i]]
    states[:n], states[n : 2 * n], states[2 * n :] = q, v, z


@compiled(MARCH)
def march(
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
    N, nu, ny, n = feed.shape[0], feed.shape[1], noise.shape[1], q.size
    h = dt / fine
    commands, given = np.zeros((nu, N)), np.zeros((N, ny))
    truth = np.zeros((ny, (N - 1) * fine + 1))
    motion = np.zeros((N, 2 * slots[1].shape[0]))
    states = np.zeros((N, 2 * n + z.size))
    y, u = np.zeros(ny), np.zeros(nu)
    slope, before = np.zeros(control[0].size), np.zeros(control[0].size)
    state = (q, v, z, np.zeros(n), np.zeros(max(z.size, 1)))
    acceleration = state[3]
    spare = (
        np.zeros(n), np.zeros(n), np.zeros(n),
        np.zeros(z.size), np.zeros(z.size), np.zeros(z.size),
        np.zeros(8), np.zeros((n, n)),
    )  # fmt: skip
    in_state, out_state = feed[0].copy(), np.zeros(ny)
    readings(q, v, z, u, p, acceleration, y)
    truth[:, 0] = y
    out_state[:] = y
    for k in range(N):
        sense(sensors, truth, k, fine, early[k], noise[k], h, out_state, given[k])
        note(state, slots, motion[k], states[k])
        command(
            control, feed[k], reference[k], given[k], dt, k == 0, slope, before,
            commands[:, k],
        )  # fmt: skip
        if k == 0:
            in_state[:] = commands[:, 0]
        if k + 1 == N:
            break
        for i in range(fine):
            speed = v[0] if n > 0 else z[0]
            drive(inputs, commands, k, i, dt, h, in_state, speed, u)
            advance(forces, masses, p, u, slots, h, state, spare)
            if not (np.all(np.isfinite(v)) and np.all(np.isfinite(z))):
                given[:] = np.nan
                return commands, given, states, motion
            readings(q, v, z, u, p, acceleration, y)
            truth[:, k * fine + i + 1] = y
            lag_readings(sensors, y, h, out_state)
    return commands, given, states, motion
