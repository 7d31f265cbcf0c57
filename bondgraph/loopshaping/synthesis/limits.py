"""Requirements that an optimiser needs beside those of `loopshaping.requirements`."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.requirements import AbstractRequirement, Assessment
from bondgraph.loopshaping.step_response import step_response
from bondgraph.loopshaping.synthesis.peaks import peak_gain
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain


class ModulusMargin(AbstractRequirement):
    """The least distance of the Nyquist curve from -1."""

    __slots__ = ()
    name = "modulus margin"

    def achieved(self, loop: Assessment) -> float:
        """Return the distance."""
        return 1 / loop.sensitivity.value


class FirstCrossover(AbstractRequirement):
    """Where the loop gain is one for the first time, in rad/s, at the earliest."""

    __slots__ = ()
    name = "first crossover"
    unit = "rad/s"

    def achieved(self, loop: Assessment) -> float:
        """Return the lowest gain crossover, 0 without one."""
        return loop.gain_crossovers[0].omega if loop.gain_crossovers else 0.0


class CrossoverAtMost(AbstractRequirement):
    """The highest gain crossover, in rad/s, at the latest."""

    __slots__ = ()
    name = "highest crossover"
    unit = "rad/s"
    at_least = False

    def achieved(self, loop: Assessment) -> float:
        """Return the highest gain crossover, 0 without one."""
        return loop.gain_crossovers[-1].omega if loop.gain_crossovers else 0.0


class PeakNoiseGain(AbstractRequirement):
    """The largest command per measurement noise over all frequencies."""

    __slots__ = ()
    name = "peak noise gain"
    at_least = False

    def achieved(self, loop: Assessment) -> float:
        """Return the peak of |C H / (1 + L)|."""
        whole = loop.loop
        return peak_gain(whole.controller * whole.feedback, whole.open_loop).value


@dataclass(frozen=True, slots=True)
class ActuatorLimit(AbstractRequirement):
    """The largest command after a step of the reference, in the command's unit.

    Parameters
    ----------
    step
        Size of the step, in the reference's unit.
    """

    step: float = 1.0

    name: ClassVar[str] = "largest command"
    at_least: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for number in (self.limit, self.step):
            if not (number > 0 and math.isfinite(number)):
                raise LoopShapingError(
                    f"A command of {self.limit} after a step of {self.step} is no "
                    f"limit.",
                    (self.name,),
                    "Give positive numbers.",
                )

    def achieved(self, loop: Assessment) -> float:
        """Return the largest command; infinite where the loop is not stable."""
        if not loop.stable:
            return math.inf
        whole = loop.loop
        # From reference to command: the controller ahead, everything else behind it.
        swapped = Loop(
            plant=ZeroPoleGain(),
            controller=whole.controller,
            feedback=whole.plant * whole.feedback,
        )
        found = loop.gain_crossovers
        answer = step_response(swapped, scale=found[-1].omega if found else 1.0)
        return float(np.abs(answer.output).max()) * self.step
