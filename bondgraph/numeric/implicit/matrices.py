"""Sparse linear systems with numbers, from the implicit system.

Nothing is derived in symbols: a graph of a thousand stages gives its matrices in a
fraction of a second, and they have as many entries as the machine has couplings.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from bondgraph.numeric.implicit.curvature import with_curvature
from bondgraph.numeric.implicit.points import solve_at
from bondgraph.numeric.implicit.reduction import combined
from bondgraph.numeric.implicit.refusals import refuse_kink
from bondgraph.numeric.implicit.system import ImplicitSystem, implicit_system
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ImplicitStateSpace:
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


def implicit_state_space(
    graph: FinishedGraph, *, at: Mapping[str, float] | None = None
) -> ImplicitStateSpace:
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
    t = (at or {}).get("t", 0.0)
    _check_smooth(system, point.z, t)
    reduction = with_curvature(system, point, t)
    n, m = system.n_states, len(system.input_names)
    reading = system.output_jacobian(point.z, t)
    outputs = csr_array(
        combined(csr_array(reading[:, : system.n_powers]), reduction.powers)
        + combined(csr_array(reading[:, system.n_powers :]), reduction.stored)
    )
    independent = reduction.independent
    rates = csr_array(reduction.rates[independent])
    set_by_others = np.setdiff1d(np.arange(n), independent)
    return ImplicitStateSpace(
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


def _check_smooth(system: ImplicitSystem, z: Array, t: float) -> None:
    bad = [np.zeros(0, np.int64)]
    for group in system.laws:
        partials = group.partials(z, t)[0]
        undefined = ~np.isfinite(partials).all(axis=0)
        bad.append(group.rows[undefined | group.at_kink(z, t)])
    refuse_kink(system, np.concatenate(bad))
