"""Where within a step a slipping friction stops, and what follows from that.

With the modes held, the part of the step after which the argument vanishes is searched.
The time of the event depends on the parameters, so the sensitivities jump there by
``(ẋ⁻ - ẋ⁺) dt`` (the saltation of Aizerman and Gantmacher, Q. J. Mech. Appl. Math. 11,
1958).
"""

import math

from bondgraph.numeric.compiled.loops import Array, inlined, lean, only_there
from bondgraph.numeric.compiled.newton import GLANCE
from bondgraph.numeric.kernel.machine import run
from bondgraph.numeric.kernel.method import Drive, Method, Steps, set_inputs
from bondgraph.numeric.kernel.stage import solve_stage
from bondgraph.numeric.kernel.stage_arrays import STICKS, System, Work
from bondgraph.numeric.kernel.steps import copy_start, step_held

SEARCH = 40
CLOSE = 1e-10  # of a step, to which an event is located,
NARROW = 1e-12  # or of the argument's size in it, within which it vanishes
NEAR = 1e-5  # of the way to an event, to see how fast it comes


@inlined
def margin_left(system: System, work: Work, steps: Steps) -> tuple[float, int]:
    """Return how far the slipping friction next to its stop is from it, and which."""
    least, which = math.inf, 0
    for k in range(system.nd):
        if abs(steps.mode[k]) == 1:
            margin = steps.mode[k] * work.argument[k]
            if margin < least:
                least, which = margin, k
    return least, which


@only_there
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
        if not step_held(
            system, work, method, steps, x, dx, drive, elapsed, share * h, none
        ):
            return -1.0, 0
        margin, which = margin_left(system, work, steps)
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


@only_there
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
        if not step_held(
            system, work, method, steps, x, dx, drive, elapsed, part, along
        ):
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


@only_there
def step_to_event(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    drive: Drive, elapsed: float, h: float, n: int, start: float,
) -> float:  # fmt: skip
    """Step to where a friction stops; return the share of the step, or -1."""
    share, which = _locate(system, work, method, steps, x, dx, drive, elapsed, h, start)
    if share < 0.0:
        return share
    if share == 0.0:
        work.held[0] = True
        copy_start(system, work, steps, x, dx, n, work.held[0])
        work.held[0] = False
        work.mode[which] = STICKS
    elif not _jump(
        system, work, method, steps, x, dx, drive, elapsed, share * h, n, which
    ):
        return -1.0
    if work.mode[which] != steps.mode[which]:
        steps.since[which] = drive.time + elapsed + share * h
    return share
