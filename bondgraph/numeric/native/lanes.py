"""Many parameter sets side by side: one step of all lanes is one run of vector code."""

import math

import numpy as np

from bondgraph.numeric.compiled.loops import Array, Integers, compiled, lean
from bondgraph.numeric.native.calls import call_values
from bondgraph.numeric.native.model import NativeSystem

LANES = 8
"""Parameter sets per run: two AVX2 registers, or one of AVX-512."""


@compiled
def integrate_lanes(
    system: NativeSystem, substeps: int, zero_hold: bool, parameters: Array,
    time: Array, u: Array, x0: Array, outputs: Array, first: int, last: int,
    done: Integers,
) -> None:  # fmt: skip
    """Simulate the parameter sets ``first … last - 1``, `LANES` at a time.

    ``parameters`` (sets, n_parameters), ``x0`` (sets, nx), ``outputs`` (sets, n, ny).
    ``done[set]`` becomes the number of samples with finite outputs.
    """
    slots = system.n_variables + max(system.nx + system.nz, system.ny, 2)
    v = np.zeros(slots * LANES)
    for block in range(first, last, LANES):
        _fill(system, v, parameters, x0, block, last)
        _run(
            system, substeps, zero_hold, time, u, v, outputs, block,
            min(LANES, last - block), done,
        )  # fmt: skip


@lean
def _fill(
    system: NativeSystem, v: Array, parameters: Array, x0: Array, block: int, last: int
) -> None:
    """Write parameters and initial states; lanes beyond the last repeat it."""
    at = 2 * (system.nx + system.nu)
    v[:] = 0.0
    for lane in range(LANES):
        chosen = min(block + lane, last - 1)
        for i in range(system.n_parameters):
            v[(at + i) * LANES + lane] = parameters[chosen, i]
        for i in range(system.nx):
            v[i * LANES + lane] = x0[chosen, i]


@lean
def _spread(v: Array, slot: int, value: float) -> None:
    for lane in range(LANES):
        v[slot * LANES + lane] = value


@lean
def _run(  # noqa: C901  (a compiled loop)
    system: NativeSystem, substeps: int, zero_hold: bool, time: Array, u: Array,
    v: Array, outputs: Array, block: int, used: int, done: Integers,
) -> None:  # fmt: skip
    nx, nu, ny, samples = system.nx, system.nu, system.ny, len(time)
    clock, results = system.n_variables - 1, system.n_variables
    for lane in range(used):
        done[block + lane] = samples
    for row in range(samples):
        following = min(row + 1, samples - 1)
        span = time[following] - time[row]
        for i in range(nu):
            _spread(v, 2 * nx + i, u[row, i])
            if not zero_hold and span > 0.0:
                slope = (u[following, i] - u[row, i]) / span
                _spread(v, 2 * nx + nu + i, slope)
        _spread(v, clock, time[row])
        if system.instantaneous:
            call_values(system.values, v)
            for k in range(nx * LANES):
                v[nx * LANES + k] = v[results * LANES + k]
        call_values(system.read, v)
        for i in range(ny):
            for lane in range(used):
                value = v[(results + i) * LANES + lane]
                outputs[block + lane, row, i] = value
                if not math.isfinite(value):
                    done[block + lane] = min(done[block + lane], row)
        h = span / substeps
        _spread(v, clock + 2, h)
        for step in range(substeps if row < following else 0):
            _spread(v, clock + 1, step * h)
            call_values(system.step, v)
