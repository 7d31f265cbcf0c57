"""The second-order prototype that a loop is asked to resemble on the Nichols chart.

``L(s) = ω_n² / (s (s + 2 ζ ω_n))`` is one curve on the Nichols chart whatever ω_n is:
ζ alone decides how close it comes to -1. Its two peaks, of 1/|1+L| and of |L|/|1+L|,
are the constant-magnitude curves that it touches. A loop that stays outside of both
curves is at least as well behaved as the prototype, and its crossover can then be made
as fast as the curves allow. That is the shaping of the FlegX thesis (section 5.2).
"""

import math
from dataclasses import dataclass

import numpy as np

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.zero_pole_gain import ComplexArray, ZeroPoleGain


@dataclass(frozen=True, slots=True)
class SecondOrderPrototype:
    """The prototype with damping ratio ``damping``, ζ, between 0 and 1."""

    damping: float = 0.6

    def __post_init__(self) -> None:
        if not 0 < self.damping < 1:
            raise LoopShapingError(
                f"A prototype with a damping ratio of {self.damping} does not swing.",
                remedy="Choose it between 0 and 1, such as 0.6.",
            )

    def open_loop(self, natural_frequency: float = 1.0) -> ZeroPoleGain:
        """Return L for a natural frequency in rad/s."""
        wn = natural_frequency
        return ZeroPoleGain(poles=(0, -2 * self.damping * wn), gain=wn**2)

    def curve(self, points: int = 400) -> ComplexArray:
        """Return L along its curve, from large to small gain."""
        return self.open_loop().response(np.geomspace(1e-2, 1e2, points))

    @property
    def sensitivity_peak(self) -> float:
        """The largest ``1/|1 + L|``; 1.353 at ζ = 0.6."""
        # |S|² = y (y + a) / ((1 - y)² + a y), y = (ω/ω_n)², a = 4 ζ²; its derivative
        # vanishes at y = (1 + √(1 + 2a)) / 2
        a = 4 * self.damping**2
        y = (1 + math.sqrt(1 + 2 * a)) / 2
        return math.sqrt(y * (y + a) / ((1 - y) ** 2 + a * y))

    @property
    def complementary_peak(self) -> float:
        """The largest ``|L|/|1 + L|``; 1.042 at ζ = 0.6, and 1 from ζ = 0.71 on."""
        if self.damping >= math.sqrt(0.5):
            return 1.0
        return 1 / (2 * self.damping * math.sqrt(1 - self.damping**2))

    @property
    def phase_margin(self) -> float:
        """Degrees; 59.2 at ζ = 0.6."""
        square = 2 * self.damping**2
        down = math.sqrt(math.sqrt(1 + square**2) - square)
        return math.degrees(math.atan2(2 * self.damping, down))

    @property
    def overshoot(self) -> float:
        """Percent of a step; 9.5 at ζ = 0.6."""
        z = self.damping
        return 100 * math.exp(-math.pi * z / math.sqrt(1 - z**2))
