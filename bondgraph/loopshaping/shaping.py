"""Sizing a controller: the fastest crossover that the specification allows.

The crossover grows with the gain, so the gain is the largest for which every
requirement holds; it is found by bisection on the exact measures. Numbers that are left
free (a lead's pole, a roll-off's corner) are chosen so that this crossover is the
fastest, by golden section over one of them and by Nelder and Mead's simplex over
several. The answer is a design with its reasons: which requirement stops it from being
faster, or which one cannot be met and by how much.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from scipy.optimize import brentq, minimize, minimize_scalar

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.controllers import AbstractController
from bondgraph.loopshaping.crossings import phase_crossovers
from bondgraph.loopshaping.curve import curve
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.measures import LoopMeasures
from bondgraph.loopshaping.requirements import (
    AbstractRequirement,
    Assessment,
    Crossover,
    RequirementVerdict,
    Specification,
)
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain

_GAINS = np.geomspace(1.0, 1e-5, 41)  # of the ultimate gain, where the search looks
_UNSTABLE = 20.0  # violation of a loop that is not stable: worse than any figure
_SAME = 1e-7  # relative accuracy of the gain
_ROUGH = 1e-4  # the same while other numbers are still being chosen
_STRIDE = 1.3  # between gains that are tried around a good guess
_TRIES = 7  # values of a free number before the golden section


class DesignStatus(StrEnum):
    """How a design ended; the value is the sentence to show."""

    MET = "Every requirement is met."
    NOT_MET = "No gain meets every requirement; this is the nearest."


@dataclass(frozen=True, slots=True)
class Free:
    """A number that the design chooses: its path, and between which values."""

    path: str
    low: float
    high: float

    def __post_init__(self) -> None:
        if not 0 < self.low < self.high < math.inf:
            raise LoopShapingError(
                f"{self.path!r} is free between {self.low} and {self.high}.",
                (self.path,),
                "Give two positive limits, the lower one first.",
            )


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
    problem = _Problem(plant, feedback or ZeroPoleGain(), specification.all())
    if not problem.requirements:
        raise LoopShapingError(
            "Nothing is required, so no gain is too high.",
            remedy="Give a prototype or a requirement, such as PhaseMargin(45).",
        )
    for number in free:
        controller.value(number.path)  # refuses an unknown one
    design = _design(problem, _sized(problem, controller, free), free)
    if design.met:
        return design
    return replace(
        design, reasons=(*design.reasons, *_without_speed(problem, controller, free))
    )


def _without_speed(
    problem: "_Problem", controller: AbstractController, free: tuple[Free, ...]
) -> list[str]:
    """Return what the other requirements allow, where one asks for a crossover."""
    fast = [r for r in problem.requirements if isinstance(r, Crossover)]
    others = tuple(r for r in problem.requirements if r not in fast)
    if not (fast and others):
        return []
    rest = replace(problem, requirements=others)
    design = _design(rest, _sized(rest, controller, free), free)
    if not design.met:
        return ["The other requirements cannot be met at any crossover."]
    reached, wanted = design.measures.crossover, max(r.limit for r in fast)
    return [
        f"The other requirements allow a crossover of {reached:.4g} rad/s, "
        f"{wanted - reached:.3g} rad/s less than required; what stops it is the "
        f"{' and '.join(design.binding)}."
    ]


@dataclass(frozen=True, slots=True)
class _Problem:
    plant: ZeroPoleGain
    feedback: ZeroPoleGain
    requirements: tuple[AbstractRequirement, ...]

    def loop(self, controller: AbstractController) -> Loop:
        return Loop(
            plant=self.plant, controller=controller.transfer, feedback=self.feedback
        )

    def worst(self, controller: AbstractController) -> float:
        """Return the largest violation; negative where all requirements hold."""
        here = Assessment(self.loop(controller))
        if not here.stable:
            return _UNSTABLE
        return max(r.violation(here) for r in self.requirements)

    def ultimate_gain(self, controller: AbstractController) -> float:
        """Return a factor of the gain above which there is nothing to be found."""
        around = curve(self.loop(controller).open_loop)
        turns = phase_crossovers(around)
        if turns:
            sizes = np.exp(around.logarithm(np.array(turns)).real)
            return float(2 / sizes[sizes >= 1e-3 * sizes.max()].min())
        corner = 10 * float(np.abs(around.roots).max(initial=1.0))
        return float(1 / np.exp(around.logarithm(np.array([corner]))[0].real))


def _sized(
    problem: _Problem, controller: AbstractController, free: tuple[Free, ...]
) -> AbstractController:
    """Return the controller with its free numbers and its gain chosen."""
    if not free:
        return _with_largest_gain(problem, controller)
    low = np.log([number.low for number in free])
    high = np.log([number.high for number in free])
    guess: list[float] = []

    def at(x: FloatArray) -> AbstractController:
        changed = controller
        for number, value in zip(free, np.exp(np.clip(x, low, high)), strict=True):
            changed = changed.with_value(number.path, float(value))
        return changed

    def slowness(x: FloatArray) -> float:
        changed = at(x)
        sized = (
            _near(problem, changed, guess[-1])
            if guess
            else _with_largest_gain(problem, changed)
        )
        guess.append(sized.value("gain"))
        return _slowness(problem, sized)

    if len(free) == 1:
        best = _least(lambda x: slowness(np.array([x])), low[0], high[0])
        return _with_largest_gain(problem, at(np.array([best])))
    found = minimize(
        slowness,
        (low + high) / 2,
        method="Nelder-Mead",
        options={"xatol": 1e-3, "fatol": 1e-4, "maxfev": 60 * len(free)},
    )
    return _with_largest_gain(problem, at(np.asarray(found.x)))


def _least(function: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function is least: near the best of a few values."""
    tries = np.linspace(low, high, _TRIES)
    values = [function(float(x)) for x in tries]
    k = int(np.argmin(values))
    a, b = tries[max(k - 1, 0)], tries[min(k + 1, _TRIES - 1)]
    found = minimize_scalar(
        function, bounds=(a, b), method="bounded", options={"xatol": 1e-3}
    )
    x = float(found.x)
    return x if function(x) < values[k] else float(tries[k])


