"""One implicit stage: solve r(w) = 0 for w = (ẋ, z) with x = base + h ẋ, compiled.

Newton with the exact Jacobian; a step is halved when the next one, taken with the same
Jacobian, would not be shorter (the affine-invariant test of Deuflhard, *Newton Methods
for Nonlinear Problems*, 2004, section 3.1), which is what sharp friction needs.
"""

import math
from typing import NamedTuple

import numpy as np

from bondgraph.numeric.linear_solve import factor, substitute
from bondgraph.numeric.machine import Array, Integers, compiled, run

ITERATIONS = 40
TOLERANCE = 1e-7  # of the last Newton step; the error left is about its square
SMALLEST_DAMPING = 1e-4


class System(NamedTuple):
    """The model as the kernel sees it.

    ``rate``, ``residual`` and ``read`` are result slots; the variables of both tapes
    are x, ẋ, z, u, u̇, p, t. ``linear``: r is affine in (x, w). ``instantaneous``: an
    output depends on w, so w is solved for at every sample.
    """

    dynamics: Integers
    first: int
    rate: Integers
    residual: Integers
    output: Integers
    first_output: int
    read: Integers
    nx: int
    nz: int
    nu: int
    n_parameters: int
    linear: bool
    instantaneous: bool


class Work(NamedTuple):
    """Scratch arrays of one simulation.

    ``v``, ``vo`` values on the two tapes; ``d`` tangents along w; ``dq``, ``dqo``
    tangents along parameters and initial states; ``lu``, ``pivot`` the factored dr/dw;
    ``sensitivity`` dw along parameters and initial states; ``weight`` sizes of w.
    """

    v: Array
    vo: Array
    d: Array
    dq: Array
    dqo: Array
    lu: Array
    pivot: Integers
    rhs: Array
    sensitivity: Array
    weight: Array
    w: Array
    step: Array


@compiled
def make_work(slots: int, slots_output: int, nw: int, n: int) -> Work:
    """Return zeroed scratch for `n` tangent directions."""
    some, columns = max(nw, 1), max(n, 1)
    return Work(
        v=np.zeros(slots),
        vo=np.zeros(slots_output),
        d=np.zeros((slots, some)),
        dq=np.zeros((slots, columns)),
        dqo=np.zeros((slots_output, columns)),
        lu=np.zeros((nw, nw)),
        pivot=np.zeros(nw, dtype=np.int64),
        rhs=np.zeros((nw, 1)),
        sensitivity=np.zeros((nw, columns)),
        weight=np.full(nw, 1e-12),
        w=np.zeros(nw),
        step=np.zeros(nw),
    )


@compiled
def _place(system: System, work: Work, base: Array, h: float) -> None:
    """Write x = base + h ẋ, ẋ and z into the tape's variables."""
    for i in range(system.nx):
        work.v[i] = base[i] + h * work.w[i]
    for i in range(system.nx + system.nz):
        work.v[system.nx + i] = work.w[i]


@compiled
def _residual(system: System, work: Work) -> None:
    for i in range(system.nx):
        work.rhs[i, 0] = work.w[i] - work.v[system.rate[i]]
    for i in range(system.nz):
        work.rhs[system.nx + i, 0] = work.v[system.residual[i]]


@compiled
def _factor_jacobian(system: System, work: Work) -> bool:
    nx, nw = system.nx, system.nx + system.nz
    for j in range(nw):
        for i in range(nx):
            work.lu[i, j] = -work.d[system.rate[i], j]
        for i in range(system.nz):
            work.lu[nx + i, j] = work.d[system.residual[i], j]
    for i in range(nx):
        work.lu[i, i] += 1.0
    return factor(work.lu, nw, work.pivot)


@compiled
def _size(work: Work, nw: int) -> float:
    """Return the largest relative change in ``rhs``; NaN counts as infinite."""
    size = 0.0
    for i in range(nw):
        if not math.isfinite(work.rhs[i, 0]):
            return math.inf
        size = max(size, abs(work.rhs[i, 0]) / work.weight[i])
    return size


@compiled
def _seed(system: System, work: Work, h: float) -> None:
    """Set the tangents of the variables along w."""
    nx, nw = system.nx, system.nx + system.nz
    for j in range(nw):
        for i in range(nx + nw):
            work.d[i, j] = 0.0
        if j < nx:
            work.d[j, j] = h
        work.d[nx + j, j] = 1.0


@compiled
def solve_stage(system: System, work: Work, base: Array, h: float) -> bool:
    """Solve for ``work.w``; return whether Newton converged.

    On return the tape variables hold the solution and ``work.lu`` the factored dr/dw.
    """
    nw = system.nx + system.nz
    damping, last = 1.0, math.inf
    _seed(system, work, h)
    for iteration in range(ITERATIONS):
        _place(system, work, base, h)
        run(system.dynamics, system.first, work.v, work.d, nw)
        _residual(system, work)
        if iteration > 0 and not system.linear:
            substitute(work.lu, nw, work.pivot, work.rhs, 1)
            shorter = _size(work, nw) <= (1.0 - 0.25 * damping) * last
            if not shorter and damping > SMALLEST_DAMPING:
                damping *= 0.5
                for i in range(nw):
                    work.w[i] += damping * work.step[i]
                continue
            _residual(system, work)
        if not _factor_jacobian(system, work):
            return False
        substitute(work.lu, nw, work.pivot, work.rhs, 1)
        for i in range(nw):
            work.step[i] = work.rhs[i, 0]
            work.weight[i] = max(work.weight[i], abs(work.w[i]))
        last = _size(work, nw)
        if last == math.inf:
            return False
        damping = min(1.0, 2.0 * damping)
        for i in range(nw):
            work.w[i] -= damping * work.step[i]
        if system.linear or (last <= TOLERANCE and damping == 1.0):
            _place(system, work, base, h)
            return True
    return False


@compiled
def stage_sensitivity(system: System, work: Work, dbase: Array, n: int) -> None:
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
        for i in range(system.nz):
            work.sensitivity[nx + i, m] = -work.dq[system.residual[i], m]
    substitute(work.lu, nw, work.pivot, work.sensitivity, n)
