"""Time stepping, compiled: a diagonally implicit Runge-Kutta method over one window.

The method is stiffly accurate; its sensitivities are those of the discrete solution, so
they are exact to rounding whatever the step. Inputs are held or joined by straight
lines between samples.
"""

import math
from typing import NamedTuple

import numpy as np

from bondgraph.numeric.machine import Array, Integers, compiled, run
from bondgraph.numeric.stage import (
    System,
    Work,
    make_work,
    solve_stage,
    stage_sensitivity,
)


class Method(NamedTuple):
    """A Runge-Kutta method: matrix (last row = weights), nodes, steps per sample."""

    a: Array
    c: Array
    substeps: int
    zero_hold: bool


class Results(NamedTuple):
    """Arrays to fill: outputs (n, ny), their sensitivities, states (n, nx).

    Sensitivities (n, ny, nq + nx) are left out where the array has no rows.
    """

    outputs: Array
    sensitivities: Array
    states: Array


class Steps(NamedTuple):
    """Scratch of the time stepping: stage base point, slopes, and their tangents."""

    base: Array
    dbase: Array
    k: Array
    dk: Array


@compiled
def _set_inputs(
    system: System, v: Array, u: Array, slope: Array, time: float, elapsed: float
) -> None:
    """Write u, u̇ and t at `elapsed` seconds after a sample at `time`."""
    at = 2 * system.nx + system.nz
    for i in range(system.nu):
        v[at + i] = u[i] + slope[i] * elapsed
        v[at + system.nu + i] = slope[i]
    v[at + 2 * system.nu + system.n_parameters] = time + elapsed


@compiled
def _read_outputs(
    system: System, work: Work, x: Array, dx: Array, row: int, results: Results, n: int
) -> bool:
    """Write outputs (and sensitivities) of one sample; False where w is not found."""
    nx, nw = system.nx, system.nx + system.nz
    solved = system.instantaneous and nw > 0
    if solved:
        if not solve_stage(system, work, x, 0.0):
            return False
        stage_sensitivity(system, work, dx, n)
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


@compiled
def _advance(
    system: System, work: Work, method: Method, steps: Steps, x: Array, dx: Array,
    u: Array, slope: Array, time: float, elapsed: float, h: float, n: int,
) -> bool:  # fmt: skip
    """Take one Runge-Kutta step of size `h` in place; False where it fails."""
    nx, stages = system.nx, len(method.c)
    for stage in range(stages):
        _set_inputs(system, work.v, u, slope, time, elapsed + method.c[stage] * h)
        for i in range(nx):
            steps.base[i] = x[i]
            for j in range(stage):
                steps.base[i] += h * method.a[stage, j] * steps.k[j, i]
        if not solve_stage(system, work, steps.base, h * method.a[stage, stage]):
            return False
        for i in range(nx):
            steps.k[stage, i] = work.w[i]
            for m in range(n):
                steps.dbase[i, m] = dx[i, m]
                for j in range(stage):
                    steps.dbase[i, m] += h * method.a[stage, j] * steps.dk[j, i, m]
        if n > 0:
            stage_sensitivity(system, work, steps.dbase, n)
            steps.dk[stage, :, :n] = work.sensitivity[:nx, :n]
    for i in range(nx):
        for j in range(stages):
            weight = h * method.a[stages - 1, j]
            x[i] += weight * steps.k[j, i]
            for m in range(n):
                dx[i, m] += weight * steps.dk[j, i, m]
        if not math.isfinite(x[i]):
            return False
    return True


@compiled
def integrate(
    system: System, method: Method, constants: Array, output_constants: Array,
    parameters: Array, directions: Integers, time: Array, u: Array, x0: Array,
    results: Results,
) -> int:  # fmt: skip
    """Simulate one window; return how many samples were completed.

    `directions` are the parameters whose sensitivities are wanted; those of the initial
    state follow them.
    """
    nx, nq = system.nx, len(directions)
    n = nq + nx if len(results.sensitivities) else 0
    slots = system.first + system.dynamics.shape[0]
    slots_output = system.first_output + system.output.shape[0]
    work = make_work(slots, slots_output, nx + system.nz, n)
    steps = Steps(
        np.zeros(nx),
        np.zeros((nx, max(n, 1))),
        np.zeros((len(method.c), nx)),
        np.zeros((len(method.c), nx, max(n, 1))),
    )
    at = 2 * nx + system.nz + 2 * system.nu
    work.v[system.first - len(constants) : system.first] = constants
    work.vo[system.first_output - len(output_constants) : system.first_output] = (
        output_constants
    )
    work.v[at : at + len(parameters)] = parameters
    work.vo[at : at + len(parameters)] = parameters
    x, dx = x0.copy(), np.zeros((nx, max(n, 1)))
    for k in range(min(nq, n)):
        work.dq[at + directions[k], k] = 1.0
        work.dqo[at + directions[k], k] = 1.0
    for i in range(nx if n > 0 else 0):
        dx[i, nq + i] = 1.0
    slope = np.zeros(system.nu)
    for row in range(len(time)):
        following = min(row + 1, len(time) - 1)
        span = time[following] - time[row]
        if not method.zero_hold and span > 0.0:
            slope[:] = (u[following] - u[row]) / span
        _set_inputs(system, work.v, u[row], slope, time[row], 0.0)
        _set_inputs(system, work.vo, u[row], slope, time[row], 0.0)
        if not _read_outputs(system, work, x, dx, row, results, n):
            return row
        h = span / method.substeps
        for step in range(method.substeps if row < following and nx > 0 else 0):
            if not _advance(
                system, work, method, steps, x, dx,
                u[row], slope, time[row], step * h, h, n,
            ):  # fmt: skip
                return row
    return len(time)


@compiled
def integrate_windows(
    system: System, method: Method, constants: Array, output_constants: Array,
    parameters: Array, directions: Integers, time: Array, u: Array, x0: Array,
    results: Results, edges: Integers, first: int, last: int, done: Integers,
) -> None:  # fmt: skip
    """Simulate the windows ``first … last - 1``, each from its row of `x0`."""
    for window in range(first, last):
        a, b = edges[window], edges[window + 1]
        some = b if len(results.sensitivities) else 0
        part = Results(
            results.outputs[a:b],
            results.sensitivities[min(a, some) : some],
            results.states[a:b],
        )
        done[window] = integrate(
            system, method, constants, output_constants, parameters, directions,
            time[a:b], u[a:b], x0[window], part,
        )  # fmt: skip


@compiled
def normal_blocks(
    jacobian: Array, residual: Array, edges: Integers, h: Array, g: Array, cost: Array
) -> None:
    """Write JᵀJ, Jᵀr and rᵀr of every window; J is (n, ny, nd), r is (n, ny)."""
    ny, nd = jacobian.shape[1], jacobian.shape[2]
    for window in range(len(edges) - 1):
        for row in range(edges[window], edges[window + 1]):
            for j in range(ny):
                r = residual[row, j]
                cost[window] += r * r
                for k in range(nd):
                    slope = jacobian[row, j, k]
                    g[window, k] += slope * r
                    for m in range(k + 1):
                        h[window, k, m] += slope * jacobian[row, j, m]
        for k in range(nd):
            for m in range(k):
                h[window, m, k] = h[window, k, m]
