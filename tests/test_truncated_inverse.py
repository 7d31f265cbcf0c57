"""Pseudo-inverses of normal equations: what the data determine, and no more."""

import numpy as np
import pytest

from bondgraph.fitting.truncated_inverse import truncated_inverse


def normal_equations(n, *, alike=False, still=None):
    """Return JᵀJ of eight windows; two columns alike, or one without effect."""
    slopes = np.random.default_rng(n).normal(size=(8, 40, n)) * np.logspace(0, 4, n)
    if alike:
        slopes[..., 0] = 3.0 * slopes[..., 1]
    if still is not None:
        slopes[..., still] = 0.0
    return np.swapaxes(slopes, 1, 2) @ slopes


@pytest.mark.parametrize("n", [1, 2, 3, 7])
def test_a_regular_matrix_is_inverted(n):
    matrices = normal_equations(n)
    product = truncated_inverse(matrices) @ matrices
    np.testing.assert_allclose(
        product, np.broadcast_to(np.eye(n), (8, n, n)), atol=1e-9
    )


@pytest.mark.parametrize("n", [2, 3, 7])
def test_a_direction_that_is_not_determined_is_left_out(n):
    matrices = normal_equations(n, alike=True)
    inverse = truncated_inverse(matrices)
    # As of the pseudo-inverse with the diagonal scaled to ones, column by column.
    for matrix, found in zip(matrices, inverse, strict=True):
        scale = np.sqrt(np.diag(matrix))
        expected = np.linalg.pinv(matrix / np.outer(scale, scale), 1e-13)
        np.testing.assert_allclose(found * np.outer(scale, scale), expected, atol=1e-9)


@pytest.mark.parametrize("n", [1, 3, 7])
def test_what_moves_nothing_has_no_inverse(n):
    inverse = truncated_inverse(normal_equations(n, still=n - 1))
    assert np.abs(inverse[:, n - 1, :]).max() < 1e-12
    assert np.isfinite(inverse).all()


def test_single_matrices_and_empty_ones_keep_their_shape():
    assert truncated_inverse(np.array([[4.0]])) == pytest.approx(0.25)
    assert truncated_inverse(np.zeros((5, 0, 0))).shape == (5, 0, 0)
    assert truncated_inverse(np.zeros((0, 2, 2))).shape == (0, 2, 2)
