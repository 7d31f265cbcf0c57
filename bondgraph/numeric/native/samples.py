"""What compiled time loops do at a sample."""

import math

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, compiled, inlined
from bondgraph.numeric.native.calls import call_slopes, call_values
from bondgraph.numeric.native.model import NativeSystem


@compiled
def variables(system: NativeSystem, parameters: Array) -> Array:
    """Return room for all variables and results, with the parameters in place."""
    results = max(system.nx + system.nz, system.ny, 2)
    v = np.zeros(system.n_variables + results)
    at = 2 * (system.nx + system.nu) + system.nz
    for i in range(system.n_parameters):
        v[at + i] = parameters[i]
    return v


@inlined
def read_outputs(
    system: NativeSystem, v: Array, j: Array, dx: Array, dw: Array,
    directions: Integers, n: int, outputs: Array, sensitivities: Array, row: int,
) -> bool:  # fmt: skip
    """Write the outputs of one sample and their tangents along `n` directions.

    False where an output is not finite. `v` holds the sample's variables; `dx` and `dw`
    are the tangents of x and (ẋ, z).
    """
    nx, nw, nc = system.nx, system.nx + system.nz, system.n_columns
    if n == 0:
        call_values(system.read, v)
    else:
        call_slopes(system.read_slopes, v, j)
    finite = True
    for i in range(system.ny):
        outputs[row, i] = v[system.n_variables + i]
        finite = finite and math.isfinite(outputs[row, i])
        for m in range(n):
            total = 0.0
            for k in range(nx):
                total += j[i * nc + k] * dx[k, m]
            if system.instantaneous:
                for k in range(nw):
                    total += j[i * nc + nx + k] * dw[k, m]
            if m < len(directions):
                total += j[i * nc + nx + nw + directions[m]]
            sensitivities[row, i, m] = total
    return finite
