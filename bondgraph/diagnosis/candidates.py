"""Candidates: every hypothesis of the library at every place, and what became of it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.probing import measure_scales
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.places.everywhere import all_places

Array = NDArray[np.float64]

CURVE = "unknown_relation"
"""The word for a relation without a name."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A hypothesis with its fitted model.

    ``complexity`` is the number of fitted parameters it adds, less those it replaces.
    """

    hypothesis: Hypothesis
    fitted: FittedModel
    complexity: int

    @property
    def cost(self) -> float:
        """What its fit leaves of the training data."""
        return self.fitted.optimum.cost

    @property
    def left_by_output(self) -> Array:
        """Squared residuals that its fit leaves of each output, in noise of it."""
        residuals = self.fitted.optimum.linearisation.residuals
        return np.asarray(np.sum(residuals**2, axis=0))

    @property
    def told(self) -> Hypothesis:
        """The hypothesis as it is told with the numbers of its fit."""
        return self.hypothesis.told_with(self.fitted.values)

    def reduction(self, base: FittedModel) -> float:
        """Return the relative reduction of the training error against `base`."""
        return 1.0 - self.cost / base.optimum.cost


def leading(candidates: Iterable[Candidate]) -> Candidate | None:
    """Return the candidate that leaves least; None where there is none."""
    return min(candidates, key=attrgetter("cost"), default=None)


def best_of_each(candidates: Iterable[Candidate]) -> list[Candidate]:
    """Return the candidate that leaves least of every hypothesis, in their order."""
    best: dict[int, Candidate] = {}
    for one in candidates:
        known = best.setdefault(id(one.hypothesis), one)
        if one.cost < known.cost:
            best[id(one.hypothesis)] = one
    return list(best.values())


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
class Screened:
    """Hypotheses with their promises, best first, and those that cannot be tried.

    ``independent`` is the number of independent hypotheses that all of them amount to.
    """

    promised: tuple[Promised, ...]
    rejected: tuple[Rejected, ...]
    independent: float


def is_named(law: Hypothesis) -> bool:
    """Return whether it is a law with a name and a number: neither curve nor slip."""
    return law.physics != CURVE and not law.is_slip


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
