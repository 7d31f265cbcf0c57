"""Sparse factors in an order made once for a pattern.

A machine built as a chain or a tree has a narrow band once its rows are matched and
numbered along the chain; eliminating in that order is three times faster per solution
than the order that minimises fill. Elsewhere the latter is taken.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import SuperLU, splu

from bondgraph.errors import EquationError
from bondgraph.numeric.implicit.blocks import matched

Array = NDArray[np.float64]
Index = NDArray[np.int64]

NARROW = 16
"""Up to this many columns per row between the first entry and the diagonal."""


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """A numbering of rows and columns, and how to eliminate after it."""

    rows: Index
    columns: Index
    method: Literal["NATURAL", "COLAMD"]

    def factorised(self, matrix: csr_array) -> "Factor":
        """Return the factors of a matrix with this order's pattern.

        Raises
        ------
        EquationError
            If the matrix is singular.
        """
        turned = csc_array(csr_array(matrix[self.rows])[:, self.columns])
        scale = abs(turned).max(axis=0).toarray().ravel()
        scale[scale == 0.0] = 1.0
        turned.data /= np.repeat(scale, np.diff(turned.indptr))
        try:
            return Factor(self, scale, splu(turned, permc_spec=self.method))
        except RuntimeError as error:  # SuperLU says only that a pivot is zero
            raise EquationError(
                f"The sparse system is singular ({error}).",
                (),
                "Make an implicit_state_space of the graph: it names what is open.",
            ) from None


@dataclass(frozen=True, slots=True, eq=False)
class Factor:
    """The factors of a matrix."""

    order: Order
    scale: Array
    factors: SuperLU

    def solve(self, right: Array) -> Array:
        """Return the solution for one right side."""
        found = np.empty_like(right)
        found[self.order.columns] = self.factors.solve(right[self.order.rows])
        found[self.order.columns] /= self.scale
        return found


def order_for(matrix: csr_array) -> Order:
    """Return a good order for matrices with the pattern of `matrix`."""
    n = matrix.shape[0]
    plain = np.arange(n)
    column = matched(matrix)
    if np.any(column < 0):
        return Order(plain, plain, "COLAMD")
    row = np.empty(n, np.int64)
    row[column] = plain
    square = csr_array(matrix[row])
    new = reverse_cuthill_mckee(square, symmetric_mode=False).astype(np.int64)
    position = np.empty(n, np.int64)
    position[new] = plain
    entries = square.tocoo()
    i, j = (position[axis] for axis in entries.coords)
    reach = np.zeros(n, np.int64)
    np.maximum.at(reach, i, np.abs(i - j))
    if reach.sum() <= NARROW * n:
        return Order(row[new], new, "NATURAL")
    return Order(row, plain, "COLAMD")
