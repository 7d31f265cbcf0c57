"""What is known of a law's numbers but for a scale that the model itself leaves open.

Where a motor's current is not measured, its speed tells its constant, its inertia and
its friction only in proportion to each other. Of dry friction beside them it tells as
much: no number of newton metres, and yet surely that there is some.
"""

import numpy as np

from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.estimate import FittedModel

BEYOND = 0.1
"""A direction, of length 1, that leaves others by less than this is one of them."""


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
    names = final.problem.free_names
    if not set(names) >= set(base.problem.free_names):
        return {}
    known = uncertainty(final.problem, final.optimum)
    if not len(known.null):
        return {}
    own = [names.index(name) for name in base.problem.free_names]
    shared = known.null[:, own]
    if np.linalg.matrix_rank(shared, tol=BEYOND) < len(shared):
        return {}
    scales, _ = np.linalg.qr(uncertainty(base.problem, base.optimum).null.T)
    if np.abs(shared - shared @ scales @ scales.T).max() > BEYOND:
        return {}
    errors = np.sqrt(np.diag(known.covariance))
    return {
        name: float(error)
        for name, error, std in zip(names, errors, known.std, strict=True)
        if np.isnan(std)
    }
