"""Fifth-order splines: a motion from one state to another (section 6.2).

Angle, speed and acceleration are given at both ends, which are six conditions for the
six coefficients of a polynomial of fifth order. It is the lowest order that leaves no
step of the acceleration, and so of the torque, where one motion follows another.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import reduce

import numpy as np

from bondgraph import BondGraphError


@dataclass(frozen=True, slots=True)
class Motion:
    """Angle in rad, speed in rad/s and acceleration in rad/s² at one instant."""

    angle: float
    speed: float = 0.0
    acceleration: float = 0.0

    def reversed(self) -> "Motion":
        """Return the same motion the other way round."""
        return Motion(-self.angle, -self.speed, -self.acceleration)


@dataclass(frozen=True, slots=True)
class QuinticSpline:
    """The polynomial of fifth order from `start` to `end` in `duration` seconds.

    Before and after, the motion stays at the angle of that end, at rest.

    Attributes
    ----------
    coefficients
        Of time, lowest power first, in rad/sᵏ.
    """

    start: Motion
    end: Motion
    duration: float
    coefficients: tuple[float, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not self.duration > 0:
            raise BondGraphError(
                f"A spline of {self.duration} s is no motion.",
                ("duration",),
                "Give a positive number of seconds.",
            )
        # A controller asks thousands of times where the motion is.
        object.__setattr__(self, "coefficients", self._coefficients())

    def _coefficients(self) -> tuple[float, ...]:
        T, a, b = self.duration, self.start, self.end
        lower = (a.angle, a.speed, a.acceleration / 2)
        # What the three lower powers leave to be done at the end.
        gap = np.array(
            [
                b.angle - (lower[0] + T * (lower[1] + T * lower[2])),
                (b.speed - (lower[1] + 2 * T * lower[2])) * T,
                (b.acceleration - 2 * lower[2]) * T**2,
            ]
        )
        powers = np.array([[1, 1, 1], [3, 4, 5], [6, 12, 20]], dtype=float)
        upper = np.linalg.solve(powers, gap) / T ** np.array([3.0, 4.0, 5.0])
        return (*lower, *map(float, upper))

    def at(self, time: float) -> Motion:
        """Return the motion `time` seconds after the start."""
        if time < 0:
            return Motion(self.start.angle)
        if time > self.duration:
            return Motion(self.end.angle)
        speed = _derivative(self.coefficients)
        return Motion(
            _value(self.coefficients, time),
            _value(speed, time),
            _value(_derivative(speed), time),
        )


def _derivative(coefficients: Sequence[float]) -> list[float]:
    return [k * c for k, c in enumerate(coefficients)][1:]


def _value(coefficients: Sequence[float], time: float) -> float:
    return reduce(lambda value, c: c + value * time, reversed(coefficients))
