"""A portmanteau test against white noise that knows what the fit took."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.adequacy.coloured import correlations

Array = NDArray[np.float64]
MOST_LAGS = 20
DRAWS = 199
SAMPLES_PER_LAG = 3


def white_p_value(
    residual: Array,
    edges: tuple[int, ...],
    treat: Callable[[Array], Array],
    random: np.random.Generator,
) -> float | None:
    """Return the chance that white noise would look as correlated as the residual.

    The sum of squared autocorrelations (Box and Pierce 1970), against white noise from
    which parameters and initial states have taken their share. None where windows are
    too short to have correlations.

    Parameters
    ----------
    treat
        Takes draws (n, m) and removes what the fit would.
    """
    shortest = min(b - a for a, b in pairwise(edges))
    lags = min(MOST_LAGS, shortest // SAMPLES_PER_LAG)
    if lags < 1 or not np.any(residual):
        return None
    own = _portmanteau(residual, edges, lags)
    # Signs and order carry all correlation: permuted residuals are white.
    noise = np.stack([random.permutation(residual) for _ in range(DRAWS)], axis=1)
    drawn = [_portmanteau(column, edges, lags) for column in treat(noise).T]
    return (1.0 + float(np.sum(np.array(drawn) >= own))) / (DRAWS + 1.0)


def _portmanteau(residual: Array, edges: tuple[int, ...], lags: int) -> float:
    return float(np.sum(correlations(residual, edges, lags)[1:] ** 2))
