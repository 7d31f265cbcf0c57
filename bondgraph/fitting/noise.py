"""How measurement noise is correlated in time: a choice, as an object.

Coloured noise leaves simulation-error estimates unbiased but wasteful, since it counts
neighbouring samples as if each were news. Where the noise is a first-order
autoregression, r_k = φ r_{k-1} + innovation, the differences

    (r_k - φ r_{k-1}) / sqrt(1 - φ²)

are white and of the same size, and least squares on them is efficient (Cochrane and
Orcutt, JASA 44, 1949; the first sample of a window stays as it is, after Prais and
Winsten). φ is estimated per output from the residuals.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LARGEST = 0.999


@dataclass(frozen=True, slots=True)
class WhiteNoise:
    """Every sample is weighed as news of its own."""


@dataclass(frozen=True, slots=True)
class AutoregressiveNoise:
    """First-order coloured noise per output, estimated along with the parameters."""


Noise = WhiteNoise | AutoregressiveNoise


def first_samples(edges: tuple[int, ...]) -> NDArray[np.int64]:
    """Return the row of the first sample of each window."""
    return np.array(edges[:-1], dtype=np.int64)


def whitened(
    values: Array,
    correlation: Array,
    edges: tuple[int, ...],
    measured: NDArray[np.bool_],
) -> Array:
    """Return the innovations of values (n, ny, …) under φ per output (ny,).

    A sample after one that was not measured stays as it is.
    """
    if not correlation.any():
        return values
    known = np.zeros(measured.shape, dtype=bool)
    known[1:] = measured[1:] & measured[:-1]
    known[first_samples(edges)] = False
    phi = np.where(known, correlation, 0.0)
    phi = phi.reshape(phi.shape + (1,) * (values.ndim - 2))
    before = np.zeros_like(values)
    before[1:] = values[:-1]
    result: Array = (values - phi * before) / np.sqrt(1.0 - phi**2)
    return result


def lag_one(residuals: Array, edges: tuple[int, ...], extra: int) -> Array:
    """Return φ per output from residuals (n, ny) that are zero where not measured.

    Parameters
    ----------
    extra
        Parameters that were fitted; with the mean they make φ come out too small, by
        about (1 + 3φ)/n (Kendall, Biometrika 41, 1954; Marriott and Pope, ibid.),
        which is put back.
    """
    inside = np.ones(len(residuals) - 1, dtype=bool)
    starts = first_samples(edges)[1:]
    inside[starts - 1] = False
    product = (residuals[1:] * residuals[:-1])[inside].sum(axis=0)
    power = (residuals**2).sum(axis=0)
    phi = product / np.maximum(power, 1e-300)
    count = max(len(residuals) - extra, 2)
    raised = phi + (1.0 + 3.0 * phi) / count
    result: Array = np.clip(raised, -LARGEST, LARGEST)
    return result
