"""What the optimiser strives for once every requirement is met."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from bondgraph.loopshaping.requirements import Assessment
from bondgraph.loopshaping.synthesis.excess import noise_response
from bondgraph.loopshaping.synthesis.gridded import GriddedLoops
from bondgraph.loopshaping.synthesis.peaks import peak_gain


class AbstractObjective(ABC):
    """A number to make small, of the worst loop of a family."""

    __slots__ = ()

    @abstractmethod
    def cost(self, loops: GriddedLoops) -> float:
        """Return the logarithm to descend on."""

    @abstractmethod
    def value(self, loop: Assessment) -> float:
        """Return what one loop achieves, exactly, in the objective's own unit."""

    @abstractmethod
    def better(self, one: float, other: float) -> bool:
        """Return whether the value `one` is better than `other`."""


@dataclass(frozen=True, slots=True)
class FastestCrossover(AbstractObjective):
    """The highest first gain crossover (rad/s) of the slowest loop."""

    def cost(self, loops: GriddedLoops) -> float:
        """Return minus ln of the lowest crossover."""
        return -float(loops.crossovers().min())

    def value(self, loop: Assessment) -> float:
        """Return the first crossover in rad/s."""
        return loop.gain_crossovers[0].omega if loop.gain_crossovers else 0.0

    def better(self, one: float, other: float) -> bool:
        """Return whether `one` is higher."""
        return one > other


@dataclass(frozen=True, slots=True)
class LeastNoise(AbstractObjective):
    """The least peak of controller output per measurement noise."""

    def cost(self, loops: GriddedLoops) -> float:
        """Return ln of the largest peak."""
        return float(np.log(noise_response(loops)).max())

    def value(self, loop: Assessment) -> float:
        """Return the peak, in the units of the controller's output over its input."""
        whole = loop.loop
        return peak_gain(whole.controller * whole.feedback, whole.open_loop).value

    def better(self, one: float, other: float) -> bool:
        """Return whether `one` is lower."""
        return one < other


@dataclass(frozen=True, slots=True)
class BestRejection(AbstractObjective):
    """The least ``|1/(1 + L)|`` at a frequency (rad/s) where disturbances are."""

    omega: float

    def cost(self, loops: GriddedLoops) -> float:
        """Return ln of the largest sensitivity at the grid's nearest frequency."""
        k = int(np.abs(np.log(loops.omega / self.omega)).argmin())
        return float(-np.log(np.abs(1 + loops.loop[:, k])).min())

    def value(self, loop: Assessment) -> float:
        """Return the sensitivity there."""
        here = loop.loop.sensitivity(np.array([self.omega]))[0]
        return float(abs(here)) if loop.stable else math.inf

    def better(self, one: float, other: float) -> bool:
        """Return whether `one` is lower."""
        return one < other
