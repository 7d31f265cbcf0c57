"""Coloured noise of each output: an autoregression that survives the fit.

The residual of a fit is noise from which parameters and the windows' initial states
have taken their share, and that share is its slowest part. So the autoregression is
corrected until noise drawn from it and treated in the same way looks like the residual
(indirect inference: Gouriéroux, Monfort and Renault 1993).
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.certainty.autoregression import autocovariance, levinson

Array = NDArray[np.float64]
MOST_ORDER = 20
SAMPLES_PER_ORDER = 6
CORRECTING_DRAWS = (8, 8, 8, 30)
STABLE = 0.9995
RUN_IN = 2000


@dataclass(frozen=True, slots=True, eq=False)
class Autoregression:
    """``e_k = Σ a_i e_{k-i} + innovation``, given by its reflection coefficients.

    ``spread`` is the standard error of ``arctanh`` of each, as estimated.
    """

    reflections: Array
    spread: Array

    def another(self, random: np.random.Generator) -> "Autoregression":
        """Return one that the estimate could as well have been made from."""
        drawn = np.arctanh(self.reflections) + self.spread * random.standard_normal(
            self.order
        )
        return Autoregression(np.clip(np.tanh(drawn), -STABLE, STABLE), self.spread)

    @property
    def order(self) -> int:
        """Number of earlier values it looks back to."""
        return len(self.reflections)

    @property
    def polynomial(self) -> Array:
        """``1, -a_1, …``: the filter from the noise to its innovations."""
        coefficients = np.zeros(0)
        for r in self.reflections:
            coefficients = np.append(coefficients - r * coefficients[::-1], r)
        return np.concatenate([[1.0], -coefficients])


WHITE = Autoregression(np.zeros(0), np.zeros(0))


def correlations(residual: Array, edges: tuple[int, ...], lags: int) -> Array:
    """Return autocorrelations at lags 0 … `lags`, pooled over windows."""
    found = autocovariance(residual, edges, lags)
    return found / found[0] if found[0] > 0.0 else found


def reflections(correlation: Array) -> tuple[Array, Array]:
    """Return reflection coefficients, and remaining variances from order 0 on."""
    orders = list(levinson(correlation, largest=STABLE))
    found = np.array([order.reflection for order in orders])
    return found, np.array([1.0, *(order.error for order in orders)])


def chosen_order(variance: Array, n: int) -> int:
    """Return the order with the least information criterion (AIC)."""
    orders = np.arange(len(variance))
    return int(np.argmin(n * np.log(np.maximum(variance, 1e-300)) + 2 * orders))


def autoregression(
    residual: Array,
    edges: tuple[int, ...],
    treat: Callable[[Array], Array],
    random: np.random.Generator,
) -> Autoregression:
    """Return the noise that, treated as the fit treats it, looks like the residual.

    Parameters
    ----------
    residual
        Of one output, windows end to end.
    treat
        Takes draws (n, m) and removes what parameters and initial states would.
    """
    shortest = min(b - a for a, b in pairwise(edges))
    most = min(MOST_ORDER, shortest // SAMPLES_PER_ORDER)
    if most < 1 or not np.any(residual):
        return WHITE
    seen, variance = reflections(correlations(residual, edges, most))
    order = chosen_order(variance, len(residual))
    if not order:
        return WHITE
    wanted = np.arctanh(seen[:order])
    own, spread = wanted, np.zeros(order)
    for count in CORRECTING_DRAWS:
        noise = random.standard_normal((len(residual), count))
        model = Autoregression(np.clip(np.tanh(own), -STABLE, STABLE), spread)
        draws = treat(coloured(model, noise))
        got = np.arctanh(
            [reflections(correlations(draw, edges, order))[0] for draw in draws.T]
        )
        # In these units a correlation of one is infinitely far.
        own, spread = own + wanted - got.mean(axis=0), got.std(axis=0, ddof=1)
    return Autoregression(np.clip(np.tanh(own), -STABLE, STABLE), spread)


def coloured(model: Autoregression, innovations: Array) -> Array:
    """Return noise (n, m) made of innovations, of their own size, after a run-in."""
    from scipy.signal import lfilter  # noqa: PLC0415

    if not model.order:
        return innovations
    # The noise began before the recording did.
    count = min(RUN_IN, 4 * len(innovations))
    run_in = np.resize(innovations[::-1], (count, *innovations.shape[1:]))
    whole = np.concatenate([run_in, innovations])
    made: Array = lfilter([1.0], model.polynomial, whole, axis=0)[len(run_in) :]
    return made


def whitened(model: Autoregression, values: Array, edges: tuple[int, ...]) -> Array:
    """Return innovations of `values` (n, …); the first rows of a window are zero."""
    from scipy.signal import lfilter  # noqa: PLC0415

    if not model.order:
        return values.copy()
    filtered: Array = lfilter(model.polynomial, [1.0], values, axis=0)
    for start in edges[:-1]:
        filtered[start : start + model.order] = 0.0
    return filtered
