"""One implicit stage in native code: r(w) = 0 for w = (ẋ, z) with x = base + h ẋ.

First the factors of an earlier stage are used as they are; while that contracts well,
an iteration costs one evaluation. Where it does not, Newton starts again from the same
point with exact Jacobians and the damping of `bondgraph.numeric.kernel.stage`.
"""

import math
from typing import NamedTuple

import numpy as np

from bondgraph.numeric.compiled.linear_solve import factor, substitute
from bondgraph.numeric.compiled.loops import Array, Integers, compiled, inlined
from bondgraph.numeric.compiled.newton import (
    NUDGE,
    ROUNDING,
    SMALLEST_DAMPING,
    TOLERANCE,
)
from bondgraph.numeric.native.calls import call_slopes, call_values
from bondgraph.numeric.native.model import NativeSystem

ITERATIONS = 40
CHORDS = 6
CONTRACTION = 0.25
CHORD_ERROR = 1e-12


class Stage(NamedTuple):
    """Scratch of one simulation.

    ``v`` variables and results; ``j`` their slopes; ``lu``, ``pivot`` the factored
    dr/dw, for the step ``factored[0]`` (NaN: none); ``w`` the unknowns, ``weight``
    their sizes; ``dw`` their tangents.
    """

    v: Array
    j: Array
    lu: Array
    pivot: Integers
    factored: Array
    rhs: Array
    w: Array
    start: Array
    step: Array
    weight: Array
    dw: Array


@compiled
def make_stage(system: NativeSystem, v: Array, n: int) -> Stage:
    """Return scratch for `n` tangent directions."""
    nw = system.nx + system.nz
    return Stage(
        v=v,
        j=np.zeros(nw * system.n_columns + 1),
        lu=np.zeros((nw, nw)),
        pivot=np.zeros(nw, dtype=np.int64),
        factored=np.full(1, np.nan),
        rhs=np.zeros((nw, 1)),
        w=np.zeros(nw),
        start=np.zeros(nw),
        step=np.zeros(nw),
        weight=np.full(nw, 1e-12),
        dw=np.zeros((nw, max(n, 1))),
    )


@inlined
def _place(system: NativeSystem, stage: Stage, base: Array, h: float) -> None:
    """Write x = base + h ẋ, ẋ and z into the variables."""
    nx = system.nx
    for i in range(nx):
        stage.v[i] = base[i] + h * stage.w[i]
    for i in range(nx + system.nz):
        stage.v[nx + i] = stage.w[i]


@inlined
def _residual(system: NativeSystem, stage: Stage) -> None:
    results = system.n_variables
    for i in range(system.nx):
        stage.rhs[i, 0] = stage.w[i] - stage.v[results + i]
    for i in range(system.nx, system.nx + system.nz):
        stage.rhs[i, 0] = stage.v[results + i]


@inlined
def _factor(system: NativeSystem, stage: Stage, h: float) -> bool:
    """Factor dr/dw at the slopes in ``stage.j``."""
    nx, nw, nc = system.nx, system.nx + system.nz, system.n_columns
    for i in range(nw):
        sign = -1.0 if i < nx else 1.0
        for k in range(nw):
            slope = stage.j[i * nc + nx + k]
            if k < nx:
                slope += h * stage.j[i * nc + k]
            stage.lu[i, k] = sign * slope
        if i < nx:
            stage.lu[i, i] += 1.0
    regular = factor(stage.lu, nw, stage.pivot)
    stage.factored[0] = h if regular else math.nan
    return regular


@inlined
def _size(stage: Stage, nw: int) -> float:
    """Return the largest relative change in ``rhs``; NaN counts as infinite."""
    size = 0.0
    for i in range(nw):
        change = abs(stage.rhs[i, 0]) / stage.weight[i]
        if not change < math.inf:
            return math.inf
        size = max(size, change)
    return size


@inlined
def _weigh(stage: Stage, nw: int) -> None:
    for i in range(nw):
        stage.weight[i] = max(stage.weight[i], abs(stage.w[i]))


