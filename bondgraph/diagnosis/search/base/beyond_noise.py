"""How much of what a model leaves is not noise."""

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.fitting.estimate import FittedModel

Array = NDArray[np.float64]


def within(fitted: FittedModel, noise: Array, rule: Rule) -> bool:
    """Return whether what a model leaves is too near the noise to be worth a search."""
    return explainable(fitted, noise) < rule.materiality


def explainable(fitted: FittedModel, noise: Array) -> float:
    """Return the largest share of an output's squared residual that is not noise."""
    power = np.nanmean(fitted.residuals() ** 2, axis=0)
    share = 1.0 - noise**2 / np.where(power > 0.0, power, np.inf)
    return float(np.max(np.where(power > 0.0, share, 0.0), initial=0.0))


def left_beside(first: FittedModel, current: FittedModel, noise: Array) -> float:
    """Return the share of what `first` left beyond the noise that `current` leaves."""
    before, after = (
        float(np.sum(np.maximum(power - noise**2, 0.0) / first.problem.sigma**2))
        for power in (
            np.nanmean(fitted.residuals() ** 2, axis=0) for fitted in (first, current)
        )
    )
    return after / before if before > 0.0 else 0.0
