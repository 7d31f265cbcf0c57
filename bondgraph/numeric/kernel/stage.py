"""One implicit stage: solve r(w) = 0 for w = (ẋ, z) with x = base + h ẋ, compiled.

Newton with the exact Jacobian; a step is halved when the next one, taken with the same
Jacobian, would not be shorter (the affine-invariant test of Deuflhard, *Newton Methods
for Nonlinear Problems*, 2004, section 3.1), which is what sharp friction needs.

Set-valued friction adds unknowns λ to z, each with an equation that its mode chooses
(`bondgraph.numeric.kernel.friction_modes`); Newton with a change of modes between its
steps is a semi-smooth Newton method, and for a linear model it ends after finitely
many.
"""

import math

from bondgraph.numeric.compiled.linear_solve import factor, substitute
from bondgraph.numeric.compiled.loops import Array, inlined, lean
from bondgraph.numeric.compiled.newton import (
    NUDGE,
    ROUNDING,
    SMALLEST_DAMPING,
    TOLERANCE,
)
from bondgraph.numeric.kernel.friction_modes import (
    begin,
    predict_arguments,
    put_friction_residual,
    put_friction_rows,
    release,
    several_stick,
    switch_modes,
)
from bondgraph.numeric.kernel.machine import run
from bondgraph.numeric.kernel.stage_arrays import STICKS, System, Work

ITERATIONS = 100  # damped, over sharp corners, many are needed
PATIENCE = 12  # changes of friction modes before only one changes at a time

SINGULAR, NOT_FINITE, NO_END = 1, 2, 3  # what `Work.trouble` says


@inlined
def _place(system: System, work: Work, base: Array, h: float) -> None:
    """Write x = base + h ẋ, ẋ and z into the tape's variables."""
    for i in range(system.nx):
        work.v[i] = base[i] + h * work.w[i]
    for i in range(system.nx + system.nz):
        work.v[system.nx + i] = work.w[i]


@inlined
def _residual(system: System, work: Work, h: float) -> None:
    for i in range(system.nx):
        work.rhs[i, 0] = work.w[i] - work.v[system.rate[i]]
    for i in range(system.nz - system.nd):
        work.rhs[system.nx + i, 0] = work.v[system.residual[i]]
    put_friction_residual(system, work, h)


@inlined
def _factor_jacobian(system: System, work: Work, h: float) -> bool:
    nx, nw = system.nx, system.nx + system.nz
    for j in range(nw):
        for i in range(nx):
            work.lu[i, j] = -work.d[system.rate[i], j]
        for i in range(system.nz - system.nd):
            work.lu[nx + i, j] = work.d[system.residual[i], j]
    for i in range(nx):
        work.lu[i, i] += 1.0
    put_friction_rows(system, work, h)
    return factor(work.lu, nw, work.pivot)


@inlined
def _size(work: Work, nw: int) -> float:
    """Return the largest relative change in ``rhs``; NaN counts as infinite."""
    size = 0.0
    for i in range(nw):
        if not math.isfinite(work.rhs[i, 0]):
            return math.inf
        size = max(size, abs(work.rhs[i, 0]) / work.weight[i])
    return size


@inlined
def _seed(system: System, work: Work, h: float) -> None:
    """Set the tangents of the variables along w."""
    nx, nw = system.nx, system.nx + system.nz
    for j in range(nw):
        for i in range(nx + nw):
            work.d[i, j] = 0.0
        if j < nx:
            work.d[j, j] = h
        work.d[nx + j, j] = 1.0


@lean
def _worst(work: Work, nw: int) -> int:
    """Return the unknown with the largest relative change; NaN counts most."""
    worst, size = 0, -1.0
    for i in range(nw):
        change = abs(work.step[i]) / work.weight[i]
        if not math.isfinite(change):
            return i
        if change > size:
            worst, size = i, change
    return worst


@lean
def solve_stage(system: System, work: Work, base: Array, h: float) -> bool:
    """Solve for ``work.w``; return whether Newton converged.

    On return the tape variables hold the solution and ``work.lu`` the factored dr/dw.
    Modes of dry friction (which need h > 0) stay as they are where ``work.held``.
    """
    nw = system.nx + system.nz
    damping, last, changes = 1.0, math.inf, 0
    work.trouble[0] = NO_END
    _seed(system, work, h)
    for iteration in range(ITERATIONS * (1 + system.nd)):
        _place(system, work, base, h)
        run(system.dynamics, system.first, work.v, work.d, nw)
        if iteration == 0 and begin(system, work):
            _place(system, work, base, h)
            run(system.dynamics, system.first, work.v, work.d, nw)
        _residual(system, work, h)
        if last < math.inf and not system.linear:
            substitute(work.lu, nw, work.pivot, work.rhs, 1)
            shorter = _size(work, nw) <= (1.0 - 0.25 * damping) * last
            if not shorter and damping > SMALLEST_DAMPING:
                damping *= 0.5
                for i in range(nw):
                    work.w[i] += damping * work.step[i]
                continue
            _residual(system, work, h)
        if not _factor_jacobian(system, work, h):
            flat = iteration == 0 and not system.linear
            if flat:  # look a little further
                for i in range(nw):
                    work.w[i] += NUDGE * (1.0 + i)
            if flat or release(system, work):
                last = math.inf
                continue
            work.trouble[0] = SINGULAR
            break
        substitute(work.lu, nw, work.pivot, work.rhs, 1)
        for i in range(nw):
            work.step[i] = work.rhs[i, 0]
            work.weight[i] = max(work.weight[i], abs(work.w[i]))
        before, last = last, _size(work, nw)
        if last == math.inf:
            work.trouble[0] = NOT_FINITE
            break
        damping = min(1.0, 2.0 * damping)
        for i in range(nw):
            work.w[i] -= damping * work.step[i]
        one_step = system.linear and not several_stick(system, work)
        if system.nd > 0:
            predict_arguments(system, work, damping)
            if not work.held[0] and switch_modes(system, work, h, changes >= PATIENCE):
                damping, last, changes = 1.0, math.inf, changes + 1
                continue
        # Small steps that no longer shrink are rounding.
        rounding = last <= ROUNDING and last >= 0.5 * before
        if one_step or ((last <= TOLERANCE or rounding) and damping == 1.0):
            _place(system, work, base, h)
            return True
    work.trouble[1] = _worst(work, nw)
    return False


@lean
def stage_sensitivity(
    system: System, work: Work, dbase: Array, h: float, n: int
) -> None:
    """Write dw along the `n` directions, given those of x without its h ẋ part.

    Implicit function theorem: (dr/dw) dw = -(dr at fixed w).
    """
    nx, nw = system.nx, system.nx + system.nz
    for m in range(n):
        for i in range(nx):
            work.dq[i, m] = dbase[i, m]
        for i in range(nw):
            work.dq[nx + i, m] = 0.0
    run(system.dynamics, system.first, work.v, work.dq, n)
    for m in range(n):
        for i in range(nx):
            work.sensitivity[i, m] = work.dq[system.rate[i], m]
        for i in range(system.nz - system.nd):
            work.sensitivity[nx + i, m] = -work.dq[system.residual[i], m]
        for i in range(system.nz - system.nd, system.nz):
            sticks = work.mode[i - system.nz + system.nd] == STICKS
            work.sensitivity[nx + i, m] = (
                -work.dq[system.residual[i], m] / h if sticks else 0.0
            )
    substitute(work.lu, nw, work.pivot, work.sensitivity, n)
