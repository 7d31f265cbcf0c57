"""Sparse linear equations block by block, in the order of what needs what.

A matching gives every unknown a row of its own; the strongly connected components of
what is left are the smallest sets of rows that must be solved together (block
triangular form). With D the diagonal blocks and N the rest, ``(D + N) v = R`` becomes
``v = M v + D⁻¹ R`` with ``M = -D⁻¹ N`` nilpotent, so that ``v = Σ Mᵏ D⁻¹ R`` ends after
as many doublings as the logarithm of the longest path. The right side is a sparse
matrix, and so is the answer: one row per unknown, nothing dense anywhere but inside a
block.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr
from scipy.sparse import block_array, coo_array, csr_array, diags_array
from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]
Index = NDArray[np.int64]

RANK_TOLERANCE = 1e-11
"""A pivot of a balanced block below this is taken for zero."""
LARGEST_INVERTED = 64
"""Larger blocks are factorised sparsely instead of inverted densely."""


@dataclass(frozen=True, slots=True, eq=False)
class Dependency:
    """Rows of a block that the block's other rows contain: ``row = weights @ others``.

    ``unit_columns`` are the block's columns, where the difference is exactly zero.
    """

    rows: Index
    others: Index
    weights: Array
    columns: Index


def matched(matrix: csr_array) -> Index:
    """Return the column matched to each row, -1 for none; as many as possible."""
    if not matrix.nnz:
        return np.full(matrix.shape[0], -1)
    return maximum_bipartite_matching(matrix, perm_type="column").astype(np.int64)


def components(square: csr_array) -> tuple[int, Index]:
    """Return how many diagonal blocks a matched square matrix has, and each row's."""
    count, label = connected_components(square, directed=True, connection="strong")
    return int(count), label.astype(np.int64)


def solve(square: csr_array, right: csr_array) -> csr_array | list[Dependency]:
    """Return v of ``square v = right``, or the rows that make a block singular.

    The diagonal of `square` must be structurally full.
    """
    count, label = components(square)
    coordinates = square.tocoo()
    rows, columns = coordinates.coords
    inside = label[rows] == label[columns]
    size = np.bincount(label, minlength=count)
    n = square.shape[0]
    diagonal = (coordinates.data[inside], rows[inside], columns[inside])
    outside = ~inside
    rest = coo_array(
        (-coordinates.data[outside], (rows[outside], columns[outside])), shape=(n, n)
    )
    known = block_array([[rest, right]], format="csr")
    inverse, large, singular = _inverse(diagonal, label, size)
    if not singular:
        solved, singular = _with_large(inverse @ known, known, large)
    if singular:
        return singular
    return _summed(csr_array(solved[:, :n]), csr_array(solved[:, n:]))


def _summed(step: csr_array, start: csr_array) -> csr_array:
    """Return ``start + step start + step² start + …`` of a nilpotent step."""
    total = start
    step.eliminate_zeros()
    while step.nnz:
        total = csr_array(total + step @ total)
        step = csr_array(step @ step)
        step.eliminate_zeros()
    return total


Block = tuple[Index, Array]
"""The rows (and columns) of a diagonal block, and the block itself."""