@inlined
def _chord(system: NativeSystem, stage: Stage, base: Array, h: float) -> bool:
    """Iterate with the factors at hand; False where that contracts too slowly."""
    nw = system.nx + system.nz
    last = math.inf
    for iteration in range(CHORDS):
        _place(system, stage, base, h)
        call_values(system.values, stage.v)
        _residual(system, stage)
        substitute(stage.lu, nw, stage.pivot, stage.rhs, 1)
        _weigh(stage, nw)
        size = _size(stage, nw)
        if size == math.inf or size > CONTRACTION * last:
            return False
        for i in range(nw):
            stage.w[i] -= stage.rhs[i, 0]
        rate = size / last
        if size <= CHORD_ERROR or (iteration > 0 and rate * size <= CHORD_ERROR):
            return True
        last = size
    return False


@inlined
def _newton(  # noqa: C901  (a compiled loop)
    system: NativeSystem, stage: Stage, base: Array, h: float
) -> bool:
    """Iterate with exact Jacobians, damped."""
    nw = system.nx + system.nz
    damping, last = 1.0, math.inf
    for iteration in range(ITERATIONS):
        _place(system, stage, base, h)
        call_slopes(system.slopes, stage.v, stage.j)
        _residual(system, stage)
        if last < math.inf and not system.linear:
            substitute(stage.lu, nw, stage.pivot, stage.rhs, 1)
            shorter = _size(stage, nw) <= (1.0 - 0.25 * damping) * last
            if not shorter and damping > SMALLEST_DAMPING:
                damping *= 0.5
                for i in range(nw):
                    stage.w[i] += damping * stage.step[i]
                continue
            _residual(system, stage)
        if not _factor(system, stage, h):
            if iteration > 0 or system.linear:
                return False
            for i in range(nw):  # Flat: look a little further.
                stage.w[i] += NUDGE * (1.0 + i)
            continue
        substitute(stage.lu, nw, stage.pivot, stage.rhs, 1)
        for i in range(nw):
            stage.step[i] = stage.rhs[i, 0]
        _weigh(stage, nw)
        before, last = last, _size(stage, nw)
        if last == math.inf:
            return False
        damping = min(1.0, 2.0 * damping)
        for i in range(nw):
            stage.w[i] -= damping * stage.step[i]
        # Small steps that no longer shrink are rounding.
        rounding = last <= ROUNDING and last >= 0.5 * before
        if system.linear or ((last <= TOLERANCE or rounding) and damping == 1.0):
            return True
    return False


@inlined
def solve(system: NativeSystem, stage: Stage, base: Array, h: float) -> bool:
    """Solve for ``stage.w``, from the value it has; False where Newton fails.

    On return the variables hold the solution.
    """
    nw = system.nx + system.nz
    found = False
    if stage.factored[0] == h and not system.linear:
        for i in range(nw):
            stage.start[i] = stage.w[i]
        found = _chord(system, stage, base, h)
        if not found:
            for i in range(nw):
                stage.w[i] = stage.start[i]
    if not found and not _newton(system, stage, base, h):
        stage.factored[0] = math.nan
        return False
    _place(system, stage, base, h)
    return True


@inlined
def differentiate(
    system: NativeSystem, stage: Stage, dbase: Array, h: float,
    directions: Integers, n: int,
) -> bool:  # fmt: skip
    """Write dw along `n` directions, given those of x without its h ẋ part.

    Implicit function theorem: (dr/dw) dw = -(dr at fixed w). False if singular.
    """
    nx, nw, nc = system.nx, system.nx + system.nz, system.n_columns
    call_slopes(system.slopes, stage.v, stage.j)
    if not _factor(system, stage, h):
        return False
    nq = min(len(directions), n)
    for i in range(nw):
        sign = 1.0 if i < nx else -1.0
        for m in range(n):
            stage.dw[i, m] = 0.0
        for k in range(nx):
            slope = sign * stage.j[i * nc + k]
            if slope != 0.0:
                for m in range(n):
                    stage.dw[i, m] += slope * dbase[k, m]
        for m in range(nq):
            stage.dw[i, m] += sign * stage.j[i * nc + nx + nw + directions[m]]
    substitute(stage.lu, nw, stage.pivot, stage.dw, n)
    return True
