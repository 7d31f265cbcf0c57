"""Every effort and flow, and every rate, from independent states and inputs.

The linear rows ``G w = R y`` are solved for the efforts and flows w, where y stacks
(x, v, v̇, 1) with v the inputs and the time. Where rows are left over, they bind stored
quantities to each other and to inputs: as few as they bind become dependent, and what
binds them is differentiated, which gives the missing rows for w, because ẋ is read from
w. That is repeated until G is square, whatever the index. A block that is singular at
the given numbers (a ring of unit gain) has its dependent rows replaced by what they
leave, so that structure always tells the truth.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import (
    block_array,
    coo_array,
    csr_array,
    diags_array,
    eye_array,
    vstack,
)
from scipy.sparse.csgraph import breadth_first_order

from bondgraph.numeric.implicit.blocks import Dependency, matched, solve
from bondgraph.numeric.implicit.constraints import resolved
from bondgraph.numeric.implicit.preference import dependent_first
from bondgraph.numeric.implicit.refusals import (
    refuse_conflict,
    refuse_input_rate,
    refuse_undetermined,
)
from bondgraph.numeric.implicit.system import ImplicitSystem

Array = NDArray[np.float64]
Index = NDArray[np.int64]

ROUNDING = 1e-12
"""What is smaller than this part of the terms it is the sum of, is rounding."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reduction:
    """Efforts, flows, stored quantities and rates as linear forms of y.

    Parameters
    ----------
    powers, stored, rates
        Rows ``[.., y]`` of w, x and ẋ; columns of dependent x are empty.
    independent
        The stored quantities that are states, in the system's order.
    differentiated
        The rows of the system whose derivative was needed.
    """

    powers: csr_array
    stored: csr_array
    rates: csr_array
    independent: Index
    differentiated: Index


def reduced(
    system: ImplicitSystem, jacobian: csr_array, drives: csr_array, affine: Array
) -> Reduction:
    """Return the solution of ``jacobian (w, x) = drives v + affine``.

    Raises
    ------
    EquationError
        If the rows contradict each other or leave something open; names the elements.
    """
    work = _Work(system, jacobian, drives, affine)
    while not work.solved():
        pass
    return work.answer()


def combined(weights: csr_array, rows: csr_array) -> csr_array:
    """Return ``weights @ rows`` without what only rounding left."""
    value = csr_array(weights @ rows)
    size = csr_array(abs(weights) @ abs(rows))
    kept = (abs(value) - ROUNDING * size) > 0
    found = csr_array(value.multiply(kept))
    found.eliminate_zeros()
    return found