def _slowness(problem: _Problem, controller: AbstractController) -> float:
    """Return -ln of the crossover, raised by what is violated."""
    loop = problem.loop(controller)
    crossovers = Assessment(loop).gain_crossovers
    speed = math.log(crossovers[-1].omega) if crossovers else -50.0
    return 100 * max(0.0, problem.worst(controller) - 1e-6) - speed


def _with_largest_gain(
    problem: _Problem, controller: AbstractController
) -> AbstractController:
    """Return the controller with the largest gain for which all requirements hold.

    Where none does, with the gain of the least violation.
    """
    top = problem.ultimate_gain(controller)

    def worst(factor: float) -> float:
        return problem.worst(controller.scaled(factor))

    violations: list[float] = []
    for k, share in enumerate(_GAINS):
        here = worst(float(top * share))
        violations.append(here)
        if here <= 0:
            inside, outside = top * share, top * _GAINS[max(k - 1, 0)]
            return controller.scaled(_edge(worst, inside, outside, _SAME))
    k = int(np.argmin(violations))
    low, high = _GAINS[min(k + 1, len(_GAINS) - 1)], _GAINS[max(k - 1, 0)]
    found = minimize_scalar(
        worst,
        bounds=(top * low, top * high),
        method="bounded",
        options={"xatol": 1e-4 * top * low},
    )
    better = float(found.fun) < violations[k]
    return controller.scaled(float(found.x) if better else float(top * _GAINS[k]))


def _near(
    problem: _Problem, controller: AbstractController, guess: float
) -> AbstractController:
    """Return what `_with_largest_gain` does, roughly, from a good guess of the gain."""
    start = guess / controller.value("gain")

    def worst(factor: float) -> float:
        return problem.worst(controller.scaled(factor))

    holds = worst(start) <= 0
    for _ in range(12):
        following = start * (_STRIDE if holds else 1 / _STRIDE)
        if (worst(following) <= 0) is not holds:
            ends = (start, following) if holds else (following, start)
            return controller.scaled(_edge(worst, *ends, _ROUGH))
        start = following
    return _with_largest_gain(problem, controller)


def _edge(
    worst: Callable[[float], float], inside: float, outside: float, same: float
) -> float:
    """Return the largest factor between the two for which everything still holds."""
    if inside == outside:
        return float(inside)
    edge = float(brentq(worst, inside, outside, rtol=same, xtol=same * inside))
    return edge if worst(edge) <= 0 else max(edge * (1 - 2 * same), float(inside))


def _design(
    problem: _Problem, controller: AbstractController, free: tuple[Free, ...]
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
    if met:
        by = " and ".join(binding) or "stability"
        reasons = [f"The {gain} is the largest that the {by} allows."]
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
