"""All variables and rates of a model where its states and inputs are given."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, hstack

from bondgraph.errors import EquationError, did_you_mean
from bondgraph.numeric.implicit.reduction import Reduction, reduced
from bondgraph.numeric.implicit.refusals import refuse_kink
from bondgraph.numeric.implicit.system import ImplicitSystem

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Point:
    """Where a model is: all variables, all rates, and the linear forms around it."""

    z: Array
    rates: Array
    input_rates: Array
    reduction: Reduction


def drives(system: ImplicitSystem, time: Array) -> csr_array:
    """Return the columns of what drives the rows: the inputs and t."""
    return csr_array(hstack([system.inputs, csr_array(-time[:, None])]))


def solve_at(
    system: ImplicitSystem,
    at: Mapping[str, float],
    *,
    input_rates: Mapping[str, float] | None = None,
    iterations: int = 60,
) -> Point:
    """Return all variables and rates where the states, inputs and ``t`` are `at`.

    Each step of Newton's method solves the rows linearised at the last one, so
    dependent stored quantities and the derivatives of what binds them are found on the
    way, also where a modulus moves.

    Raises
    ------
    EquationError
        If the equations have no solution there, or a law no derivative.
    """
    known = {*system.state_names, *system.input_names, "t"}
    for name in at:
        if name not in known:
            raise EquationError(
                f"{system.name!r} has no state or input {name!r}.",
                (name,),
                did_you_mean(name, known),
            )
    n = system.n_powers
    t = at.get("t", 0.0)
    x = np.array([at.get(name, 0.0) for name in system.state_names])
    u = np.array([at.get(name, 0.0) for name in system.input_names])
    du = np.array([(input_rates or {}).get(name, 0.0) for name in system.input_names])
    z = np.concatenate([np.zeros(n) if system.linear else np.full(n, 0.1), x])
    for _ in range(iterations):
        jacobian = system.jacobian(z, t, capped=True)
        time = system.time_partial(z, t)
        residual = system.residual(z, u, t)
        affine = jacobian @ z - (residual + system.inputs @ u)
        if not np.all(np.isfinite(affine)):
            refuse_kink(system, np.flatnonzero(~np.isfinite(affine)))
        reduction = reduced(system, jacobian, drives(system, time), affine)
        y = np.concatenate([z[n:], u, [0.0], du, [1.0, 1.0]])
        y[: len(x)][reduction.independent] = x[reduction.independent]
        new = np.concatenate([reduction.powers @ y, reduction.stored @ y])
        change = np.abs(new - z)
        step = 1.0
        if not system.linear:
            step = _step(system, z, new - z, u, t)
        z = z + step * (new - z)
        if system.linear or np.all(change <= 1e-12 * (1.0 + np.abs(new))):
            return Point(
                z=new, rates=reduction.rates @ y, input_rates=du, reduction=reduction
            )
    raise EquationError(
        f"The equations of {system.name!r} have no solution there that Newton's "
        f"method finds in {iterations} steps.",
        (system.name,),
        "Give an operating point that the machine can have.",
    )


def _step(system: ImplicitSystem, z: Array, change: Array, u: Array, t: float) -> float:
    """Return how much of a Newton step to take: all, unless that makes it worse."""
    before = np.linalg.norm(system.residual(z, u, t))
    step = 1.0
    while step > 1e-3:
        left = system.residual(z + step * change, u, t)
        size = np.linalg.norm(left)
        if np.isfinite(size) and size <= np.maximum(before, 1e-9):
            return step
        step /= 2.0
    return step
