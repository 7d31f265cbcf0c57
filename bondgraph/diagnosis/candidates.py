"""Candidates: every hypothesis of the library at every place, and what became of it."""

from collections.abc import Sequence
from dataclasses import dataclass

from bondgraph.diagnosis.probing import measure_scales
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.places.everywhere import all_places


@dataclass(frozen=True, slots=True)
class Candidate:
    """A hypothesis with its fitted model."""

    hypothesis: Hypothesis
    fitted: FittedModel

    @property
    def complexity(self) -> int:
        """Number of parameters it adds."""
        return len(self.hypothesis.parameters)

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
class Screened:
    """Hypotheses with their promises, best first, and those that cannot be tried."""

    promised: tuple[Promised, ...] = ()
    rejected: tuple[Rejected, ...] = ()


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
