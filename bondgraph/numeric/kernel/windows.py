"""Time stepping, compiled: a diagonally implicit Runge-Kutta method over one window.

The method is stiffly accurate; its sensitivities are those of the discrete solution, so
they are exact to rounding whatever the step. Inputs are held or joined by straight
lines between samples.
"""

from typing import NamedTuple

import numpy as np

from bondgraph.numeric.compiled.loops import (
    Array,
    Integers,
    compiled,
    inlined,
    lean,
    only_there,
)
from bondgraph.numeric.compiled.newton import GLANCE
from bondgraph.numeric.kernel.machine import run
from bondgraph.numeric.kernel.method import Drive, Method, Steps, make_steps, set_inputs
from bondgraph.numeric.kernel.native_steps import (
    Fast,
    hand_over,
    make_fast_work,
    try_read,
    try_step,
)
from bondgraph.numeric.kernel.stage import solve_stage, stage_sensitivity
from bondgraph.numeric.kernel.stage_arrays import System, Work, make_work
from bondgraph.numeric.kernel.stepping import advance


class Results(NamedTuple):
    """Arrays to fill: outputs (n, ny), their sensitivities, states (n, nx).

    Sensitivities (n, ny, nq + nx) are left out where the array has no rows. ``modes``
    and ``since`` (n, nd): the mode of each dry friction, and when it took it.
    """

    outputs: Array
    sensitivities: Array
    states: Array
    modes: Integers
    since: Array


@lean
def _read_outputs(
    system: System, work: Work, x: Array, dx: Array, glance: float, row: int,
    results: Results, n: int,
) -> bool:  # fmt: skip
    """Write outputs (and sensitivities) of one sample; False where w is not found.

    What a friction holds shows only over a time; `glance` is that time.
    """
    nx, nw = system.nx, system.nx + system.nz
    solved = system.instantaneous and nw > 0
    if solved:
        if not solve_stage(system, work, x, glance):
            return False
        stage_sensitivity(system, work, dx, glance, n)
    for i in range(nx):
        work.vo[i] = x[i]
        results.states[row, i] = x[i]
    for i in range(nw):
        work.vo[nx + i] = work.w[i]
    for m in range(n):
        for i in range(nx):
            work.dqo[i, m] = dx[i, m]
        for i in range(nw):
            work.dqo[nx + i, m] = work.sensitivity[i, m] if solved else 0.0
    run(system.output, system.first_output, work.vo, work.dqo, n)
    for j in range(len(system.read)):
        results.outputs[row, j] = work.vo[system.read[j]]
        for m in range(n):
            results.sensitivities[row, j, m] = work.dqo[system.read[j], m]
    return True


@inlined
def _note_modes(
    work: Work, steps: Steps, row: int, now: float, results: Results
) -> None:
    """Write the modes of the frictions, and when they took them."""
    for k in range(len(work.mode)):
        last = results.modes[row - 1, k] if row > 0 else work.mode[k]
        if row > 0 and steps.since[k] <= results.since[row - 1, k]:
            changed = work.mode[k] != last
            steps.since[k] = now if changed else results.since[row - 1, k]
        results.modes[row, k] = work.mode[k]
        results.since[row, k] = steps.since[k]


@lean
def _put(v: Array, at: int, values: Array) -> None:
    """Write `values` at ``v[at:]``; slices would take seconds to compile."""
    for i in range(len(values)):
        v[at + i] = values[i]


@only_there
def integrate(
    system: System, fast: Fast, method: Method, constants: Array,
    output_constants: Array, parameters: Array, directions: Integers, time: Array,
    u: Array, x0: Array,
    results: Results,
) -> tuple[int, int, int]:  # fmt: skip
    """Simulate one window; return how many samples were completed, and what failed.

    `directions` are the parameters whose sensitivities are wanted; those of the initial
    state follow them where the results have columns for them.
    """
    nx, nq = system.nx, len(directions)
    n = results.sensitivities.shape[2] if len(results.sensitivities) else 0
    work = make_work(system, n)
    steps = make_steps(system, len(method.c), n)
    there = make_fast_work(fast, parameters, n)
    at = 2 * nx + system.nz + 2 * system.nu
    _put(work.v, system.first - len(constants), constants)
    _put(work.vo, system.first_output - len(output_constants), output_constants)
    _put(work.v, at, parameters)
    _put(work.vo, at, parameters)
    x, dx = x0.copy(), np.zeros((nx, max(n, 1)))
    for k in range(min(nq, n)):
        work.dq[at + directions[k], k] = 1.0
        work.dqo[at + directions[k], k] = 1.0
    for i in range(nx if n > nq else 0):
        dx[i, nq + i] = 1.0
    slope = np.zeros(system.nu)
    glance = 0.0
    for row in range(len(time)):
        following = min(row + 1, len(time) - 1)
        span = time[following] - time[row]
        if not method.zero_hold and span > 0.0:
            for i in range(system.nu):
                slope[i] = (u[following, i] - u[row, i]) / span
        if system.nd > 0:
            glance = GLANCE * span if span > 0.0 else max(glance, GLANCE)
        drive = Drive(u[row], slope, time[row])
        set_inputs(system, work.v, drive, 0.0)
        set_inputs(system, work.vo, drive, 0.0)
        if fast.there:
            set_inputs(system, there.stage.v, drive, 0.0)
        unjudged = system.nd > 0 and row == 0
        if unjudged and not solve_stage(system, work, x, glance):
            return row, work.trouble[0], work.trouble[1]
        read = False
        if fast.there and not unjudged:
            read = try_read(
                system, work, fast, there, x, dx, glance, directions, n,
                results.outputs, results.sensitivities, row,
            )  # fmt: skip
            for i in range(nx):
                results.states[row, i] = x[i]
        if not read:
            if not _read_outputs(system, work, x, dx, glance, row, results, n):
                return row, work.trouble[0], work.trouble[1]
            if fast.there:
                hand_over(system, work, there.stage)
        _note_modes(work, steps, row, time[row], results)
        h = span / method.substeps
        for step in range(method.substeps if row < following and nx > 0 else 0):
            if fast.there and try_step(
                system, work, fast, there.stage, method, steps, x, dx, drive,
                step * h, h, directions, n,
            ):  # fmt: skip
                continue
            if not advance(system, work, method, steps, x, dx, drive, step * h, h, n):
                return row, work.trouble[0], work.trouble[1]
            if fast.there:
                hand_over(system, work, there.stage)
    return len(time), 0, 0


@compiled
def integrate_windows(
    system: System, fast: Fast, method: Method, constants: Array,
    output_constants: Array, parameters: Array, directions: Integers, time: Array,
    u: Array, x0: Array,
    results: Results, edges: Integers, first: int, last: int, done: Integers,
    trouble: Integers,
) -> None:  # fmt: skip
    """Simulate the windows ``first … last - 1``, each from its row of `x0`."""
    for window in range(first, last):
        a, b = edges[window], edges[window + 1]
        some = b if len(results.sensitivities) else 0
        part = Results(
            results.outputs[a:b],
            results.sensitivities[min(a, some) : some],
            results.states[a:b],
            results.modes[a:b],
            results.since[a:b],
        )
        done[window], trouble[window, 0], trouble[window, 1] = integrate(
            system, fast, method, constants, output_constants, parameters, directions,
            time[a:b], u[a:b], x0[window], part,
        )  # fmt: skip
