"""Where in time a model explains what another one leaves."""

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.estimate import FittedModel


def share_explained(
    before: FittedModel, after: FittedModel, there: NDArray[np.bool_]
) -> float:
    """Return the share of what one model explains beyond another in some samples.

    Of the squared error, each output weighed as it was fitted; 0 where nothing is
    explained.

    Parameters
    ----------
    there
        Which samples, (n,).
    """
    squares = before.residuals() ** 2 - after.residuals() ** 2
    gained = np.nansum(squares / before.problem.sigma**2, axis=1)
    whole = float(gained.sum())
    return float(gained[there].sum()) / whole if whole > 0.0 else 0.0
