"""Modes of set-valued friction within a stage, compiled: which of its equations holds.

A friction slips (λ = ±1 is given) or sticks (its argument g vanishes and λ is found).
After every Newton step the modes are judged: slipping ends when g turns round, and
then ``λ + g / s`` with s = -dg/dλ says whether it sticks or slips back; sticking ends
when |λ| passes 1. With one friction this finds the solution of a linear stage in two
solutions, and with several it is the primal-dual active set method (Hintermüller, Ito
and Kunisch, SIAM J. Optim. 13, 2002); if that is slow, one mode changes at a time,
which ends for every P-matrix (Murty, Linear Algebra Appl. 7, 1974).

Frictions that hold the same motion share the load in no unique way. So where several
stick, the Jacobian (never the residual) is shifted a little: each Newton step then
changes the λ no more than it must.
"""

from bondgraph.numeric.compiled.linear_solve import substitute
from bondgraph.numeric.compiled.loops import inlined, lean
from bondgraph.numeric.kernel.stage_arrays import IDLE, STICKS, UNKNOWN, System, Work

SLACK = 1e-9
"""How far beyond 1 a sticking |λ| may be, relative; and a slipping g beyond zero."""
SHIFT = 1e-8


@inlined
def several_stick(system: System, work: Work) -> bool:
    """Return whether more than one friction sticks."""
    stuck = 0
    for k in range(system.nd):
        if work.mode[k] == STICKS:
            stuck += 1
    return stuck > 1


@inlined
def begin(system: System, work: Work) -> bool:
    """Let frictions of unknown mode slip the way their argument points."""
    begun = False
    for k in range(system.nd):
        if work.mode[k] == UNKNOWN:
            argument = work.v[system.residual[system.nz - system.nd + k]]
            work.mode[k] = -1 if argument < 0.0 else 1
            work.w[system.nx + system.nz - system.nd + k] = float(work.mode[k])
            begun = True
    return begun


@lean
def release(system: System, work: Work) -> bool:
    """Let all that sticks slip, because it holds nothing; return whether any stuck."""
    released = False
    for k in range(system.nd):
        if work.mode[k] == STICKS:
            work.mode[k] = UNKNOWN
            released = True
    return begin(system, work) if released else False


@inlined
def put_friction_residual(system: System, work: Work, h: float) -> None:
    """Write the residuals of the frictions."""
    for k in range(system.nd):
        z = system.nz - system.nd + k
        row = system.nx + z
        if work.mode[k] == STICKS:
            work.rhs[row, 0] = work.v[system.residual[z]] / h
        else:
            given = 0.0 if work.mode[k] == IDLE else float(work.mode[k])
            work.rhs[row, 0] = work.w[row] - given


@inlined
def put_friction_rows(system: System, work: Work, h: float) -> None:
    """Write the frictions' rows of the Jacobian."""
    nw = system.nx + system.nz
    shifted = several_stick(system, work)
    for k in range(system.nd):
        z = system.nz - system.nd + k
        row = system.nx + z
        for j in range(nw):
            work.lu[row, j] = 0.0
        if work.mode[k] != STICKS:
            work.lu[row, row] = 1.0
            continue
        for j in range(nw):
            work.lu[row, j] = work.d[system.residual[z], j] / h
        if shifted:
            work.lu[row, row] -= SHIFT * work.compliance[k]


@lean
def _compliance(system: System, work: Work, k: int, h: float) -> float:
    """Return -dg/dλ of friction k, which slips, the others as they are."""
    nw = system.nx + system.nz
    row = nw - system.nd + k
    for i in range(nw):
        work.rhs[i, 0] = 0.0
    work.rhs[row, 0] = 1.0
    substitute(work.lu, nw, work.pivot, work.rhs, 1)
    slot = system.residual[system.nz - system.nd + k]
    found = 0.0
    for j in range(nw):
        found -= work.d[slot, j] * work.rhs[j, 0]
    work.compliance[k] = max(work.compliance[k], found / h)
    return found


@lean
def _next_mode(system: System, work: Work, k: int, h: float) -> int:
    """Return the mode of friction k that fits its λ and its argument."""
    mode = int(work.mode[k])
    if mode == STICKS:
        force = work.w[system.nx + system.nz - system.nd + k]
        if abs(force) <= 1.0 + SLACK:
            return STICKS
        return 1 if force > 0.0 else -1
    g = work.argument[k]
    if mode == IDLE:
        return IDLE if g == 0.0 else (1 if g > 0.0 else -1)
    fits = mode * g > 0.0 or abs(g) <= SLACK * work.compliance[k] * h
    if fits and (g != 0.0 or work.compliance[k] > 0.0):
        return mode
    compliance = _compliance(system, work, k, h)
    if g == 0.0:
        return mode if compliance > 0.0 else IDLE
    if compliance <= 0.0:
        return 1 if g > 0.0 else -1
    force = mode + g / compliance
    if mode * force >= 1.0 - SLACK:
        return mode
    if abs(force) <= 1.0:
        return STICKS
    return 1 if force > 0.0 else -1


@inlined
def predict_arguments(system: System, work: Work, damping: float) -> None:
    """Write the arguments after a Newton step, by the tangents before it.

    That is exact for linear models, and as good as the step for others.
    """
    for k in range(system.nd):
        slot = system.residual[system.nz - system.nd + k]
        g = work.v[slot]
        for j in range(system.nx + system.nz):
            g -= damping * work.d[slot, j] * work.step[j]
        work.argument[k] = g


@lean
def switch_modes(system: System, work: Work, h: float, one_at_a_time: bool) -> bool:
    """Judge all modes after a Newton step; return whether one changed."""
    changed = False
    for k in range(system.nd):
        mode = _next_mode(system, work, k, h)
        if mode != work.mode[k]:
            work.mode[k] = mode
            if mode != STICKS:
                force = 0.0 if mode == IDLE else float(mode)
                work.w[system.nx + system.nz - system.nd + k] = force
            changed = True
            if one_at_a_time:
                return True
    return changed
