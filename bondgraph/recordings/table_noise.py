"""The noise of a steady table, from rows that were nearly at the same operating point.

What a table reads is a function of its inputs. Each row is held against a polynomial
through its nearest rows, scaled so that white noise of standard deviation s gives s.
Two degrees that agree show that no more than noise is left; where they do not, or the
rows are too few for both, nothing is said: the noise would be told too large, and
physics be taken for it.

After the residual variance of nearest neighbours (Evans and Jones, Proceedings of the
Royal Society A 458, 2002) and of difference sequences (Hall, Kay and Titterington,
Biometrika 77, 1990).
"""

from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from bondgraph.recordings.noise import (
    MAD_TO_STD,
    SAMENESS,
    NoiseEstimate,
    quantisation,
)

Array = NDArray[np.float64]
DEGREES = (1, 2)
NEIGHBOURS = 2
"""So many nearest rows for each coefficient of the polynomial."""

MOST_ROWS = 4000
"""Enough for a median; of longer tables, evenly spaced rows are held against it."""


def table_noise(inputs: Array, values: Array) -> NoiseEstimate | None:
    """Return the noise of one channel of a table, or None where it does not show.

    Parameters
    ----------
    inputs
        What was set in each row, (n, nu).
    values
        What was read there, (n,), in any unit; NaN where nothing was.
    """
    there = np.isfinite(values) & np.isfinite(inputs).all(axis=1)
    moved = np.ptp(inputs[there], axis=0) > 0.0 if there.any() else np.zeros(0, bool)
    if not moved.any():
        return None
    set_there, read = inputs[there][:, moved], values[there]
    set_there = set_there / set_there.std(axis=0)
    fewest = 2 * NEIGHBOURS * len(_exponents(set_there.shape[1], DEGREES[-1]))
    if len(read) < fewest:
        return None
    low, high = sorted(_scale(set_there, read, degree) for degree in DEGREES)
    sameness = SAMENESS + 3.0 / np.sqrt(len(read))
    if high > sameness * low:
        return None
    step = quantisation(read)
    least = 0.0 if step is None else float(step / np.sqrt(12.0))
    return NoiseEstimate(std=max(low, least), quantisation=step, white=True)


def _scale(inputs: Array, values: Array, degree: int) -> float:
    """Return the size of what rows are beside polynomials through their neighbours."""
    exponents = _exponents(inputs.shape[1], degree)
    count = NEIGHBOURS * len(exponents)
    rows = np.arange(0, len(values), -(-len(values) // MOST_ROWS))
    near = np.asarray(KDTree(inputs).query(inputs[rows], k=count + 1)[1])
    # Of rows that are there twice the nearest need not be the row itself.
    own = near == rows[:, None]
    own[~own.any(axis=1), -1] = True
    near = near[~own].reshape(len(rows), count)
    away = inputs[near] - inputs[rows][:, None, :]
    away = away / np.maximum(np.abs(away).max(axis=(1, 2), keepdims=True), 1e-300)
    terms = np.stack([(away**e).prod(axis=2) for e in exponents], axis=2)
    # The polynomial at the row itself is its first, constant coefficient.
    weights = np.linalg.pinv(terms)[:, 0, :]
    beside = values[rows] - (weights * values[near]).sum(axis=1)
    scaled = beside / np.sqrt(1.0 + (weights**2).sum(axis=1))
    return MAD_TO_STD * float(np.median(np.abs(scaled)))


def _exponents(variables: int, degree: int) -> list[NDArray[np.int64]]:
    """Return the exponents of every term of a polynomial, the constant first."""
    return [
        np.bincount(np.array(chosen, dtype=np.int64), minlength=variables)
        for total in range(degree + 1)
        for chosen in combinations_with_replacement(range(variables), total)
    ]
