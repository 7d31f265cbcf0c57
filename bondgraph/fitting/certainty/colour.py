"""The colour of residuals: an autoregression, and what it does to a sum over samples.

An AR(p) model of the residuals, r_k = Σ a_i r_{k-i} + e_k, gives the covariance Γ of
all samples of a window with p + 1 numbers, and so the variance of any weighted sum of
them, gᵀΓg, far more surely than sums over a few blocks could. Γ = σ² A⁻¹A⁻ᵀ with A
the banded matrix of the model, so gᵀΓg = σ²|A⁻ᵀg|²: a filter run backwards over g.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.certainty.autoregression import autocovariance, levinson

Array = NDArray[np.float64]
MOST_ORDER = 12
SAMPLES_PER_ORDER = 20
LARGEST_SUM = 0.995


@dataclass(frozen=True, slots=True, eq=False)
class Colour:
    """An autoregression of one output's residuals.

    Parameters
    ----------
    coefficients
        a_1 … a_p; none for white residuals.
    innovation
        Variance of e.
    """

    coefficients: Array
    innovation: float

    @property
    def stretch(self) -> float:
        """Return how many samples tell as much as one white sample, at least 1."""
        power = self._power()
        long_run = self.innovation / (1.0 - float(self.coefficients.sum())) ** 2
        return max(long_run / power, 1.0) if power > 0.0 else 1.0

    def _power(self) -> float:
        """Return the variance of r, from the model's impulse response."""
        from scipy.signal import lfilter  # noqa: PLC0415  (slow to import)

        impulse = np.zeros(4000)
        impulse[0] = 1.0
        response = lfilter([1.0], self._polynomial(), impulse)
        return self.innovation * float((response**2).sum())

    def _polynomial(self) -> Array:
        return np.concatenate([[1.0], -self.coefficients])

    def innovations(self, residual: Array) -> Array:
        """Return what the past of a window's residual (n,) does not foresee."""
        from scipy.signal import lfilter  # noqa: PLC0415  (slow to import)

        steps: Array = lfilter(self._polynomial(), [1.0], residual)
        return steps

    def gathered(self, weights: Array) -> Array:
        """Return gᵀΓg for weights g (n, m) of one window's samples; (m, m)."""
        if not len(self.coefficients):
            white: Array = self.innovation * (weights.T @ weights)
            return white
        from scipy.signal import lfilter  # noqa: PLC0415  (slow to import)

        seen = lfilter([1.0], self._polynomial(), weights[::-1], axis=0)
        result: Array = self.innovation * (seen.T @ seen)
        return result


def colour_of(residual: Array, edges: tuple[int, ...], fitted: int) -> Colour:
    """Return the autoregression of residuals (n,) in windows, its order by BIC.

    Parameters
    ----------
    fitted
        How many unknowns were fitted to them: it makes residuals smaller and less
        coloured than the noise, by about (1 + 3a)/n for each (Marriott and Pope,
        Biometrika 41, 1954), which is put back.
    """
    n = len(residual)
    shortest = int(min(np.diff(edges)))
    most = min(MOST_ORDER, shortest // SAMPLES_PER_ORDER)
    covariance = autocovariance(residual, edges, most)
    if covariance[0] <= 0.0:
        return Colour(np.zeros(0), 0.0)
    grown = covariance[0] * n / max(n - fitted, 1)
    best, lowest = Colour(np.zeros(0), float(grown)), n * np.log(covariance[0])
    for coefficients, _, error in levinson(covariance):
        order = len(coefficients)
        score = n * np.log(max(error, 1e-300)) + order * np.log(n)
        if score < lowest:
            lowest = score
            raised = _raised(coefficients, n, fitted)
            best = Colour(raised, error * n / max(n - fitted - order, 1))
    return best


def _raised(coefficients: Array, n: int, fitted: int) -> Array:
    """Return the coefficients with the bias of their sum put back, still stable."""
    total = float(coefficients.sum())
    if total <= 0.0:
        return coefficients
    raised = min(total + (1.0 + 3.0 * total) / n, max(LARGEST_SUM, total))
    result: Array = coefficients * raised / total
    return result
