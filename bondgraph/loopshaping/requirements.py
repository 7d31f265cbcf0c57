"""What a loop is required to do: each requirement is an object that can be checked.

A requirement has a limit in its own unit and says what a loop achieves and what is
missing. Users add kinds by writing one property. `Assessment` computes what the
requirements ask for, and nothing else, once.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from bondgraph.choices import is_finite
from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.curve import Curve, curve
from bondgraph.loopshaping.distance import Peak, encirclements, sensitivity_peak
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.measures import (
    GainCrossover,
    LoopMeasures,
    PhaseCrossover,
    gain_crossovers_of,
    measure,
    phase_crossovers_of,
)
from bondgraph.loopshaping.prototype import SecondOrderPrototype


class Assessment:
    """A loop with its measures, each computed when it is first asked for."""

    def __init__(self, loop: Loop) -> None:
        self.loop = loop

    @cached_property
    def curve(self) -> Curve:
        """The open loop's frequency curve."""
        return curve(self.loop.open_loop)

    @cached_property
    def stable(self) -> bool:
        """Whether the closed loop is stable."""
        return encirclements(self.curve).unstable == 0

    @cached_property
    def gain_crossovers(self) -> tuple[GainCrossover, ...]:
        """All of them, ascending."""
        return gain_crossovers_of(self.curve)

    @cached_property
    def phase_crossovers(self) -> tuple[PhaseCrossover, ...]:
        """All of them, ascending."""
        return phase_crossovers_of(self.loop.open_loop, self.curve)

    @cached_property
    def sensitivity(self) -> Peak:
        """The peak of 1/|1 + L|."""
        return sensitivity_peak(self.curve)

    @cached_property
    def complementary(self) -> Peak:
        """The peak of |L|/|1 + L|."""
        return sensitivity_peak(self.curve.reciprocal())

    @cached_property
    def measures(self) -> LoopMeasures:
        """Everything, with the step response."""
        return measure(self.loop)


@dataclass(frozen=True, slots=True)
class RequirementVerdict:
    """What a requirement asks for, what the loop achieves, and what is missing.

    ``shortfall`` is in the requirement's unit; zero where it is met.
    """

    name: str
    wanted: str
    achieved: float
    unit: str
    met: bool
    shortfall: float


@dataclass(frozen=True, slots=True)
class AbstractRequirement(ABC):
    """A limit on one property of the loop."""

    limit: float

    name: ClassVar[str]
    unit: ClassVar[str] = ""
    at_least: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if not (is_finite(self.limit) and self.limit > 0):
            raise self._no_limit("Give a positive number.")

    def _no_limit(self, remedy: str) -> LoopShapingError:
        limit = f"{self.limit} {self.unit}".strip()
        return LoopShapingError(
            f"A limit of {limit} for the {self.name} is no limit.", (self.name,), remedy
        )

    @abstractmethod
    def achieved(self, loop: Assessment) -> float:
        """Return what the loop achieves, in this requirement's unit."""

    def violation(self, loop: Assessment) -> float:
        """Return ln of how far the loop misses the limit; negative where it is met."""
        value = self.achieved(loop)
        if not value > 0:
            return 10.0 if self.at_least else -10.0
        ratio = math.log(self.limit) - math.log(min(value, 1e300))
        return ratio if self.at_least else -ratio

    def verdict(self, loop: Assessment) -> RequirementVerdict:
        """Return the requirement beside what the loop achieves."""
        value = self.achieved(loop)
        missing = self.limit - value if self.at_least else value - self.limit
        met = missing <= 1e-6 * self.limit
        word = "at least" if self.at_least else "at most"
        wanted = f"{word} {self.limit:.6g} {self.unit}".strip()
        short = 0.0 if met else missing
        return RequirementVerdict(self.name, wanted, value, self.unit, met, short)


class PhaseMargin(AbstractRequirement):
    """The smallest phase margin, in degrees."""

    __slots__ = ()
    name = "phase margin"
    unit = "deg"

    def achieved(self, loop: Assessment) -> float:
        """Return the smallest over all gain crossovers."""
        margins = [g.phase_margin for g in loop.gain_crossovers]
        return min(margins, key=abs, default=180.0)


