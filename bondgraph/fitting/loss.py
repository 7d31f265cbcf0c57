"""What a residual costs: a choice, as an object.

With s = (r/σ)² the cost is Σ ρ(s). The squared error is right for Gaussian noise and is
ruled by its largest residuals; Huber's and Student's losses let a sample that is far
off count little, so that outliers need not be found first (P. Huber, *Robust
Statistics*, 1981; Lange, Little and Taylor, JASA 84, 1989).
"""

from dataclasses import dataclass
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import FitError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SquaredError:
    """ρ(s) = s: Gaussian noise, no outliers."""


@dataclass(frozen=True, slots=True)
class Huber:
    """Squared up to `threshold` standard deviations, then linear.

    Parameters
    ----------
    threshold
        In residual scales; 1.345 keeps 95 % of the efficiency under Gaussian noise.

    Raises
    ------
    FitError
        If the threshold is not positive.
    """

    threshold: float = 1.345

    def __post_init__(self) -> None:
        _check_positive(self.threshold, "threshold of Huber")


@dataclass(frozen=True, slots=True)
class StudentT:
    """Noise with the heavy tails of Student's t distribution.

    Parameters
    ----------
    dof
        Degrees of freedom: small is heavy.

    Raises
    ------
    FitError
        If it is not positive.
    """

    dof: float = 4.0

    def __post_init__(self) -> None:
        _check_positive(self.dof, "dof of StudentT")


Loss = SquaredError | Huber | StudentT


def cost_of(loss: Loss, squared: Array) -> Array:
    """Return ρ(s) per residual."""
    match loss:
        case Huber(k):
            beyond = 2.0 * k * np.sqrt(squared) - k * k
            return np.where(squared <= k * k, squared, beyond)
        case StudentT(nu):
            cost: Array = (nu + 1.0) * np.log1p(squared / nu)
            return cost
        case SquaredError():
            return squared
    assert_never(loss)


def weight_of(loss: Loss, squared: Array) -> Array:
    """Return ρ'(s) per residual: its weight in the normal equations."""
    match loss:
        case Huber(k):
            return np.minimum(1.0, k / np.sqrt(np.maximum(squared, 1e-300)))
        case StudentT(nu):
            weight: Array = (nu + 1.0) / (nu + squared)
            return weight
        case SquaredError():
            return np.ones_like(squared)
    assert_never(loss)


def mean_curvature(loss: Loss, squared: Array) -> float:
    """Return the mean of ψ'(r), with ψ(r) = r ρ'(r²): what a residual tells on average.

    It stands in for the weight where the covariance of estimates is formed.
    """
    match loss:
        case Huber(k):
            return float(np.mean(squared <= k * k))
        case StudentT(nu):
            return float(np.mean((nu + 1.0) * (nu - squared) / (nu + squared) ** 2))
        case SquaredError():
            return 1.0
    assert_never(loss)


def scale_of(loss: Loss, residuals: Array) -> float:
    """Return the residual scale σ of one output, by the loss's own measure of size.

    Root mean square for the squared error; from the median of the absolute values, as
    it would be under the loss's distribution, for the others.
    """
    if isinstance(loss, SquaredError) or residuals.size == 0:
        return float(np.sqrt(np.mean(residuals**2))) if residuals.size else 0.0
    from scipy.special import ndtri, stdtrit  # noqa: PLC0415  (slow to import)

    quartile = stdtrit(loss.dof, 0.75) if isinstance(loss, StudentT) else ndtri(0.75)
    return float(np.median(np.abs(residuals)) / quartile)


def _check_positive(value: float, what: str) -> None:
    if not value > 0.0:
        raise FitError(
            f"The {what} is {value:g}.", (), "Give a number greater than zero."
        )
