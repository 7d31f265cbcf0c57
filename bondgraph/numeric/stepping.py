"""One step of a diagonally implicit Runge-Kutta method, compiled.

A step in which a slipping friction stops or turns round is split there: with the modes
held, the part of the step after which the argument vanishes is searched; the friction
decides anew, and the rest follows. So the error stays that of a smooth step, and what
is a kink in a fixed grid of steps has its right slope: the time of the event depends on
the parameters, and the sensitivities jump by ``(ẋ⁻ - ẋ⁺) dt`` (the saltation of
Aizerman and Gantmacher, Q. J. Mech. Appl. Math. 11, 1958).
"""

import math
from typing import NamedTuple

import numpy as np

from bondgraph.numeric.machine import Array, Integers, compiled, inlined, lean, run
from bondgraph.numeric.stage import solve_stage, stage_sensitivity
from bondgraph.numeric.stage_arrays import STICKS, System, Work

EVENTS = 8  # splits of one step; the rest is taken as it is
SEARCH = 40
CLOSE = 1e-10  # of a step, to which an event is located,
NARROW = 1e-12  # or of the argument's size in it, within which it vanishes
SHORTEST = 1e-3  # of a step, down to which it is halved where it has no solution
NEAR = 1e-5  # of the way to an event, to see how fast it comes
GLANCE = 1e-6  # of a step, the time over which friction at one instant is judged


class Method(NamedTuple):
    """A Runge-Kutta method: matrix (last row = weights), nodes, steps per sample."""

    a: Array
    c: Array
    substeps: int
    zero_hold: bool


class Steps(NamedTuple):
    """Scratch of the time stepping.

    Stage base point, slopes and their tangents; states, tangents, unknowns and modes at
    the start of a step; ``since``: when each friction took its mode; ``moved``:
    by how much an event comes later; ``argument``: those of the frictions before.
    """

    base: Array
    dbase: Array
    k: Array
    dk: Array
    x: Array
    dx: Array
    w: Array
    mode: Integers
    since: Array
    moved: Array
    argument: Array


class Drive(NamedTuple):
    """Inputs between two samples: values and slopes at ``time``."""

    u: Array
    slope: Array
    time: float


@compiled
def make_steps(system: System, stages: int, n: int) -> Steps:
    """Return zeroed scratch for `n` tangent directions."""
    nx, columns = system.nx, max(n, 1)
    return Steps(
        np.zeros(nx),
        np.zeros((nx, columns)),
        np.zeros((stages, nx)),
        np.zeros((stages, nx, columns)),
        np.zeros(nx),
        np.zeros((nx, columns)),
        np.zeros(nx + system.nz),
        np.zeros(system.nd, dtype=np.int64),
        np.full(system.nd, -math.inf),
        np.zeros(columns),
        np.zeros(system.nd),
    )


@inlined
def set_inputs(system: System, v: Array, drive: Drive, elapsed: float) -> None:
    """Write u, u̇ and t at `elapsed` seconds after a sample."""
    at = 2 * system.nx + system.nz
    for i in range(system.nu):
        v[at + i] = drive.u[i] + drive.slope[i] * elapsed
        v[at + system.nu + i] = drive.slope[i]
    v[at + 2 * system.nu + system.n_parameters] = drive.time + elapsed


@inlined
def stage_base(
    method: Method, steps: Steps, x: Array, dx: Array, stage: int, h: float, n: int
) -> None:
    """Write x of a stage without its own slope, and its tangents."""
    for i in range(len(x)):
        steps.base[i] = x[i]
        for j in range(stage):
            steps.base[i] += h * method.a[stage, j] * steps.k[j, i]
        for m in range(n):
            steps.dbase[i, m] = dx[i, m]
            for j in range(stage):
                steps.dbase[i, m] += h * method.a[stage, j] * steps.dk[j, i, m]


