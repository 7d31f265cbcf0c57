"""The search behind a design: the largest gain, and the free numbers around it.

Seen from the ultimate gain downwards, the first gain at which every requirement holds
brackets the largest one, and Brent's method finds it on the exact measures. One free
number is chosen from a few values and a golden section around the best of them, several
by Nelder and Mead's simplex.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize, minimize_scalar

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.controllers import AbstractController
from bondgraph.loopshaping.crossings import phase_crossovers
from bondgraph.loopshaping.curve import curve
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.requirements import AbstractRequirement, Assessment
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain

_GAINS = np.geomspace(1.0, 1e-5, 41)  # of the ultimate gain, where the search looks
_UNSTABLE = 20.0  # violation of a loop that is not stable: worse than any figure
_SAME = 1e-7  # relative accuracy of the gain
_ROUGH = 1e-4  # the same while other numbers are still being chosen
_STRIDE = 1.3  # between gains that are tried around a good guess
_TRIES = 7  # values of a free number before the golden section


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


@dataclass(frozen=True, slots=True)
class Problem:
    """A plant, its feedback branch and what the loop must do."""

    plant: ZeroPoleGain
    feedback: ZeroPoleGain
    requirements: tuple[AbstractRequirement, ...]

    def loop(self, controller: AbstractController) -> Loop:
        """Return the loop around this controller."""
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


def sized(
    problem: Problem, controller: AbstractController, free: tuple[Free, ...]
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
        best = (
            _near(problem, changed, guess[-1])
            if guess
            else _with_largest_gain(problem, changed)
        )
        guess.append(best.value("gain"))
        return _slowness(problem, best)

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


def _slowness(problem: Problem, controller: AbstractController) -> float:
    """Return -ln of the crossover, raised by what is violated."""
    loop = problem.loop(controller)
    crossovers = Assessment(loop).gain_crossovers
    speed = math.log(crossovers[-1].omega) if crossovers else -50.0
    return 100 * max(0.0, problem.worst(controller) - 1e-6) - speed


def _with_largest_gain(
    problem: Problem, controller: AbstractController
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
    problem: Problem, controller: AbstractController, guess: float
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
