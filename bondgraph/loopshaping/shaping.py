"""Sizing a controller: the fastest crossover that the specification allows.

The crossover grows with the gain, so the gain is the largest for which every
requirement holds. Numbers that are left free (a lead's pole, a roll-off's corner) are
chosen so that this crossover is the fastest (`sizing` searches). The answer is a design
with its reasons: which requirement stops it from being faster, or which one cannot be
met and by how much.
"""

import math
from dataclasses import dataclass, replace
from enum import StrEnum

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.controllers import AbstractController
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.measures import LoopMeasures
from bondgraph.loopshaping.requirements import (
    Assessment,
    Crossover,
    RequirementVerdict,
    Specification,
)
from bondgraph.loopshaping.sizing import Free, Problem, sized
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain


class DesignStatus(StrEnum):
    """How a design ended; the value is the sentence to show."""

    MET = "Every requirement is met."
    NOT_MET = "No gain meets every requirement; this is the nearest."


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """A sized controller in its loop, with what was required and why it is so.

    Parameters
    ----------
    verdicts
        Every requirement beside what is achieved.
    binding
        Names of the requirements that stop the loop from being faster.
    reasons
        One sentence per number that was chosen.
    """

    status: DesignStatus
    controller: AbstractController
    loop: Loop
    measures: LoopMeasures
    verdicts: tuple[RequirementVerdict, ...]
    binding: tuple[str, ...]
    reasons: tuple[str, ...]

    @property
    def met(self) -> bool:
        """Whether every requirement is met."""
        return self.status is DesignStatus.MET

    @property
    def statement(self) -> str:
        """The status, and what is missing of each requirement that is not met."""
        missing = [
            f"{v.name}: {v.wanted} is required, {v.achieved:.4g} {v.unit}".rstrip()
            + f" is reached, {v.shortfall:.3g} {v.unit}".rstrip()
            + (" too much" if "most" in v.wanted else " too little")
            for v in self.verdicts
            if not v.met
        ]
        return " ".join(
            [self.status.value, *(f"{m[0].upper()}{m[1:]}." for m in missing)]
        )


def shape(
    plant: ZeroPoleGain,
    controller: AbstractController,
    specification: Specification,
    *,
    feedback: ZeroPoleGain | None = None,
    free: tuple[Free, ...] = (),
) -> Design:
    """Return the controller of this kind with the fastest crossover that is allowed.

    Parameters
    ----------
    plant
        From command to output, delays included.
    controller
        Its kind and its numbers; the gain, and what `free` names, are chosen here.
    feedback
        What sits in the feedback branch, such as a filter.

    Raises
    ------
    LoopShapingError
        If a free number is not one of the controller's, or the loop has no gain.
    """
    problem = Problem(plant, feedback or ZeroPoleGain(), specification.all())
    if not problem.requirements:
        raise LoopShapingError(
            "Nothing is required, so no gain is too high.",
            remedy="Give a prototype or a requirement, such as PhaseMargin(45).",
        )
    for number in free:
        controller.value(number.path)  # refuses an unknown one
    design = _design(problem, sized(problem, controller, free), free)
    if design.met:
        return design
    return replace(
        design, reasons=(*design.reasons, *_without_speed(problem, controller, free))
    )


def _without_speed(
    problem: Problem, controller: AbstractController, free: tuple[Free, ...]
) -> list[str]:
    """Return what the other requirements allow, where one asks for a crossover."""
    fast = [r for r in problem.requirements if isinstance(r, Crossover)]
    others = tuple(r for r in problem.requirements if r not in fast)
    if not (fast and others):
        return []
    rest = replace(problem, requirements=others)
    design = _design(rest, sized(rest, controller, free), free)
    if not design.met:
        return ["The other requirements cannot be met at any crossover."]
    reached, wanted = design.measures.crossover, max(r.limit for r in fast)
    return [
        f"The other requirements allow a crossover of {reached:.4g} rad/s, "
        f"{wanted - reached:.3g} rad/s less than required; what stops it is the "
        f"{' and '.join(design.binding)}."
    ]


def _design(
    problem: Problem, controller: AbstractController, free: tuple[Free, ...]
) -> Design:
    here = Assessment(problem.loop(controller))
    verdicts = tuple(r.verdict(here) for r in problem.requirements)
    met = here.stable and all(v.met for v in verdicts)
    binding = tuple(
        r.name for r in problem.requirements if abs(r.violation(here)) < 1e-4
    )
    status = DesignStatus.MET if met else DesignStatus.NOT_MET
    return Design(
        status=status,
        controller=controller,
        loop=here.loop,
        measures=here.measures,
        verdicts=verdicts,
        binding=binding,
        reasons=tuple(_reasons(controller, free, binding, met=met)),
    )


def _reasons(
    controller: AbstractController,
    free: tuple[Free, ...],
    binding: tuple[str, ...],
    *,
    met: bool,
) -> list[str]:
    gain = f"gain {controller.value('gain'):.5g}"
    if met and binding:
        verb = "allows" if len(binding) == 1 else "allow"
        reasons = [f"The {gain} is the largest that {' and '.join(binding)} {verb}."]
    elif met:
        reasons = [
            f"Nothing that is required stops a gain larger than {gain[5:]}; it is "
            f"where the search begins. Limit the noise gain as well."
        ]
    else:
        reasons = [f"The {gain} misses the requirements least."]
    for number in free:
        value = controller.value(number.path)
        words = f"{number.path} = {value:.5g} gives the fastest crossover"
        for limit, side in ((number.low, "lower"), (number.high, "upper")):
            if abs(math.log(value / limit)) < 1e-2:
                words += f" and lies at its {side} limit {limit:g}"
        reasons.append(f"{words}.")
    return reasons


def cancelling_zero(plant: ZeroPoleGain) -> float:
    """Return the zero (rad/s) that cancels the plant's slowest pole off the origin.

    Raises
    ------
    LoopShapingError
        If the plant has no such stable real pole.
    """
    slow = [-p.real for p in plant.poles if p.imag == 0 and p.real < 0]
    if not slow:
        raise LoopShapingError(
            "The plant has no stable real pole that a zero could cancel.",
            remedy="Give the controller's zero as a number.",
        )
    return min(slow)
