"""What a design by optimisation answers: the controller, every figure, and why."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.measures import LoopMeasures, measure
from bondgraph.loopshaping.requirements import (
    AbstractRequirement,
    Assessment,
    RequirementVerdict,
)
from bondgraph.loopshaping.synthesis.objectives import AbstractObjective
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain

METHOD = (
    "nonsmooth synthesis of a structured controller: sequential linear programming "
    "over all peaks, multi-start; every figure checked on the exact response"
)
_AT_LIMIT = 0.01  # closer to a limit than this, relatively: it sets the answer


class SynthesisStatus(StrEnum):
    """How a synthesis ended; the value is the sentence to show."""

    MET = "Every requirement is met on the exact response of every plant."
    NOT_MET = "No controller of this structure was found that meets every requirement."
    UNSTABLE = "No controller of this structure was found that stabilises every plant."


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimisedController:
    """A controller and what it was asked and found to do.

    Parameters
    ----------
    controller
        The best one found; if not all is met, the one that misses least.
    loops, measures
        One per plant, the nominal one first.
    verdicts
        Per plant, one per requirement.
    value
        What the objective achieves for the worst plant.
    reasons
        Sentences: which requirements could not be met and by how much, or which limits
        set the answer.
    method, starts, seed
        How it was found; the same seed gives the same answer.
    """

    status: SynthesisStatus
    controller: ZeroPoleGain
    loops: tuple[Loop, ...]
    measures: tuple[LoopMeasures, ...]
    verdicts: tuple[tuple[RequirementVerdict, ...], ...]
    objective: AbstractObjective
    value: float
    reasons: tuple[str, ...]
    starts: int
    seed: int
    method: str = METHOD

    @property
    def met(self) -> bool:
        """Whether every requirement is met."""
        return self.status is SynthesisStatus.MET

    def worst(self) -> tuple[RequirementVerdict, ...]:
        """Return the worst verdict of each requirement over the plants."""
        return tuple(_worst(column) for column in zip(*self.verdicts, strict=True))

    def required(self) -> ZeroPoleGain:
        """Return the controller.

        Raises
        ------
        LoopShapingError
            If a requirement is not met, saying which and by how much.
        """
        if not self.met:
            raise LoopShapingError(
                " ".join([self.status.value, *self.reasons]),
                tuple(v.name for v in self.worst() if not v.met),
                "Ask for less, or allow more zeros and poles.",
            )
        return self.controller

    def __str__(self) -> str:
        rows = [
            f"  {v.name}: {v.achieved:.5g} {v.unit}, {v.wanted}" for v in self.worst()
        ]
        head = [f"controller: {self.controller}", self.status.value]
        return "\n".join([*head, *rows, *self.reasons])


def answer(
    controller: ZeroPoleGain,
    loops: Sequence[Loop],
    requirements: Sequence[AbstractRequirement],
    objective: AbstractObjective,
    *,
    starts: int,
    seed: int,
) -> OptimisedController:
    """Return the record for a controller in these loops, everything measured anew."""
    whole = tuple(replace(one, controller=controller) for one in loops)
    assessed = [Assessment(one) for one in whole]
    verdicts = tuple(tuple(r.verdict(one) for r in requirements) for one in assessed)
    status = SynthesisStatus.MET
    if not all(v.met for row in verdicts for v in row):
        status = SynthesisStatus.NOT_MET
    if not all(one.stable for one in assessed):
        status = SynthesisStatus.UNSTABLE
    values = [objective.value(one) for one in assessed]
    worst = values[0]
    for other in values[1:]:
        worst = other if objective.better(worst, other) else worst
    made = OptimisedController(
        status=status,
        controller=controller,
        loops=whole,
        measures=tuple(measure(one, step=False) for one in whole),
        verdicts=verdicts,
        objective=objective,
        value=worst,
        reasons=(),
        starts=starts,
        seed=seed,
    )
    return replace(made, reasons=_reasons(made, requirements, assessed))


def _worst(column: Sequence[RequirementVerdict]) -> RequirementVerdict:
    """Return the verdict that is farthest on the wrong side of its limit."""
    most = "most" in column[0].wanted
    key = max if most else min
    return key(column, key=lambda v: v.achieved)


def _reasons(
    made: OptimisedController,
    requirements: Sequence[AbstractRequirement],
    assessed: Sequence[Assessment],
) -> tuple[str, ...]:
    if made.status is SynthesisStatus.UNSTABLE:
        return ()
    if made.status is SynthesisStatus.NOT_MET:
        return tuple(
            f"The nearest one reaches a {v.name} of {v.achieved:.4g} {v.unit}".rstrip()
            + f", {v.wanted} is required; {v.shortfall:.3g} {v.unit}".rstrip()
            + " are missing."
            for v in made.worst()
            if not v.met
        )
    return tuple(
        f"The {r.name} sets the answer."
        for r in requirements
        if max(r.violation(one) for one in assessed) > -_AT_LIMIT
    )
