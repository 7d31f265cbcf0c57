"""A torque sensor that reads differently on the way up and on the way down.

The model (section 3.2.1, eq. 3.24) has three branches of torque over voltage: one line
while the voltage rises, one while it falls, and after each reversal a line of fixed
slope through the point of reversal, y = y_r + a_tr (u - u_r). Assumed is that the
torque depends on the order of the voltages and not on their speed, and that a reversal
forgets all earlier ones but the last.

When the transition ends is a choice. `FixedWidth` is the thesis's: after 0.2 V the
other line takes over. The lines are not parallel, so this meets the line at one voltage
only and jumps elsewhere. `UntilMet` follows the transition until it meets the line,
which is continuous: a play operator with sloping sides.
"""

from dataclasses import dataclass
from typing import assert_never

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.sensor_line import Line

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class FixedWidth:
    """The transition lasts `width` volts, then jumps to the line (thesis)."""

    width: float


@dataclass(frozen=True, slots=True)
class UntilMet:
    """The transition lasts until it meets the line: no jump."""


Transition = FixedWidth | UntilMet


@dataclass(frozen=True, slots=True, kw_only=True)
class Hysteresis:
    """Torque over voltage in three branches.

    Parameters
    ----------
    rising, falling
        Lines in N·m and volts.
    transition_slope
        a_tr, N·m/V: below both lines' slopes where the falling line lies above the
        rising one, above them where it lies below. Otherwise a transition would lead
        away from the line it is to meet.
    transition
        When a transition ends.
    """

    rising: Line
    falling: Line
    transition_slope: float
    transition: Transition = UntilMet()

    def torque(self, voltage: ArrayLike) -> FloatArray:
        """Return the torque for a sequence of voltages, N·m.

        The first sample is on the line of the direction that the voltage then takes.

        Raises
        ------
        CharacterisationError
            If a transition of `UntilMet` leads away from the line it is to meet.
        """
        u = np.asarray(voltage, dtype=float)
        if isinstance(self.transition, UntilMet):
            self._refuse_leading_away(u)
        return self.follow(u)

    def _refuse_leading_away(self, u: FloatArray) -> None:
        for at in (float(np.min(u)), float(np.max(u))):
            gap = float(self.falling(at)) - float(self.rising(at))
            for line in (self.rising, self.falling):
                if (line.slope - self.transition_slope) * gap < 0:
                    raise CharacterisationError(
                        f"At {at:.3g} V a transition of {self.transition_slope:.4g} "
                        f"N·m/V leads away from the line of {line.slope:.4g} N·m/V.",
                        ("transition_slope",),
                        "Choose FixedWidth, or a slope on the other side of both.",
                    )

    def follow(self, u: FloatArray) -> FloatArray:
        """Return the torque as `torque` does, whatever the slopes are."""
        result = np.empty_like(u)
        here: tuple[float, float] | None = None
        for first, last, direction in _sweeps(u):
            part = slice(first, last + 1)
            result[part] = self._sweep(u[part], direction, here)
            here = float(u[last]), float(result[last])
        return result

    def _sweep(
        self, u: FloatArray, direction: int, reversal: tuple[float, float] | None
    ) -> FloatArray:
        """Return the torque on a way without reversal, from the last one."""
        target = self.line(direction)(u)
        if reversal is None:
            return target
        u_r, y_r = reversal
        value = y_r + self.transition_slope * (u - u_r)
        match self.transition:
            case FixedWidth(width):
                inside = np.abs(u - u_r) <= width
            case UntilMet():
                # Until the gap to the line changes its sign: the two have met.
                gap = y_r - float(self.line(direction)(u_r))
                inside = (value - target) * gap > 0
            case _:
                assert_never(self.transition)
        return np.where(inside, value, target)

    def jump(self, voltage: float, *, from_rising: bool) -> float:
        """Return by how much the torque jumps where a transition ends, N·m.

        For a reversal at `voltage` from the rising line (or the falling one). Zero for
        `UntilMet`.
        """
        if isinstance(self.transition, UntilMet):
            return 0.0
        leaving, entering = (
            (self.rising, self.falling) if from_rising else (self.falling, self.rising)
        )
        step = -self.transition.width if from_rising else self.transition.width
        end = float(leaving(voltage)) + self.transition_slope * step
        return float(entering(voltage + step)) - end

    def line(self, direction: int) -> Line:
        """Return the line for rising (positive) or falling voltage."""
        return self.rising if direction > 0 else self.falling


def _sweeps(u: FloatArray) -> list[tuple[int, int, int]]:
    """Return (first, last, direction) of the ways between reversals of the samples."""
    steps = np.sign(np.diff(u))
    moving = np.flatnonzero(steps)
    if not len(moving):
        return [(0, len(u) - 1, 1)]
    turns = moving[1:][np.diff(steps[moving]) != 0]
    ends = [*turns.tolist(), len(u) - 1]
    starts = [0, *(turns + 1).tolist()]
    signs = [steps[moving[0]], *steps[turns]]
    return [(a, b, int(s)) for a, b, s in zip(starts, ends, signs, strict=True)]
