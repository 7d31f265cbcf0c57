"""Inverses of normal equations, less what the data do not determine."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TINY = 1e-75
"""A direction of a smaller scale moves nothing: the inverse of its square is no number
that anything could be multiplied by.
"""


def truncated_inverse(matrix: Array, tolerance: float = 1e-13) -> Array:
    """Return the pseudo-inverse of symmetric matrices (…, n, n), diagonals scaled.

    Directions whose scaled eigenvalue is below `tolerance` of the largest are left out,
    so that what the data do not determine is not moved.
    """
    if matrix.shape[-1] == 0:
        return matrix
    diagonal = np.einsum("...ii->...i", matrix)
    scale = np.sqrt(np.maximum(diagonal, 0.0))
    moves = scale >= TINY
    # Nearly always everything moves, and fits ask very often.
    if moves.all():
        outer = scale[..., :, None] * scale[..., None, :]
        scaled = matrix / outer
    else:
        scale = np.where(moves, scale, 1.0)
        outer = scale[..., :, None] * scale[..., None, :]
        both = moves[..., :, None] & moves[..., None, :]
        scaled = np.where(both, matrix / outer, 0.0)
    values, vectors = np.linalg.eigh(scaled)
    keep = values > tolerance * np.maximum(values[..., -1:], 1e-300)
    if keep.all():
        inverse_values = 1.0 / values
    else:
        inverse_values = np.where(keep, 1.0 / np.where(keep, values, 1.0), 0.0)
    inverse = (vectors * inverse_values[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    result: Array = inverse / outer
    return result
