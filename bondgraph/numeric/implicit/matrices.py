"""Sparse linear systems with numbers, from the implicit system.

Nothing is derived in symbols: a graph of a thousand stages gives its matrices in a
fraction of a second, and they have as many entries as the machine has couplings.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from bondgraph.errors import EquationError, did_you_mean
from bondgraph.numeric.implicit.reduction import Reduction, combined, reduced
from bondgraph.numeric.implicit.system import ImplicitSystem, implicit_system
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SparseStateSpace:
    """``ẋ = A x + B u + B_rate u̇`` and ``y = C x + D u + D_rate u̇`` in SI units.

    The matrices are sparse. ``dependent`` names the stored quantities that are no
    states because others or inputs set them. For a nonlinear model x, u and y are
    deviations from the operating point.
    """

    name: str
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    state_units: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]
    dependent: tuple[str, ...]
    A: csr_array
    B: csr_array
    C: csr_array
    D: csr_array
    B_rate: csr_array
    D_rate: csr_array


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """Where a model is: all variables, all rates, and the linear forms around it."""

    z: Array
    rates: Array
    reduction: Reduction


def sparse_state_space(
    graph: FinishedGraph, *, at: Mapping[str, float] | None = None
) -> SparseStateSpace:
    """Return the sparse linear system of `graph` at its parameter values.

    Parameters
    ----------
    at
        Operating point of a nonlinear model: values of states, inputs and ``t`` by
        name; what is not named is zero.

    Raises
    ------
    ParameterError
        If a parameter has no value.
    EquationError
        If the graph is singular, or the model has no linear form at the point.
    """
    system = implicit_system(graph)
    point = solve_at(system, at or {})
    reduction = point.reduction
    _check_rest(system, point)
    _check_jumps(system, point.z, (at or {}).get("t", 0.0))
    n, m = system.n_states, len(system.input_names)
    reading = system.output_jacobian(point.z, (at or {}).get("t", 0.0))
    outputs = csr_array(
        combined(csr_array(reading[:, : system.n_powers]), reduction.powers)
        + combined(csr_array(reading[:, system.n_powers :]), reduction.stored)
    )
    independent = reduction.independent
    rates = csr_array(reduction.rates[independent])
    set_by_others = np.setdiff1d(np.arange(n), independent)
    return SparseStateSpace(
        name=system.name,
        states=tuple(system.state_names[i] for i in independent),
        inputs=system.input_names,
        outputs=system.output_names,
        state_units=tuple(system.state_units[i] for i in independent),
        input_units=system.input_units,
        output_units=system.output_units,
        dependent=tuple(system.state_names[i] for i in set_by_others),
        A=csr_array(rates[:, independent]),
        B=csr_array(rates[:, n : n + m]),
        C=csr_array(outputs[:, independent]),
        D=csr_array(outputs[:, n : n + m]),
        B_rate=csr_array(rates[:, n + m + 1 : n + 2 * m + 1]),
        D_rate=csr_array(outputs[:, n + m + 1 : n + 2 * m + 1]),
    )


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
        jacobian = system.jacobian(z, t)
        time = system.time_partial(z, t)
        residual = system.residual(z, u, t)
        affine = jacobian @ z - (residual + system.inputs @ u)
        _check_finite(system, jacobian, affine)
        reduction = reduced(system, jacobian, time, affine)
        y = np.concatenate([z[n:], u, [0.0], du, [1.0, 1.0]])
        y[: len(x)][reduction.independent] = x[reduction.independent]
        new = np.concatenate([reduction.powers @ y, reduction.stored @ y])
        change = np.abs(new - z)
        step = 1.0
        if not system.linear:
            step = _step(system, z, new - z, u, t)
        z = z + step * (new - z)
        if system.linear or np.all(change <= 1e-12 * (1.0 + np.abs(new))):
            return Point(z=new, rates=reduction.rates @ y, reduction=reduction)
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


def _check_finite(system: ImplicitSystem, jacobian: csr_array, affine: Array) -> None:
    bad = np.flatnonzero(~np.isfinite(affine))
    rows = jacobian.tocoo().coords[0][~np.isfinite(jacobian.data)]
    _refuse_kink(system, np.union1d(bad, rows))


def _check_jumps(system: ImplicitSystem, z: Array, t: float) -> None:
    bad = [group.rows[group.at_jump(z, t)] for group in system.laws]
    if bad:
        _refuse_kink(system, np.concatenate(bad))


def _refuse_kink(system: ImplicitSystem, rows: NDArray[np.int64]) -> None:
    if len(rows):
        nodes = system.places.graph.nodes
        names = tuple(nodes[i].name for i in np.unique(system.owners[rows]))
        raise EquationError(
            f"The law of {', '.join(names[:6])} has no derivative at this point.",
            names,
            "Choose a point away from the kink or pole of the law.",
        )


def _check_rest(system: ImplicitSystem, point: Point) -> None:
    """Refuse what would need second derivatives of a law that moves.

    A constraint is differentiated once to reach the rates; its linear form around a
    moving point contains the law's second derivative, times a rate.
    """
    if np.abs(point.rates).max(initial=0.0) < 1e-9:
        return
    bound = point.reduction.differentiated
    for group in system.laws:
        if not group.linear and np.isin(group.rows, bound).any():
            nodes = system.places.graph.nodes
            rows = group.rows[np.isin(group.rows, bound)]
            names = tuple(nodes[i].name for i in np.unique(system.owners[rows]))
            raise EquationError(
                f"The nonlinear law of {', '.join(names[:6])} binds dependent storages "
                f"that move at this point, so that its linear form needs second "
                f"derivatives.",
                names,
                "Linearise where the machine rests, or use linearise(derive(graph)).",
            )
