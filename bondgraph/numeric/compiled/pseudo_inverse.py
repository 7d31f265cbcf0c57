"""Pseudo-inverses of small symmetric matrices, compiled: Jacobi's rotations.

A fit asks for thousands, of two or three rows each: a library's eigenvalues are no
better there, and the calls around them take ten times as long as these rotations.
"""

import math

import numpy as np

from bondgraph.numeric.compiled.loops import Array, compiled, lean

SWEEPS = 40
"""Far more than any matrix of finite numbers needs: six to ten."""

NEGLIGIBLE = 1e-17
"""Of the largest diagonal element: what is smaller beside the diagonal is rounding."""


@compiled
def pseudo_inverses(
    matrices: Array, tolerance: float, tiny: float, result: Array
) -> None:
    """Write the pseudo-inverse of each matrix; zeros where its numbers are not finite.

    Parameters
    ----------
    matrices, result
        (n_matrices, n, n). Lower triangles are read.
    tolerance
        Eigenvalues below this part of the largest, with the diagonal scaled to ones,
        are left out.
    tiny
        A row whose diagonal's root is smaller moves nothing and is left out.
    """
    count, n = matrices.shape[0], matrices.shape[1]
    a, v, scale = np.empty((n, n)), np.empty((n, n)), np.empty(n)
    for which in range(count):
        _scale(matrices[which], tiny, a, v, scale)
        _diagonalise(a, v, n)
        largest = 1e-300
        for k in range(n):
            largest = max(largest, a[k, k])
        for i in range(n):
            for j in range(i + 1):
                total = 0.0
                for k in range(n):
                    if a[k, k] > tolerance * largest:
                        total += v[i, k] * v[j, k] / a[k, k]
                if scale[i] > 0.0 and scale[j] > 0.0:
                    total /= scale[i] * scale[j]
                else:
                    total = 0.0
                result[which, i, j] = result[which, j, i] = total


@lean
def _scale(matrix: Array, tiny: float, a: Array, v: Array, scale: Array) -> None:
    """Write the matrix with ones on its diagonal, and `v` as the identity."""
    n, finite = len(scale), True
    for i in range(n):
        for j in range(i + 1):
            finite = finite and math.isfinite(matrix[i, j])
    for i in range(n):
        root = math.sqrt(max(matrix[i, i], 0.0)) if finite else 0.0
        scale[i] = root if root >= tiny else 0.0
        for j in range(i + 1):
            moves = scale[i] > 0.0 and scale[j] > 0.0
            a[i, j] = matrix[i, j] / (scale[i] * scale[j]) if moves else 0.0
            a[j, i] = a[i, j]
            v[i, j] = v[j, i] = 1.0 if i == j else 0.0


@lean
def _diagonalise(a: Array, v: Array, n: int) -> None:
    """Turn `a` until it is diagonal, and `v` with it."""
    for _ in range(SWEEPS):
        largest = 0.0
        for k in range(n):
            largest = max(largest, abs(a[k, k]))
        turned = False
        for p in range(n):
            for q in range(p + 1, n):
                if abs(a[p, q]) > NEGLIGIBLE * largest:
                    turned = True
                    _turn(a, v, n, p, q)
        if not turned:
            break


@lean
def _turn(a: Array, v: Array, n: int, p: int, q: int) -> None:
    """Rotate rows and columns `p` and `q` so that ``a[p, q]`` vanishes."""
    ratio = (a[q, q] - a[p, p]) / (2.0 * a[p, q])
    tangent = 1.0 / (abs(ratio) + math.sqrt(1.0 + ratio * ratio))
    if ratio < 0.0:
        tangent = -tangent
    cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
    sine = tangent * cosine
    for k in range(n):
        left, right = a[k, p], a[k, q]
        a[k, p], a[k, q] = cosine * left - sine * right, sine * left + cosine * right
    for k in range(n):
        left, right = a[p, k], a[q, k]
        a[p, k], a[q, k] = cosine * left - sine * right, sine * left + cosine * right
        left, right = v[k, p], v[k, q]
        v[k, p], v[k, q] = cosine * left - sine * right, sine * left + cosine * right
    a[p, q] = a[q, p] = 0.0
