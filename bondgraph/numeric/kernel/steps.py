"""One Runge-Kutta step on the tape, with friction modes free or held."""

from bondgraph.numeric.compiled.loops import Array, inlined, lean
from bondgraph.numeric.kernel.method import (
    Drive,
    Method,
    Steps,
    set_inputs,
    stage_base,
    sum_stages,
)
from bondgraph.numeric.kernel.stage import solve_stage, stage_sensitivity
from bondgraph.numeric.kernel.stage_arrays import System, Work


@lean
def take_step(
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
        if not work.held[0] and stopped(system, work, steps):
            return True
    return sum_stages(method, steps, x, dx, h, n)


@inlined
def stopped(system: System, work: Work, steps: Steps) -> bool:
    """Return whether a friction that slipped when the step began no longer does."""
    for k in range(system.nd):
        if abs(steps.mode[k]) == 1 and work.mode[k] != steps.mode[k]:
            return True
    return False


@lean
def copy_start(
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


@lean
def step_held(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    drive: Drive, elapsed: float, h: float, n: int,
) -> bool:  # fmt: skip
    """Take a step from the remembered start with the modes it began with."""
    work.held[0] = True
    copy_start(system, work, steps, x, dx, n, work.held[0])
    done = take_step(system, work, method, steps, x, dx, drive, elapsed, h, n)
    work.held[0] = False
    return done
