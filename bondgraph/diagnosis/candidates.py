"""Candidates: every hypothesis of the library at every place, and what became of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.probing import measure_scales
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.places.everywhere import all_places

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Candidate:
    """A hypothesis with its fitted model.

    ``complexity`` is the number of fitted parameters it adds, less those it replaces.
    """

    hypothesis: Hypothesis
    fitted: FittedModel
    complexity: int

    def reduction(self, base: FittedModel) -> float:
        """Return the relative reduction of the training error against `base`."""
        return 1.0 - self.fitted.optimum.cost / base.optimum.cost


@dataclass(frozen=True, slots=True)
class Promised:
    """A hypothesis with the share of the training error it promises to explain."""

    hypothesis: Hypothesis
    reduction: float


@dataclass(frozen=True, slots=True)
class Rejected:
    """A hypothesis that cannot be tried, with the reason."""

    hypothesis: Hypothesis
    reason: str


@dataclass(frozen=True, slots=True)
class Chance:
    """What the best of all hypotheses seems to explain where nothing is missing.

    Parameters
    ----------
    shares
        Of each surrogate of the residual, by the best hypothesis for it.
    factor
        For the hypotheses that took no part in this.
    """

    shares: Array
    factor: float = 1.0

    def p_value(self, reduction: float) -> float:
        """Return how often chance gives a reduction at least as large."""
        above = float((self.shares >= reduction).sum())
        return min(self.factor * (1.0 + above) / (1.0 + len(self.shares)), 1.0)


@dataclass(frozen=True, slots=True)
class Screened:
    """Hypotheses with their promises, best first, and those that cannot be tried."""

    promised: tuple[Promised, ...]
    rejected: tuple[Rejected, ...]
    chance: Chance


def propose_all(
    base: FittedModel, library: Sequence[AbstractPhysics]
) -> tuple[Hypothesis, ...]:
    """Return every hypothesis of the library at every place."""
    scales = measure_scales(base)
    return tuple(
        hypothesis
        for place in all_places(base.graph, scales)
        for physics in library
        for hypothesis in physics.propose(place)
    )