class GainMargin(AbstractRequirement):
    """The factor by which the loop gain may rise."""

    __slots__ = ()
    name = "gain margin"

    def __post_init__(self) -> None:
        AbstractRequirement.__post_init__(self)
        if not self.limit > 1:  # the loop is at -1 there already
            raise self._no_limit("Give a factor above one, such as 2.")

    def achieved(self, loop: Assessment) -> float:
        """Return the smallest factor above one."""
        factors = [p.gain_margin for p in loop.phase_crossovers if p.gain_margin > 1]
        return min(factors, default=math.inf)


class DelayMargin(AbstractRequirement):
    """Seconds by which the loop may be late."""

    __slots__ = ()
    name = "delay margin"
    unit = "s"

    def achieved(self, loop: Assessment) -> float:
        """Return the smallest over all gain crossovers."""
        return min((g.delay_margin for g in loop.gain_crossovers), default=math.inf)


class PeakSensitivity(AbstractRequirement):
    """The largest 1/|1 + L|: one over the distance to -1."""

    __slots__ = ()
    name = "peak sensitivity"
    at_least = False

    def achieved(self, loop: Assessment) -> float:
        """Return the peak."""
        return loop.sensitivity.value


class PeakComplementary(AbstractRequirement):
    """The largest |L|/|1 + L|."""

    __slots__ = ()
    name = "peak complementary sensitivity"
    at_least = False

    def achieved(self, loop: Assessment) -> float:
        """Return the peak."""
        return loop.complementary.value


class Crossover(AbstractRequirement):
    """The highest gain crossover, in rad/s."""

    __slots__ = ()
    name = "crossover"
    unit = "rad/s"

    def achieved(self, loop: Assessment) -> float:
        """Return the highest, 0 without one."""
        return loop.gain_crossovers[-1].omega if loop.gain_crossovers else 0.0


@dataclass(frozen=True, slots=True)
class NoiseGain(AbstractRequirement):
    """Command per measurement noise at ``omega`` (rad/s)."""

    omega: float = 0.0

    name: ClassVar[str] = "noise gain"
    at_least: ClassVar[bool] = False

    def __post_init__(self) -> None:
        AbstractRequirement.__post_init__(self)
        if not (is_finite(self.omega) and self.omega >= 0):
            raise LoopShapingError(
                f"There is no noise gain at {self.omega!r} rad/s.",
                (self.name,),
                "Give a frequency that is not negative.",
            )

    def achieved(self, loop: Assessment) -> float:
        """Return |C H / (1 + L)| at that frequency."""
        return float(np.abs(loop.loop.control_of_noise(np.array([self.omega])))[0])


class Overshoot(AbstractRequirement):
    """Of a step, in percent."""

    __slots__ = ()
    name = "overshoot"
    unit = "%"
    at_least = False

    def achieved(self, loop: Assessment) -> float:
        """Return it; infinite where the loop is not stable."""
        step = loop.measures.step
        return math.inf if step is None else step.overshoot


class SettlingTime(AbstractRequirement):
    """Of a step, to 2 %, in seconds."""

    __slots__ = ()
    name = "settling time"
    unit = "s"
    at_least = False

    def achieved(self, loop: Assessment) -> float:
        """Return it; infinite where the loop is not stable."""
        step = loop.measures.step
        return math.inf if step is None else step.settling_time


@dataclass(frozen=True, slots=True, kw_only=True)
class Specification:
    """What a controller is sized for: the crossover as fast as all of this allows.

    Parameters
    ----------
    prototype
        Whose sensitivity peaks the loop must not exceed; None for no prototype.
    requirements
        Further ones.
    """

    prototype: SecondOrderPrototype | None = None
    requirements: tuple[AbstractRequirement, ...] = ()

    def all(self) -> tuple[AbstractRequirement, ...]:
        """Return the requirements, those of the prototype first."""
        if self.prototype is None:
            return self.requirements
        # A peak of one is approached at rest by every loop with an integrator.
        most = max(self.prototype.complementary_peak, 1 + 1e-3)
        bounds = (
            PeakSensitivity(self.prototype.sensitivity_peak),
            PeakComplementary(most),
        )
        return (*bounds, *self.requirements)
