"""A sensor's line y = a u + b from calibration points by least squares.

Here the errors of y are random, independent and of one variance. Where they are only
known to be bounded, see `flegx_models.characterisation.feasible_lines`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import t as student

from flegx_models.characterisation.errors import CharacterisationError

FloatArray = NDArray[np.float64]
Interval = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Line:
    """y = slope · u + offset."""

    slope: float
    offset: float

    def __call__(self, u: ArrayLike) -> FloatArray:
        """Return the line's values at `u`."""
        return self.slope * np.asarray(u, dtype=float) + self.offset


@dataclass(frozen=True, slots=True, kw_only=True)
class LeastSquaresLine:
    """The line of least squares and how well the points determine it.

    Parameters
    ----------
    covariance
        Of (slope, offset), from the residuals' variance with N - 2 degrees of freedom.
    residual_std
        Standard deviation of the errors of y.
    """

    line: Line
    covariance: tuple[tuple[float, float], tuple[float, float]]
    residual_std: float
    degrees_of_freedom: int

    def intervals(self, confidence: float = 0.95) -> tuple[Interval, Interval]:
        """Return the confidence intervals of slope and offset (Student's t)."""
        factor = float(student.ppf((1 + confidence) / 2, self.degrees_of_freedom))
        (va, _), (_, vb) = self.covariance
        half = (factor * va**0.5, factor * vb**0.5)
        a, b = self.line.slope, self.line.offset
        return (a - half[0], a + half[0]), (b - half[1], b + half[1])


def least_squares_line(u: ArrayLike, y: ArrayLike) -> LeastSquaresLine:
    """Return the line of least squares, θ = (ΦᵀΦ)⁻¹Φᵀy with Φ = [u 1] (eq. 3.18).

    Computed about the mean of u, where the two unknowns do not mix.

    Raises
    ------
    CharacterisationError
        If there are fewer than three points or all have the same u.
    """
    x, values = checked_points(u, y)
    mean = x.mean()
    spread = float(np.sum((x - mean) ** 2))
    slope = float(np.sum((x - mean) * values)) / spread
    middle = float(values.mean())
    line = Line(slope, middle - slope * float(mean))
    freedom = len(x) - 2
    variance = float(np.sum((values - line(x)) ** 2)) / freedom
    mixed = -variance * float(mean) / spread
    return LeastSquaresLine(
        line=line,
        covariance=(
            (variance / spread, mixed),
            (mixed, variance * (1 / len(x) + float(mean) ** 2 / spread)),
        ),
        residual_std=variance**0.5,
        degrees_of_freedom=freedom,
    )


def checked_points(u: ArrayLike, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the points as arrays, or refuse those that determine no line."""
    x, values = np.asarray(u, dtype=float), np.asarray(y, dtype=float)
    if x.ndim != 1 or x.shape != values.shape or len(x) < 3:
        raise CharacterisationError(
            f"A line needs at least three points (u, y); there are {x.shape} inputs "
            f"and {values.shape} outputs.",
            ("u", "y"),
            "Give two sequences of the same length.",
        )
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(values))):
        raise CharacterisationError(
            "The points hold a value that is not a number.",
            ("u", "y"),
            "Leave the missing points out.",
        )
    if np.ptp(x) == 0:
        raise CharacterisationError(
            f"All points have the same input {x[0]:g}.",
            ("u",),
            "Measure at different inputs.",
        )
    return x, values