@inlined
def sum_stages(
    method: Method, steps: Steps, x: Array, dx: Array, h: float, n: int
) -> bool:
    """Add the stages' slopes to x; return whether it stays finite."""
    finite = True
    stages = len(method.c)
    for i in range(len(x)):
        for j in range(stages):
            weight = h * method.a[stages - 1, j]
            x[i] += weight * steps.k[j, i]
            for m in range(n):
                dx[i, m] += weight * steps.dk[j, i, m]
        finite = finite and math.isfinite(x[i])
    return finite


@lean
def _step(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    drive: Drive, elapsed: float, h: float, n: int,
) -> bool:  # fmt: skip
    """Take one Runge-Kutta step of size `h` in place; False where it fails.

    Where modes are not held, it ends early if a friction no longer slips.
    """
    for stage in range(len(method.c)):
        set_inputs(system, work.v, drive, elapsed + method.c[stage] * h)
        stage_base(method, steps, x, dx, stage, h, n)
        size = h * method.a[stage, stage]
        if not solve_stage(system, work, steps.base, size):
            return False
        if n > 0:
            stage_sensitivity(system, work, steps.dbase, size, n)
        for i in range(system.nx):
            steps.k[stage, i] = work.w[i]
            for m in range(n):
                steps.dk[stage, i, m] = work.sensitivity[i, m]
        if not work.held[0] and _stopped(system, work, steps):
            return True
    return sum_stages(method, steps, x, dx, h, n)


@inlined
def _stopped(system: System, work: Work, steps: Steps) -> bool:
    """Return whether a friction that slipped when the step began no longer does."""
    for k in range(system.nd):
        if abs(steps.mode[k]) == 1 and work.mode[k] != steps.mode[k]:
            return True
    return False


@lean
def _copy(
    system: System, work: Work, steps: Steps, x: Array, dx: Array, n: int, back: bool
) -> None:
    """Remember where the step begins, or go back there."""
    for i in range(system.nx):
        if back:
            x[i] = steps.x[i]
        else:
            steps.x[i] = x[i]
        for m in range(n):
            if back:
                dx[i, m] = steps.dx[i, m]
            else:
                steps.dx[i, m] = dx[i, m]
    for i in range(system.nx + system.nz):
        if back:
            work.w[i] = steps.w[i]
        else:
            steps.w[i] = work.w[i]
    for k in range(system.nd):
        if back:
            work.mode[k] = steps.mode[k]
        else:
            steps.mode[k] = work.mode[k]


@inlined
def _margin(system: System, work: Work, steps: Steps) -> tuple[float, int]:
    """Return how far the slipping friction next to its stop is from it, and which."""
    least, which = math.inf, 0
    for k in range(system.nd):
        if abs(steps.mode[k]) == 1:
            margin = steps.mode[k] * work.argument[k]
            if margin < least:
                least, which = margin, k
    return least, which


@lean
def _held(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    drive: Drive, elapsed: float, h: float, n: int,
) -> bool:  # fmt: skip
    """Take a step from the remembered start with the modes it began with."""
    work.held[0] = True
    _copy(system, work, steps, x, dx, n, work.held[0])
    done = _step(system, work, method, steps, x, dx, drive, elapsed, h, n)
    work.held[0] = False
    return done


@lean
def _locate(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    drive: Drive, elapsed: float, h: float, start: float,
) -> tuple[float, int]:  # fmt: skip
    """Return the share of the step after which a friction stops, and which.

    The share is 1 where none does, and -1 where a step fails. Regula falsi, the
    end that stays counted half (Illinois).
    """
    none = 0 * system.nx  # not a literal, for which numba would compile once more
    low, high, first, last, side = start, 0.0, 0.0, 1.0, 0
    share, which, scale = 1.0, 0, 0.0
    for _ in range(SEARCH):
        if not _held(
            system, work, method, steps, x, dx, drive, elapsed, share * h, none
        ):
            return -1.0, 0
        margin, which = _margin(system, work, steps)
        if share == 1.0:
            scale = max(low, -margin)
            if margin >= 0.0:
                return 1.0, which
            if low <= 0.0:
                return 0.0, which
        if abs(margin) <= NARROW * scale or last - first < CLOSE:
            break
        if margin < 0.0:
            last, high = share, margin
            low *= 0.5 if side == -1 else 1.0
            side = -1
        else:
            first, low = share, margin
            high *= 0.5 if side == 1 else 1.0
            side = 1
        share = (first * high - last * low) / (high - low)
    return share, which


