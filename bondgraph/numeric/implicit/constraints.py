"""Constraints between stored quantities, solved for as few of them as they bind.

Each connected set of constraints is brought to reduced echelon form, taking pivots in
a given order of preference. An entry counts as zero when it is small against the terms
it is the sum of, so that units do not matter.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

Array = NDArray[np.float64]
Index = NDArray[np.int64]

ROUNDING = 1e-11


def resolved(
    constraint: csr_array, n_states: int, preference: Index
) -> tuple[Index, csr_array]:
    """Solve ``constraint y = 0`` for stored quantities.

    Parameters
    ----------
    constraint
        Rows ``[.., y]``; the first `n_states` columns are stored quantities.
    preference
        The columns to solve for, the most welcome first.

    Returns
    -------
    dependent, following
        Columns solved for, and rows so that ``y[dependent] = following y``; fewer than
        there are constraints where these contradict or repeat each other.
    """
    rank = np.full(constraint.shape[1], len(preference))
    rank[preference] = np.arange(len(preference))
    between = csr_array(constraint[:, :n_states])
    _, label = connected_components(csr_array(between @ between.T), directed=False)
    dependent: list[int] = []
    rows: list[NDArray[Any]] = []
    columns: list[NDArray[Any]] = []
    order = np.argsort(label, kind="stable")
    edges = np.flatnonzero(np.diff(label[order])) + 1
    for group in np.split(order, edges):
        part = csr_array(constraint[group])
        used = np.unique(part.indices)
        used = used[np.argsort(rank[used], kind="stable")]
        n_pivots = int(np.sum(rank[used] < len(preference)))
        echelon, pivots = _echelon(part[:, used].toarray(), n_pivots)
        for row, pivot in zip(echelon, pivots, strict=True):
            dependent.append(int(used[pivot]))
            row[pivot] = 0.0
            there = np.flatnonzero(row)
            rows.append(-row[there])
            columns.append(used[there])
    lengths = [len(row) for row in rows]
    where = (np.repeat(np.arange(len(rows)), lengths), _joined(columns, np.int64))
    shape = (len(rows), constraint.shape[1])
    following = coo_array((_joined(rows, float), where), shape=shape).tocsr()
    return np.array(dependent, np.int64), following


def _joined(parts: list[NDArray[Any]], kind: type) -> NDArray[Any]:
    return np.concatenate([np.zeros(0, kind), *parts])


def _echelon(matrix: Array, n_pivots: int) -> tuple[Array, list[int]]:
    """Return the reduced rows with a pivot among the first columns, and the pivots."""
    size = np.abs(matrix)
    pivots: list[int] = []
    for column in range(n_pivots):
        here = len(pivots)
        if here == len(matrix):
            break
        best = here + int(np.argmax(np.abs(matrix[here:, column])))
        pivot = matrix[best, column]
        if abs(pivot) <= ROUNDING * size[best, column]:
            continue
        for table in (matrix, size):
            table[[here, best]] = table[[best, here]]
        size[here] /= abs(pivot)
        matrix[here] /= pivot
        factors = matrix[:, column].copy()
        factors[here] = 0.0
        touched = np.flatnonzero(factors)
        matrix[touched] -= factors[touched, None] * matrix[here]
        size[touched] += np.abs(factors[touched, None]) * size[here]
        matrix[touched, column] = 0.0
        matrix[np.abs(matrix) <= ROUNDING * size] = 0.0
        pivots.append(column)
    return matrix[: len(pivots)], pivots
