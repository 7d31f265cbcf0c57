"""Steps of a model with set-valued friction in native code, while its modes last.

With its modes held such a model is an ordinary one: what selects the equation of each λ
is a parameter (`SetValuedForm.held`). So a step is tried in native code; where it ends
with modes that do not fit, it is left to `bondgraph.numeric.kernel.stepping`, which
finds the event and the modes after it.
"""

from typing import NamedTuple

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, compiled, inlined, lean
from bondgraph.numeric.kernel.friction_modes import SLACK
from bondgraph.numeric.kernel.method import (
    Drive,
    Method,
    Steps,
    set_inputs,
    stage_base,
    sum_stages,
)
from bondgraph.numeric.kernel.stage_arrays import STICKS, System, Work
from bondgraph.numeric.native.calls import call_values
from bondgraph.numeric.native.model import NativeSystem
from bondgraph.numeric.native.samples import read_outputs, variables
from bondgraph.numeric.native.stage import Stage, differentiate, make_stage, solve


class Fast(NamedTuple):
    """Native code of a model with held modes; ``arguments`` gives the g. Or nothing."""

    native: NativeSystem
    arguments: int
    there: bool


class FastWork(NamedTuple):
    """Scratch of native code: a stage, and slopes of the outputs."""

    stage: Stage
    jy: Array


@compiled
def make_fast_work(fast: Fast, parameters: Array, n: int) -> FastWork:
    """Return scratch for `n` tangent directions."""
    native = fast.native
    stage = make_stage(native, variables(native, parameters), n)
    return FastWork(stage, np.zeros(native.ny * native.n_columns + 1))


@lean
def hand_over(system: System, work: Work, stage: Stage) -> None:
    """Let native code go on from where the tape is."""
    nw = system.nx + system.nz
    at = 2 * (system.nx + system.nu) + system.nz + system.n_parameters - 2 * system.nd
    for k in range(system.nd):
        stage.v[at + 2 * k] = 1.0 if work.mode[k] == STICKS else 0.0
        stage.v[at + 2 * k + 1] = float(work.mode[k])
        stage.weight[nw - system.nd + k] = 1.0
    for i in range(nw):
        stage.w[i] = work.w[i]
    stage.factored[0] = np.nan


@inlined
def _fits(system: System, work: Work, fast: Fast, stage: Stage, h: float) -> bool:
    """Return whether the modes fit the solution of a stage."""
    call_values(fast.arguments, stage.v)
    for k in range(system.nd):
        work.argument[k] = stage.v[fast.native.n_variables + k]
        mode = work.mode[k]
        if mode == STICKS:
            if abs(stage.w[system.nx + system.nz - system.nd + k]) > 1.0 + SLACK:
                return False
        elif (
            abs(mode) != 1 or mode * work.argument[k] < -SLACK * work.compliance[k] * h
        ):
            return False
    return True


@inlined
def try_step(
    system: System, work: Work, fast: Fast, stage: Stage, method: Method, steps: Steps,
    x: Array, dx: Array, drive: Drive, elapsed: float, h: float, directions: Integers,
    n: int,
) -> bool:  # fmt: skip
    """Take one step with the modes as they are; False (and x as before) if it fails."""
    for i in range(system.nx + system.nz):
        work.w[i] = stage.w[i]
    for k in range(system.nd):
        steps.argument[k] = work.argument[k]
    for s in range(len(method.c)):
        set_inputs(system, stage.v, drive, elapsed + method.c[s] * h)
        stage_base(method, steps, x, dx, s, h, n)
        size = h * method.a[s, s]
        fits = solve(fast.native, stage, steps.base, size)
        fits = fits and _fits(system, work, fast, stage, size)
        if fits and n > 0:
            fits = differentiate(fast.native, stage, steps.dbase, size, directions, n)
        if not fits:
            for k in range(system.nd):
                work.argument[k] = steps.argument[k]
            return False
        for i in range(system.nx):
            steps.k[s, i] = stage.w[i]
            for m in range(n):
                steps.dk[s, i, m] = stage.dw[i, m]
    return sum_stages(method, steps, x, dx, h, n)


@inlined
def try_read(
    system: System, work: Work, fast: Fast, there: FastWork, x: Array, dx: Array,
    glance: float, directions: Integers, n: int, outputs: Array, sensitivities: Array,
    row: int,
) -> bool:  # fmt: skip
    """Write the outputs of one sample; False if the modes do not fit."""
    native, stage = fast.native, there.stage
    if native.instantaneous:
        for i in range(system.nx + system.nz):
            work.w[i] = stage.w[i]
        fits = solve(native, stage, x, glance)
        fits = fits and _fits(system, work, fast, stage, glance)
        if fits and n > 0:
            fits = differentiate(native, stage, dx, glance, directions, n)
        if not fits:
            return False
    for i in range(system.nx):
        stage.v[i] = x[i]
    read_outputs(
        native, stage.v, there.jy, dx, stage.dw, directions, n, outputs, sensitivities,
        row,
    )  # fmt: skip
    return True
