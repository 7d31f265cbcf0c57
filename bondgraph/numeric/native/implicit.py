"""A diagonally implicit Runge-Kutta method over one window, in native code.

The same steps as `bondgraph.numeric.kernel.windows` takes on a tape, with the same
sensitivities: those of the discrete solution.
"""

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, lean, only_there
from bondgraph.numeric.native.implicit_step import Path, Tableau, cross, set_inputs
from bondgraph.numeric.native.model import NativeSystem
from bondgraph.numeric.native.samples import read_outputs, variables
from bondgraph.numeric.native.stage import Stage, differentiate, make_stage, solve


@only_there
def integrate_implicit(
    system: NativeSystem, method: Tableau, parameters: Array, directions: Integers,
    time: Array, u: Array, x0: Array,
    outputs: Array, sensitivities: Array, states: Array,
) -> int:  # fmt: skip
    """Simulate one window; return how many samples were completed.

    `directions` are the parameters whose sensitivities are wanted; those to the initial
    state follow them where `sensitivities` has columns for them. There are none where
    it has no rows.
    """
    nx, nq, stages = system.nx, len(directions), len(method.c)
    n = sensitivities.shape[2] if len(sensitivities) else 0
    width = max(n, 1)
    stage = make_stage(system, variables(system, parameters), n)
    path = Path(
        x=x0.copy(),
        dx=np.zeros((nx, width)),
        base=np.zeros(nx),
        dbase=np.zeros((nx, width)),
        k=np.zeros((stages, nx)),
        dk=np.zeros((stages, nx, width)),
        w=np.zeros(nx + system.nz),
        slope=np.zeros(system.nu),
    )
    for i in range(nx if n > nq else 0):
        path.dx[i, nq + i] = 1.0
    jy = np.zeros(system.ny * system.n_columns + 1)
    return _run(
        system, method, stage, path, jy, directions, n, time, u,
        outputs, sensitivities, states,
    )  # fmt: skip


@lean
def _run(  # noqa: C901  (a compiled loop)
    system: NativeSystem, method: Tableau, stage: Stage, path: Path, jy: Array,
    directions: Integers, n: int, time: Array, u: Array,
    outputs: Array, sensitivities: Array, states: Array,
) -> int:  # fmt: skip
    nx, nu, samples = system.nx, system.nu, len(time)
    v, at_u = stage.v, 2 * nx + system.nz
    for row in range(samples):
        following = min(row + 1, samples - 1)
        span = time[following] - time[row]
        for i in range(nu):
            if not method.zero_hold and span > 0.0:
                path.slope[i] = (u[following, i] - u[row, i]) / span
            v[at_u + nu + i] = path.slope[i]
        set_inputs(system, v, u, row, path.slope, time[row], 0.0)
        if system.instantaneous and nx + system.nz > 0:
            if not solve(system, stage, path.x, 0.0):
                return row
            if n > 0 and not differentiate(system, stage, path.dx, 0.0, directions, n):
                return row
        for i in range(nx):
            v[i] = path.x[i]
            states[row, i] = path.x[i]
        if not read_outputs(
            system, v, jy, path.dx, stage.dw, directions, n, outputs, sensitivities, row
        ):
            return row
        h = span / method.substeps
        for step in range(method.substeps if row < following and nx > 0 else 0):
            if not cross(
                system, method, stage, path, directions, n, u, row, time[row],
                step * h, h,
            ):  # fmt: skip
                return row
    return samples
