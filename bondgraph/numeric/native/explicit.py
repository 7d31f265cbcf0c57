"""The classical Runge-Kutta method over one window, compiled, with sensitivities.

The tangents are those of the discrete solution: the derivative of what is computed.
"""

import math

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, compiled
from bondgraph.numeric.native.calls import (
    call_along,
    call_slopes,
    call_values,
)
from bondgraph.numeric.native.model import NativeSystem
from bondgraph.numeric.native.samples import read_outputs, variables
from bondgraph.numeric.native.step import NODES
from bondgraph.numeric.native.step_tangents import ABREAST


@compiled
def integrate_explicit(  # noqa: C901, PLR0912  (a compiled loop)
    system: NativeSystem, substeps: int, zero_hold: bool, parameters: Array,
    directions: Integers, time: Array, u: Array, x0: Array,
    outputs: Array, sensitivities: Array, states: Array,
) -> int:  # fmt: skip
    """Simulate one window; return how many samples were completed.

    `directions` are the parameters whose sensitivities are wanted; those to the initial
    state follow them where `sensitivities` has columns for them. There are none where
    it has no rows.
    """
    nx, nu, nq, samples = system.nx, system.nu, len(directions), len(time)
    n = sensitivities.shape[2] if len(sensitivities) else 0
    v = variables(system, parameters)
    clock = system.n_variables - 1
    j = np.zeros(max(nx, system.ny, 1) * system.n_columns + 1)
    wide = (n // ABREAST + 1) * ABREAST
    d = np.zeros((nx, wide))
    own = np.zeros((len(NODES) * nx, wide))
    where = np.full(system.n_parameters, n)  # Past all, where nobody looks.
    dw = np.zeros((nx, max(n, 1)))
    for i in range(nx):
        v[i] = x0[i]
    for i in range(nx if n > nq else 0):
        d[i, nq + i] = 1.0
    for k in range(nq):
        where[directions[k]] = k
    for row in range(samples):
        following = min(row + 1, samples - 1)
        span = time[following] - time[row]
        for i in range(nu):
            v[2 * nx + i] = u[row, i]
            if not zero_hold and span > 0.0:
                v[2 * nx + nu + i] = (u[following, i] - u[row, i]) / span
        v[clock] = time[row]
        for i in range(nx):
            states[row, i] = v[i]
            if not math.isfinite(v[i]):
                return row
        if system.instantaneous:
            _rates(system, v, j, d, dw, directions, n)
        if not read_outputs(
            system, v, j, d, dw, directions, n, outputs, sensitivities, row
        ):
            return row
        if row == following:
            break
        h = span / substeps
        for step in range(substeps):
            v[clock + 1] = step * h
            v[clock + 2] = h
            if n > 0:
                call_along(system.step_tangents, v, d, own, where, n)
            else:
                call_values(system.step, v)
    return samples


@compiled
def _rates(
    system: NativeSystem, v: Array, j: Array, d: Array, dk: Array,
    directions: Integers, n: int,
) -> None:  # fmt: skip
    """Write ẋ into its variables, and its tangents where x moves along `d`."""
    nx, nc = system.nx, system.n_columns
    if n == 0:
        call_values(system.values, v)
    else:
        call_slopes(system.slopes, v, j)
    for i in range(nx):
        v[nx + i] = v[system.n_variables + i]
        for m in range(n):
            total = 0.0
            for k in range(nx):
                total += j[i * nc + k] * d[k, m]
            if m < len(directions):
                total += j[i * nc + 2 * nx + directions[m]]
            dk[i, m] = total
