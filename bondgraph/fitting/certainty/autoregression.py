"""From correlations to autoregressions: pooled autocovariance, Levinson and Durbin."""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Order(NamedTuple):
    """One order of the recursion.

    ``coefficients`` a_1 … a_p of ``r_k = Σ a_i r_{k-i} + e_k``; ``reflection`` is the
    partial correlation at lag p, ``error`` the variance of e.
    """

    coefficients: Array
    reflection: float
    error: float


def autocovariance(residual: Array, edges: tuple[int, ...], lags: int) -> Array:
    """Return the autocovariance at lags 0 … `lags`, pooled over windows.

    Parameters
    ----------
    residual
        Windows end to end, (n,).
    edges
        Window k holds the samples ``edges[k]:edges[k + 1]``.
    """
    total = np.zeros(lags + 1)
    for start, stop in pairwise(edges):
        own = residual[start:stop]
        for lag in range(min(lags + 1, len(own))):
            total[lag] += float(own[lag:] @ own[: len(own) - lag])
    return total / len(residual)


def levinson(covariance: Array, *, largest: float = 1.0) -> Iterator[Order]:
    """Yield the autoregressions of order 1, 2, … of an autocovariance.

    It ends where nothing is left to explain.

    Parameters
    ----------
    covariance
        At lags 0, 1, …; in any unit, which is that of ``error`` then.
    largest
        Size at which reflections are clipped, so that the model stays stable.
    """
    coefficients, error = np.zeros(0), float(covariance[0])
    for order in range(1, len(covariance)):
        past = covariance[1:order][::-1]
        miss = float(covariance[order] - coefficients @ past) / error
        reflection = float(np.clip(miss, -largest, largest))
        coefficients = np.append(
            coefficients - reflection * coefficients[::-1], reflection
        )
        error *= 1.0 - reflection**2
        if error <= 0.0:
            return
        yield Order(coefficients, reflection, error)
