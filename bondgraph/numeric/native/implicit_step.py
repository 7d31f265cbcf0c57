"""One step of a diagonally implicit Runge-Kutta method in native code.

As on the tape (`bondgraph.numeric.kernel.stepping`) it is taken in halves where it has
no solution: sharp corners and steep slopes that one step would jump over are met one by
one.
"""

import math
from typing import NamedTuple

from bondgraph.numeric.compiled.loops import Array, Integers, inlined, only_there
from bondgraph.numeric.compiled.newton import GLANCE, SHORTEST
from bondgraph.numeric.native.model import NativeSystem
from bondgraph.numeric.native.stage import Stage, differentiate, solve


class Tableau(NamedTuple):
    """A method's matrix (last row = weights) and nodes, and steps per sample."""

    a: Array
    c: Array
    substeps: int
    zero_hold: bool


class Path(NamedTuple):
    """Where the step is: state, stage base point, slopes, and their tangents.

    ``w`` are the unknowns of its first stage before it is solved.
    """

    x: Array
    dx: Array
    base: Array
    dbase: Array
    k: Array
    dk: Array
    w: Array
    slope: Array


@inlined
def set_inputs(
    system: NativeSystem, v: Array, u: Array, row: int, slope: Array, time: float,
    elapsed: float,
) -> None:  # fmt: skip
    """Write u and t at `elapsed` seconds after a sample."""
    at = 2 * system.nx + system.nz
    for i in range(system.nu):
        v[at + i] = u[row, i] + slope[i] * elapsed
    v[system.n_variables - 1] = time + elapsed


@only_there
def cross(
    system: NativeSystem, method: Tableau, stage: Stage, path: Path,
    directions: Integers, n: int, u: Array, row: int, time: float, elapsed: float,
    h: float,
) -> bool:  # fmt: skip
    """Take a step of size `h`, in halves where need be; False where that fails."""
    left, part, nw = h, h, system.nx + system.nz
    while left > GLANCE * h:
        part = min(part, left)
        for i in range(nw):
            path.w[i] = stage.w[i]
        if _advance(
            system, method, stage, path, directions, n, u, row, time, elapsed, part
        ):
            elapsed += part
            left -= part
            continue
        if part < SHORTEST * h:
            return False
        part *= 0.5
        for i in range(nw):
            stage.w[i] = path.w[i]
    return True


@only_there
def _advance(  # noqa: C901, PLR0912  (a compiled loop)
    system: NativeSystem, method: Tableau, stage: Stage, path: Path,
    directions: Integers, n: int, u: Array, row: int, time: float, elapsed: float,
    h: float,
) -> bool:  # fmt: skip
    """Take one step of size `h`; False where it fails, nothing of `path.x` moved."""
    nx, a, stages = system.nx, method.a, len(method.c)
    for s in range(stages):
        at = elapsed + method.c[s] * h
        set_inputs(system, stage.v, u, row, path.slope, time, at)
        for i in range(nx):
            path.base[i] = path.x[i]
            for r in range(s):
                path.base[i] += h * a[s, r] * path.k[r, i]
        part = h * a[s, s]
        if not solve(system, stage, path.base, part):
            return False
        for i in range(nx):
            path.k[s, i] = stage.w[i]
        if n > 0:
            for i in range(nx):
                for m in range(n):
                    path.dbase[i, m] = path.dx[i, m]
                for r in range(s):
                    weight = h * a[s, r]
                    for m in range(n):
                        path.dbase[i, m] += weight * path.dk[r, i, m]
            if not differentiate(system, stage, path.dbase, part, directions, n):
                return False
            for i in range(nx):
                for m in range(n):
                    path.dk[s, i, m] = stage.dw[i, m]
    for i in range(nx):
        path.base[i] = path.x[i]
        for s in range(stages):
            path.base[i] += h * a[stages - 1, s] * path.k[s, i]
        if not math.isfinite(path.base[i]):
            return False
    for i in range(nx):
        path.x[i] = path.base[i]
        for s in range(stages):
            weight = h * a[stages - 1, s]
            for m in range(n):
                path.dx[i, m] += weight * path.dk[s, i, m]
    return True