@lean
def _move_of_event(
    system: System, work: Work, steps: Steps, dx: Array, slot: int, speed: float, n: int
) -> None:
    """Write by how much an event comes later, along each direction."""
    for m in range(n):
        for i in range(system.nx):
            work.dq[i, m] = dx[i, m]
        for i in range(system.nx + system.nz):
            work.dq[system.nx + i, m] = work.sensitivity[i, m]
    if n > 0:
        run(system.dynamics, system.first, work.v, work.dq, n)
    for m in range(n):
        steps.moved[m] = -work.dq[slot, m] / speed if speed != 0.0 else 0.0


@lean
def _jump(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    drive: Drive, elapsed: float, h: float, n: int, which: int,
) -> bool:  # fmt: skip
    """Step to the event, let the friction decide, and jump the sensitivities."""
    slot = system.residual[system.nz - system.nd + which]
    speed = 0.0
    for attempt in range(0 if n > 0 else 2, 3):
        side = 0.0 if attempt == 2 else 1.0 - 2.0 * attempt  # later, earlier, there
        along = n if attempt == 2 else 0
        part = h * (1.0 + NEAR * side)
        if not _held(system, work, method, steps, x, dx, drive, elapsed, part, along):
            return False
        speed += side * work.argument[which] / (2.0 * NEAR * h)
    _move_of_event(system, work, steps, dx, slot, speed, n)
    work.mode[which] = STICKS
    set_inputs(system, work.v, drive, elapsed + h)
    if not solve_stage(system, work, x, GLANCE * h):
        return False
    for i in range(system.nx):
        for m in range(n):
            dx[i, m] += (steps.k[len(method.c) - 1, i] - work.w[i]) * steps.moved[m]
    return True


@lean
def _to_event(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    drive: Drive, elapsed: float, h: float, n: int, start: float,
) -> float:  # fmt: skip
    """Step to where a friction stops; return the share of the step, or -1."""
    share, which = _locate(system, work, method, steps, x, dx, drive, elapsed, h, start)
    if share < 0.0:
        return share
    if share == 0.0:
        work.held[0] = True
        _copy(system, work, steps, x, dx, n, work.held[0])
        work.held[0] = False
        work.mode[which] = STICKS
    elif not _jump(
        system, work, method, steps, x, dx, drive, elapsed, share * h, n, which
    ):
        return -1.0
    if work.mode[which] != steps.mode[which]:
        steps.since[which] = drive.time + elapsed + share * h
    return share


@lean
def advance(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    drive: Drive, elapsed: float, h: float, n: int,
) -> bool:  # fmt: skip
    """Take one step of size `h` in place, split where frictions stop.

    Where frictions are and a step finds no solution, it is taken in halves.
    """
    whole, events, part = h, 0, h
    while h > GLANCE * whole or events == 0:
        part = min(part, h)
        start = 0.0
        if system.nd > 0:
            _copy(system, work, steps, x, dx, n, work.held[0])
            start, _ = _margin(system, work, steps)
            if events >= EVENTS:  # too many: the rest of the step as it comes
                for k in range(system.nd):
                    steps.mode[k] = STICKS
        share = 1.0
        found = _step(system, work, method, steps, x, dx, drive, elapsed, part, n)
        if found and _stopped(system, work, steps):
            share = _to_event(
                system, work, method, steps, x, dx, drive, elapsed, part, n, start
            )
            found = share >= 0.0
            events += 1
        if not found:
            if system.nd == 0 or part < SHORTEST * whole:
                return False
            work.held[0] = True
            _copy(system, work, steps, x, dx, n, work.held[0])
            work.held[0] = False
            part *= 0.5
            continue
        elapsed += share * part
        h -= share * part
        events = max(events, 1)
    return True
