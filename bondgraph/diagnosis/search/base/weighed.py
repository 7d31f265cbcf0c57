"""Outputs weighed anew after a finding, where what is left of one of them is hidden.

Outputs are weighed by what the first model leaves of them. A law that was found may
take nearly all of that from one, and nothing from another that was noise already. At
the weights of before that noise then drowns whatever is left of the first.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.leftover import ADEQUATE_RATIO
from bondgraph.fitting.estimate import FittedModel, weigh

Array = NDArray[np.float64]
HIDDEN = 0.25
"""An output with less than this share of the largest weighed residual is hidden."""

ITERATIONS = 30


def weighed_anew(fitted: FittedModel, noise: Array) -> FittedModel:
    """Return the model fitted with each output weighed by what is left of it.

    Only where one is hidden and shows more than its noise.

    Parameters
    ----------
    noise
        Residual per output that noise excuses, 0 where it is not known.
    """
    left = np.sqrt(np.nanmean(fitted.residuals() ** 2, axis=0))
    weighed = left / fitted.problem.sigma
    hidden = (weighed < HIDDEN * weighed.max()) & (left > ADEQUATE_RATIO * noise)
    if not hidden.any():
        return fitted
    settings = replace(fitted.settings, iterations=ITERATIONS)
    problem, optimum = weigh(fitted.problem, fitted.optimum, settings)
    if not np.isfinite(optimum.cost):
        return fitted
    return replace(fitted, problem=problem, optimum=optimum)