def _inverse(
    diagonal: tuple[Array, Index, Index], label: Index, size: Index
) -> tuple[csr_array, list[tuple[Index, csr_array]], list[Dependency]]:
    """Return the inverse of all small blocks, the large blocks, and the singular."""
    values, rows, columns = diagonal
    n = len(label)
    order = np.argsort(label, kind="stable")
    first = np.cumsum(size) - size
    position = np.empty(n, np.int64)
    position[order] = np.arange(n) - first[label[order]]
    single = size[label[rows]] == 1
    parts = [(1.0 / values[single], rows[single], rows[single])]
    large: list[tuple[Index, csr_array]] = []
    singular: list[Dependency] = []
    by_size = np.flatnonzero(size > 1)
    for k in np.unique(size[by_size]).tolist():
        blocks = np.flatnonzero(size == k)
        members = order[first[blocks][:, None] + np.arange(k)]
        entry = size[label[rows]] == k
        number = np.searchsorted(blocks, label[rows[entry]])
        i, j = position[rows[entry]], position[columns[entry]]
        if k > LARGEST_INVERTED:
            for b, own in enumerate(members):
                mine = number == b
                where = (i[mine], j[mine])
                large.append(
                    (own, coo_array((values[entry][mine], where), (k, k)).tocsr())
                )
            continue
        dense = np.zeros((len(blocks), k, k))
        dense[number, i, j] = values[entry]
        singular += _dependencies(members, dense)
        if not singular:
            inverted = np.linalg.inv(dense)
            shape = inverted.shape
            parts.append(
                (
                    inverted.ravel(),
                    np.broadcast_to(members[:, :, None], shape).ravel(),
                    np.broadcast_to(members[:, None, :], shape).ravel(),
                )
            )
    data, i, j = map(np.concatenate, zip(*parts, strict=True))
    return coo_array((data, (i, j)), shape=(n, n)).tocsr(), large, singular


def _balanced(dense: Array) -> tuple[Array, Array]:
    """Return blocks with rows and columns scaled to about one, and the row scales."""
    row_scale = np.ones(dense.shape[:2])
    balanced = dense.copy()
    for _ in range(3):
        for axis in (2, 1):
            largest = np.sqrt(np.abs(balanced).max(axis=axis, keepdims=True))
            largest[largest == 0.0] = 1.0
            balanced /= largest
            if axis == 2:
                row_scale /= largest[:, :, 0]
    return balanced, row_scale


def _dependencies(members: Index, dense: Array) -> list[Dependency]:
    """Return the dependent rows of those blocks that are singular."""
    balanced, scale = _balanced(dense)
    spectrum = np.linalg.svd(balanced, compute_uv=False)
    suspects = np.flatnonzero(spectrum[:, -1] < RANK_TOLERANCE * spectrum[:, 0])
    return [_dependency(members[b], balanced[b], scale[b]) for b in suspects.tolist()]


def _dependency(members: Index, block: Array, scale: Array) -> Dependency:
    """Return which rows of a singular block follow from its others."""
    _, triangle, order = qr(block.T, mode="economic", pivoting=True)
    pivots = np.abs(np.diag(triangle))
    rank = int(np.sum(pivots > RANK_TOLERANCE * pivots[0] * len(pivots)))
    rank = min(rank, len(pivots) - 1)
    weights = np.linalg.solve(triangle[:rank, :rank], triangle[:rank, rank:]).T
    kept, extra = order[:rank], order[rank:]
    weights = weights * scale[kept] / scale[extra][:, None]
    return Dependency(members[extra], members[kept], weights, members)


def _with_large(
    solved: csr_array, known: csr_array, large: list[tuple[Index, csr_array]]
) -> tuple[csr_array, list[Dependency]]:
    """Add the rows of large blocks to `solved`, factorising each block sparsely."""
    for members, block in large:
        row = 1.0 / abs(block).max(axis=1).toarray().ravel()
        try:
            factor = splu((diags_array(row) @ block).tocsc())
        except RuntimeError:  # SuperLU: the factor is exactly singular
            return solved, _dependencies(members[None], block.toarray()[None])
        pivots = np.abs(factor.U.diagonal())
        if pivots.min() < RANK_TOLERANCE * pivots.max():
            found = _dependencies(members[None], block.toarray()[None])
            if found:
                return solved, found
        own = csr_array(diags_array(row) @ known[members])
        used = np.unique(own.indices)
        dense = factor.solve(own[:, used].toarray())
        i, j = np.nonzero(dense)
        where = (members[i], used[j])
        solved = csr_array(solved + coo_array((dense[i, j], where), known.shape))
    return solved, []
