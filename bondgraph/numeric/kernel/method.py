"""A diagonally implicit Runge-Kutta method: what it works on, and its sums."""

import math
from typing import NamedTuple

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, compiled, inlined
from bondgraph.numeric.kernel.stage_arrays import System


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
