"""The gain of one model over another on data that neither was fitted to, and its error.

Three tests share the level, for what is true shows in different ways: in the sum of
squared errors; in the mean log ratio, which is the likelihood with a noise of its own
in every chunk (a few chunks with large errors hide in the sum what all of them show
there); and in the surprise at every step, given what the errors just before had been,
which needs no long recording where errors change slowly.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr

from bondgraph.diagnosis.evidence.left_out import LeftOutErrors

Array = NDArray[np.float64]
SHAPE = 0.01
"""So much of what earlier findings explain may be the shape of their laws: no law of a
library is exact.
"""

EXACT = 0.001
"""But no more than this where all findings together leave next to nothing: a law that
only mends the shape of another leaves what it does not mend. A judgement: of strangers'
machines three second laws of so little were true and left nothing beyond noise, and of
two that left 3 and 4 thousandths one was.
"""

MENDED = 0.1
"""What is left is at least this share of a shape that another law mends."""

MERE_SHAPE = 0.5
"""A finding of which less than this share is more than shape ends the search."""


@dataclass(frozen=True, slots=True)
class Gain:
    """Relative reduction of the squared error on left-out chunks, with its error.

    ``p_value`` is one-sided, for the hypothesis that there is no reduction.
    """

    value: float
    std: float
    p_value: float

    def __str__(self) -> str:
        """Return it in percent, to two digits of its error, one decimal at least."""
        value, std = 100.0 * self.value, 100.0 * self.std
        decimals = max(1 - math.floor(math.log10(std)), 1) if std > 0.0 else 1
        return f"{value:.{decimals}f} ± {std:.{decimals}f} %"


def compare(before: LeftOutErrors, after: LeftOutErrors) -> Gain:
    """Return how much smaller the error is `after`, with its jackknife error."""
    b, a = before.chunks, after.chunks
    if b.sum() <= 0.0:
        return Gain(0.0, 0.0, 1.0)
    value, std = reduction(before, after)
    if std == 0.0:
        return Gain(value, 0.0, 0.0 if value > 0 else 1.0)
    n = len(b)
    tests = [float(stdtr(n - 1, -value / std)), _above_zero(_log_ratios(b, a))]
    if before.surprise.size:
        tests.append(_above_zero(before.surprise - after.surprise))
    return Gain(value, std, min(len(tests) * min(tests), 1.0))


def reduction(before: LeftOutErrors, after: LeftOutErrors) -> tuple[float, float]:
    """Return by which share the error is smaller `after`, and its jackknife error."""
    b, a = before.chunks, after.chunks
    total, rest = float(b.sum()), float(a.sum())
    if total <= 0.0:
        return 0.0, 0.0
    left = (rest - a) / np.maximum(total - b, 1e-300)  # without each chunk in turn
    n = len(b)
    std = float(np.sqrt((n - 1) / n * ((left - left.mean()) ** 2).sum()))
    return 1.0 - rest / total, std


def beside_earlier(
    gains: Sequence[float],
    without: Sequence[float | None] = (),
    remaining: float = 1.0,
) -> list[float]:
    """Return for each finding how far it is more than the shape of the others.

    What it explains over that and what may be shape of what they do, all of the first
    model's left-out error.

    Parameters
    ----------
    gains
        Of each finding over the model that it was added to.
    without
        The share of the first model's error that the others leave, of a finding that
        was added beside later ones, too; None of one that was added to what the ones
        before it leave.
    remaining
        The share of it that all of them leave beyond noise, where that is known.
    """
    shape = min(SHAPE, max(EXACT, remaining / MENDED))
    shares, left = [], 1.0
    known = [*without, *(None for _ in gains[len(without) :])]
    for gain, beside in zip(gains, known, strict=True):
        left = left if beside is None else min(beside, 1.0)
        own = max(left * gain, 1e-12)
        shares.append(own / (own + shape * (1.0 - left)))
        left -= own
    return shares


def _log_ratios(before: Array, after: Array) -> Array:
    tiny = 1e-12 * max(before.max(), after.max())
    ratios: Array = np.log((before + tiny) / (after + tiny))
    return ratios


def _above_zero(values: Array) -> float:
    """Return the p-value of a t-test that the mean is not above zero."""
    n = len(values)
    std = float(values.std(ddof=1)) / np.sqrt(n)
    if std == 0.0:
        return 0.0 if values[0] > 0.0 else 1.0
    return float(stdtr(n - 1, -float(values.mean()) / std))
