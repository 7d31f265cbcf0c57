"""How surprising each sample is, given the errors just before it.

The errors of a model are followed by an autoregression; what it does not foresee is
white, and its negative log-likelihood is the surprise (Ljung, *System Identification*,
1999, 7.4). A model that is wrong in a way that its own past errors tell is surprised no
more than the noise allows, and errors that change slowly are not counted as if every
sample said something new.
"""

from collections.abc import Sequence
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.certainty.colour import MOST_ORDER, Colour, colour_of

Array = NDArray[np.float64]
LOST = 1e6
"""The surprise at samples where the model could not be simulated."""


def surprise(residuals: Array, windows: Sequence[slice], fitted: int) -> Array:
    """Return the surprise at every sample, in nats, summed over outputs; (n,).

    The autoregression, at most a dozen numbers per output, is that of all samples. The
    first samples of a window, which have no past, are not scored; rows of a table need
    none, for each is a point of operation of its own.

    Parameters
    ----------
    residuals
        (n, ny).
    windows
        Where each window's samples are.
    fitted
        How many unknowns were fitted to them.
    """
    if not np.isfinite(residuals).all():
        return np.full(len(residuals), LOST)
    unscored = 0 if len(windows) == len(residuals) else MOST_ORDER
    edges = tuple(accumulate((w.stop - w.start for w in windows), initial=0))
    total = np.zeros(len(residuals))
    for column in residuals.T:
        colour = colour_of(column, edges, fitted)
        for window in windows:
            total[window] += _of_steps(column[window], colour, unscored)
    return total


def _of_steps(residual: Array, colour: Colour, unscored: int) -> Array:
    """Return the surprise at every sample of one output in one window.

    Parameters
    ----------
    unscored
        How many of the first samples have no past to be foreseen from.
    """
    if colour.innovation <= 0.0:
        return np.zeros(len(residual))
    squared = colour.innovations(residual) ** 2
    nats: Array = 0.5 * (squared / colour.innovation + np.log(colour.innovation))
    nats[:unscored] = 0.0
    return nats
