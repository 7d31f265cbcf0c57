"""What is known of a law's numbers but for a scale that the model itself leaves open.

Where a motor's current is not measured, its speed tells its constant, its inertia and
its friction only in proportion to each other. Of dry friction beside them it tells as
much: no number of newton metres, and yet surely that there is some. A scale that the
recordings leave nearly open, as a stroke tells that of a brake's flows, is one as well.
"""

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.numbers import ERRORS
from bondgraph.fitting.certainty.combinations import size_of
from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.estimate import FittedModel

Array = NDArray[np.float64]
BEYOND = 0.1
"""A direction, of length 1, that leaves others by less than this is one of them."""

WEAKER = 5.0
"""A scale is nearly open whose relative error is so many times any other's."""

INVOLVED = 0.05
"""A parameter takes part in a direction, of length 1, from this share on."""


def known_in_proportion(final: FittedModel, base: FittedModel) -> dict[str, float]:
    """Return the standard errors of what is known in proportion only, by name.

    Empty where what was added leaves more undetermined than the model did alone: two
    laws of which only the sum shows are no scale. The errors are those with the scale
    held where the fit has ended.

    Parameters
    ----------
    base
        The model without additions, fitted to the same recordings.
    """
    names, before = final.problem.free_names, base.problem.free_names
    both = [name for name in before if name in names]  # A law may replace a number.
    free, errors = _open_scales(final)
    shared = free[:, [names.index(name) for name in both]]
    if not len(free) or np.linalg.matrix_rank(shared, tol=BEYOND) < len(shared):
        return {}
    opened = _open_scales(base)[0][:, [before.index(name) for name in both]]
    _, sizes, rows = np.linalg.svd(opened, full_matrices=False)
    scales = rows[sizes > BEYOND].T
    shared = shared / np.linalg.norm(shared, axis=1, keepdims=True)
    if np.abs(shared - shared @ scales @ scales.T).max() > BEYOND:
        return {}
    involved = np.abs(free).max(axis=0) > INVOLVED
    return {
        name: float(error)
        for name, error, takes_part in zip(names, errors, involved, strict=True)
        if takes_part
    }


def _open_scales(fitted: FittedModel) -> tuple[Array, Array]:
    """Return relative directions that are open, row by row, and errors beside them.

    Those along which nothing is known; where there are none, one that is known so
    little that no number along it is told from none, and far less than all others.
    """
    known = uncertainty(fitted.problem, fitted.optimum)
    if len(known.null):
        return known.null, np.sqrt(np.diag(known.covariance))
    size = size_of(fitted.optimum.theta)
    variances, directions = np.linalg.eigh(known.covariance / np.outer(size, size))
    if not _stands_out(np.sqrt(np.maximum(variances, 0.0))):
        return np.zeros((0, len(size))), known.std
    kept = directions[:, :-1] * np.sqrt(np.maximum(variances[:-1], 0.0))
    return directions[:, -1:].T, size * np.linalg.norm(kept, axis=1)


def _stands_out(errors: Array) -> bool:
    """Return whether the last of ascending relative errors is a scale by itself."""
    *others, last = errors
    return bool(last * ERRORS > 1.0 and last > WEAKER * max(others, default=0.0))
