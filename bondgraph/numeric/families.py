"""Solutions that are not alone: which unknowns of ``r(y) = 0`` are free at a solution.

A direction in which the Jacobian vanishes may be a line of solutions or a double root;
a small step along it, corrected once, tells the two apart.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse

Array = NDArray[np.float64]

LARGEST = 600
RANK = 1e-11
STEP = 1e-3
STRAY = 1e-3


def family(
    jacobian: sparse.csc_array, y: Array, residual: Callable[[Array], Array]
) -> tuple[int, ...]:
    """Return the indices of unknowns that may be chosen, the others following them.

    Nothing is said of more than `LARGEST` unknowns: the answer is empty.
    """
    if not 0 < len(y) <= LARGEST:
        return ()
    matrix = jacobian.toarray()
    rows = np.linalg.norm(matrix, axis=1)
    scaled = matrix / np.where(rows > 0, rows, 1.0)[:, None]
    columns = np.linalg.norm(scaled, axis=0)
    unit = np.where(columns > 0, columns, 1.0)
    scaled = scaled / unit
    _, values, directions = np.linalg.svd(scaled)
    rank = int((values > RANK * values.max(initial=0.0)).sum())
    lines = [
        v / unit
        for v in directions[rank:]
        if _is_line(matrix, y, v / unit, residual, rows)
    ]
    if not lines:
        return ()
    # The unknowns that determine the rest: pivots of the free directions.
    _, _, pivots = linalg.qr(np.array(lines) * unit, mode="economic", pivoting=True)
    return tuple(sorted(int(i) for i in pivots[: len(lines)]))


def _is_line(
    matrix: Array,
    y: Array,
    direction: Array,
    residual: Callable[[Array], Array],
    rows: Array,
) -> bool:
    size = max(1.0, float(np.abs(y).max(initial=0.0)))
    step = STEP * size * direction / np.abs(direction).max()
    off = residual(y + step)
    correction = np.linalg.lstsq(matrix, off, rcond=1e-9)[0]
    left = np.abs(residual(y + step - correction)) / np.where(rows > 0, rows, 1.0)
    # A double root leaves a residual of the order of the step squared.
    return bool((left <= STRAY * STEP * np.abs(step).max()).all())
