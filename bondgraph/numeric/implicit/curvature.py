"""The linear form around a point that moves: laws bend, and constraints feel it.

A constraint between stored quantities is differentiated once to reach the rates. Where
its law is nonlinear, the derivative contains the law's slope, which changes when the
variables do: with J the Jacobian of the rows and ż how the variables move, the rows of
the differentiated constraint get the further terms (dJ/dt along ż) δz. They enter as a
rate of disturbance of each nonlinear row.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, hstack, vstack

from bondgraph.numeric.implicit.points import Point, drives
from bondgraph.numeric.implicit.reduction import Reduction, combined, reduced
from bondgraph.numeric.implicit.system import ImplicitSystem

Array = NDArray[np.float64]

STEPS = ((1.0, 8.0 / 12.0), (-1.0, -8.0 / 12.0), (2.0, -1.0 / 12.0), (-2.0, 1.0 / 12.0))
"""A fourth-order difference: offsets and weights."""
STEP = 1e-3
MOST_PASSES = 10


def with_curvature(system: ImplicitSystem, point: Point, t: float) -> Reduction:
    """Return the linear forms of w, x and ẋ around a point, moving or not."""
    plain = point.reduction
    bent = [group.rows for group in system.laws if not group.linear]
    rows = np.concatenate([np.zeros(0, np.int64), *bent])
    rows = rows[np.isin(rows, plain.differentiated)]
    if not len(rows):
        return plain
    disturbed = _disturbed(system, point, t, rows)
    n, k = system.n_states, len(system.input_names) + 1
    base = np.concatenate([np.arange(n + k), n + k + len(rows) + np.arange(k)])
    base = np.append(base, disturbed.powers.shape[1] - 1)
    powers = csr_array(disturbed.powers[:, base])
    stored = csr_array(disturbed.stored[:, base])
    first = n + 2 * k + len(rows)
    answer = csr_array(disturbed.powers[:, first : first + len(rows)])
    if not answer.nnz:
        return plain
    moving = _moving(system, point, plain)
    bend = _bend(system, point.z, moving, t)[rows]
    found = powers
    for _ in range(MOST_PASSES):
        before = found
        every = csr_array(vstack([found, stored]))
        found = csr_array(powers - combined(csr_array(answer @ bend), every))
        if abs(found - before).max() <= 1e-13 * abs(found).max():
            break
    signs = coo_array(
        (system.rate_signs, (np.arange(n), system.rate_columns)),
        shape=(n, system.n_powers),
    )
    return replace(plain, powers=found, rates=csr_array(signs.tocsr() @ found))


def _disturbed(
    system: ImplicitSystem, point: Point, t: float, rows: NDArray[np.int64]
) -> Reduction:
    """Return the reduction with a disturbance of each of these rows as an input."""
    time = system.time_partial(point.z, t)
    where = (rows, np.arange(len(rows)))
    disturbances = coo_array(
        (np.ones(len(rows)), where), shape=(len(system.owners), len(rows))
    )
    driven = csr_array(hstack([drives(system, time), disturbances]))
    jacobian = system.jacobian(point.z, t)
    return reduced(system, jacobian, driven, np.zeros(len(system.owners)))


def _moving(system: ImplicitSystem, point: Point, plain: Reduction) -> Array:
    """Return how z moves, as far as the differentiated rows tell.

    Efforts and flows that follow from states and inputs move with these; the others
    do not enter a constraint.
    """
    rest = np.zeros(len(point.input_rates) + 2)
    y = np.concatenate([point.rates, point.input_rates, [1.0], rest])
    return np.concatenate([plain.powers @ y, point.rates])


def _bend(system: ImplicitSystem, z: Array, moving: Array, t: float) -> csr_array:
    """Return the derivative of the Jacobian along the motion, rows by z."""
    speed = max(1.0, float(np.abs(moving).max(initial=0.0)))
    step = STEP / speed
    total = csr_array((len(system.owners), len(z)))
    for offset, weight in STEPS:
        h = offset * step
        there = system.jacobian(z + h * moving, t + h)
        total = csr_array(total + (weight / step) * there)
    return total
