"""Whether a series is white: the portmanteau test of Ljung and Box."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LAGS = 20


def ljung_box(white: Array, lags: int = LAGS) -> float:
    """Return the p-value for the hypothesis that a series is white.

    Parameters
    ----------
    white
        The series, with mean zero.
    lags
        How many autocorrelations are looked at.
    """
    from scipy.special import chdtrc  # noqa: PLC0415  (slow to import)

    n = len(white)
    power = float(white @ white)
    if power == 0.0 or n <= lags + 1:
        return 1.0
    rho = np.array([float(white[k:] @ white[:-k]) for k in range(1, lags + 1)]) / power
    statistic = n * (n + 2) * float((rho**2 / (n - np.arange(1, lags + 1))).sum())
    return float(chdtrc(lags, statistic))
