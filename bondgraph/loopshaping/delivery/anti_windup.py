"""What the controller's memory does while the actuator is at its limit."""

import math
from dataclasses import dataclass

from bondgraph.errors import LoopShapingError


@dataclass(frozen=True, slots=True)
class NoAntiWindup:
    """Nothing: the states go on as if the command were carried out."""


@dataclass(frozen=True, slots=True)
class Clamping:
    """The states stand still while the error pushes the command farther beyond."""


@dataclass(frozen=True, slots=True)
class BackCalculation:
    """The states see the error that would just have given the limited command.

    ``e' = e + γ (u - v)/D`` with v the wanted, u the limited command and D the
    controller's direct gain; γ = 1 - exp(-T/time). A time of zero is the conditioning
    technique (Hanus, Kinnaert and Henrotte, Automatica 23, 1987).

    Parameters
    ----------
    time
        Seconds in which the states follow; not negative.
    """

    time: float = 0.0

    def __post_init__(self) -> None:
        if not 0 <= self.time < math.inf:
            raise LoopShapingError(
                f"States cannot follow in {self.time} s.",
                remedy="Give a time that is not negative.",
            )

    def share(self, period: float) -> float:
        """Return γ at a sampling period in seconds."""
        return 1.0 if self.time == 0 else 1 - math.exp(-period / self.time)


AntiWindup = NoAntiWindup | Clamping | BackCalculation