class _Work:
    """The rows while they are being reduced."""

    def __init__(
        self,
        system: ImplicitSystem,
        jacobian: csr_array,
        drives: csr_array,
        affine: Array,
    ) -> None:
        self.system = system
        n = system.n_powers
        n_rows = jacobian.shape[0]
        self.G = csr_array(jacobian[:, :n])
        rates = csr_array(drives.shape)
        known = [-jacobian[:, n:], drives, rates, csr_array(affine[:, None])]
        self.R = block_array([known], format="csr")
        self.first_input = system.n_states
        self.first_rate = self.first_input + drives.shape[1]
        self.size = self.R.shape[1]
        self.stored = csr_array(eye_array(system.n_states, self.size))
        self.rate_of = coo_array(
            (
                system.rate_signs,
                (np.arange(system.n_states), system.rate_columns),
            ),
            shape=(system.n_states, n),
        ).tocsr()
        self.owners = system.owners
        self.origin = np.arange(n_rows)
        self.dependent = np.zeros(system.n_states, bool)
        self.differentiated: list[Index] = []
        self.order: Index | None = None
        self.powers: csr_array | None = None

    def solved(self) -> bool:
        """Solve, or take one step towards it."""
        column = matched(self.G)
        spare = np.flatnonzero(column < 0)
        if len(spare):
            self._use(spare, column)
            return False
        n_rows, n_columns = self.G.shape
        if n_rows < n_columns:
            self._refuse_undetermined(column)
        row = np.empty(n_columns, np.int64)
        row[column] = np.arange(n_rows)
        self.powers = self._solve_part(row, np.arange(n_columns))
        return self.powers is not None

    def answer(self) -> Reduction:
        """Return what was found."""
        assert self.powers is not None
        differentiated = [np.zeros(0, np.int64), *self.differentiated]
        return Reduction(
            powers=self.powers,
            stored=self.stored,
            rates=csr_array(self.rate_of @ self.powers),
            independent=np.flatnonzero(~self.dependent),
            differentiated=np.unique(np.concatenate(differentiated)),
        )

    def _solve_part(self, rows: Index, columns: Index) -> csr_array | None:
        """Solve some rows for their matched columns; None if rows were replaced."""
        part = csr_array(csr_array(self.G[rows])[:, columns])
        found = solve(part, csr_array(self.R[rows]))
        if isinstance(found, list):
            self._expose(found, rows, columns)
            return None
        return found

    def _expose(
        self, dependencies: list[Dependency], rows: Index, columns: Index
    ) -> None:
        """Replace dependent rows by what they have beyond the rows they follow from."""
        n = len(self.owners)
        parts = [(np.ones(n), np.arange(n), np.arange(n))]
        G = self.G.tocoo()
        gone = np.zeros(G.nnz, bool)
        for found in dependencies:
            extra = rows[found.rows]
            i, j = np.meshgrid(extra, rows[found.others], indexing="ij")
            parts.append((-found.weights.ravel(), i.ravel(), j.ravel()))
            inside = np.isin(G.coords[1], columns[found.columns])
            gone |= inside & np.isin(G.coords[0], extra)
        data, i, j = map(np.concatenate, zip(*parts, strict=True))
        operation = coo_array((data, (i, j)), shape=(n, n)).tocsr()
        # Inside its block a dependent row vanishes, exactly.
        rest = combined(operation, self.G).tocoo()
        keep = np.ones(rest.nnz, bool)
        for found in dependencies:
            inside = np.isin(rest.coords[1], columns[found.columns])
            keep &= ~(inside & np.isin(rest.coords[0], rows[found.rows]))
        where = (rest.coords[0][keep], rest.coords[1][keep])
        self.G = coo_array((rest.data[keep], where), shape=rest.shape).tocsr()
        self.R = combined(operation, self.R)

    def _over(self, spare: Index, column: Index) -> Index:
        """Return the matched rows that alternating paths reach from left-over rows."""
        n_rows, n_columns = self.G.shape
        row_of = np.full(n_columns, -1)
        matched_rows = np.flatnonzero(column >= 0)
        row_of[column[matched_rows]] = matched_rows
        G = self.G.tocoo()
        heads = row_of[G.coords[1]]
        real = heads >= 0
        tails = np.concatenate([G.coords[0][real], np.full(len(spare), n_rows)])
        links = coo_array(
            (np.ones(len(tails)), (tails, np.concatenate([heads[real], spare]))),
            shape=(n_rows + 1, n_rows + 1),
        ).tocsr()
        reached = breadth_first_order(links, n_rows, return_predecessors=False)
        over = np.zeros(n_rows + 1, bool)
        over[reached] = True
        over[spare] = False
        over[n_rows] = False
        return np.flatnonzero(over)

    def _use(self, spare: Index, column: Index) -> None:
        """Let left-over rows make stored quantities dependent."""
        over = self._over(spare, column)
        columns = column[over]
        known = self._solve_part(over, columns)
        if known is None:
            return
        part = csr_array(csr_array(self.G[spare])[:, columns])
        weights = block_array([[eye_array(len(spare)), -part]], format="csr")
        rows = csr_array(vstack([self.R[spare], known]))
        constraint = combined(weights, rows)
        involved = np.concatenate([over, spare])
        if constraint[:, self.first_rate : self.size - 1].nnz:
            refuse_input_rate(self.system, self.owners[involved])
        dependent, following = resolved(
            constraint, self.system.n_states, self._preference()
        )
        if len(dependent) < len(spare):
            self._refuse(constraint, involved, column)
        self._substitute(dependent, following)
        self.differentiated.append(self.origin[involved])
        self._differentiate(dependent, following, spare)

    def _preference(self) -> Index:
        """Return the stored quantities, those first that may become dependent first."""
        if self.order is None:
            self.order = dependent_first(self.system)
        found: Index = self.order[~self.dependent[self.order]]
        return found

    def _substitute(self, dependent: Index, following: csr_array) -> None:
        """Put ``y_dependent = following y`` into everything."""
        kept = np.ones(self.size)
        kept[dependent] = 0.0
        put = coo_array(
            (np.ones(len(dependent)), (dependent, np.arange(len(dependent)))),
            shape=(self.size, len(dependent)),
        )
        change = csr_array(diags_array(kept) + put @ following)
        self.R = combined(self.R, change)
        self.stored = combined(self.stored, change)
        self.dependent[dependent] = True

    def _differentiate(
        self, dependent: Index, following: csr_array, spare: Index
    ) -> None:
        """Replace the left-over rows by ``ẋ_dependent = d(following y)/dt``."""
        n = self.system.n_states
        new = self.rate_of[dependent] - following[:, :n] @ self.rate_of
        inputs = following[:, n : self.first_rate]
        right = block_array(
            [
                [
                    csr_array((len(dependent), self.first_rate)),
                    inputs,
                    csr_array((len(dependent), 1)),
                ]
            ],
            format="csr",
        )
        rest = np.ones(len(self.owners), bool)
        rest[spare] = False
        self.G = csr_array(vstack([self.G[rest], new], format="csr"))
        self.G.eliminate_zeros()
        self.R = csr_array(vstack([self.R[rest], right], format="csr"))
        owners = self.system.storage_owners[dependent]
        self.owners = np.concatenate([self.owners[rest], owners])
        fresh = np.full(len(dependent), -1)
        self.origin = np.concatenate([self.origin[rest], fresh])

    def _refuse(self, constraint: csr_array, involved: Index, column: Index) -> None:
        """Refuse rows that bind no stored quantity: a conflict, or said twice."""
        sources = constraint[:, self.first_input :]
        if sources.nnz:
            refuse_conflict(self.system, self.owners[involved], sources)
        self._refuse_undetermined(column)

    def _refuse_undetermined(self, column: Index) -> None:
        open_columns = np.ones(self.G.shape[1], bool)
        open_columns[column[column >= 0]] = False
        refuse_undetermined(self.system, np.flatnonzero(open_columns))
