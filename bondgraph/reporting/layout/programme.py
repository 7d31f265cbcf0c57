"""Linear programmes whose answers are whole numbers, solved by HiGHS.

Both that occur here, flows in a network and differences between coordinates, have
totally unimodular matrices: the simplex method ends at a whole-number corner.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

Values = npt.NDArray[Any]


def whole_minimum(
    cost: Values,
    terms: tuple[Values, Values, Values],
    right: Values,
    *,
    upper: Values | None = None,
    exact: bool,
) -> Values:
    """Return the x ≥ 0 of least ``cost · x`` with ``A x = right``, or ``≤`` it.

    Parameters
    ----------
    cost, right
        The objective and the right-hand side.
    terms
        Values, rows and columns of A; terms at the same place are added.
    upper
        Upper bounds of x.
    exact
        Whether the rows are equations.
    """
    from scipy.optimize import linprog  # noqa: PLC0415  (0.5 s, for pictures only)
    from scipy.sparse import csr_array  # noqa: PLC0415

    entries, rows, columns = terms
    matrix: Any = csr_array((entries, (rows, columns)), shape=(len(right), len(cost)))
    limits = np.full(len(cost), np.inf) if upper is None else upper
    bounds: Any = np.column_stack([np.zeros(len(cost)), limits])
    rules: dict[str, Any] = (
        {"A_eq": matrix, "b_eq": right} if exact else {"A_ub": matrix, "b_ub": right}
    )
    found: Any = linprog(cost, bounds=bounds, method="highs-ds", **rules)
    assert found.status == 0, found.message
    values: Values = np.rint(found.x).astype(int)
    return values
