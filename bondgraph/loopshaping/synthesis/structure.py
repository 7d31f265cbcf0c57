"""What a controller may look like: how many zeros and poles, and where they may lie.

A structure turns a vector of numbers into a controller. The numbers are logarithms of
break frequencies and, for pairs, damping ratios, so that every vector within the ranges
is a stable controller with stable zeros. The gain is no number of its own: it follows
from the frequency at which the loop gain shall be one.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.zero_pole_gain import (
    ComplexArray,
    FloatArray,
    ZeroPoleGain,
)

LEAST_DAMPING, MOST_DAMPING = 0.05, 1.5


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerStructure:
    """``fixed · Π(s + z) / Π(s + p)`` with free z, p and pairs of either.

    One zero and one pole are a phase-lead (or lag); two of each a lead-lag; a zero and
    an integrator a PI; two zeros, an integrator and two poles a PID with roll-off; a
    pair of zeros and two poles a notch.

    Parameters
    ----------
    zeros, poles
        Number of real ones.
    zero_pairs, pole_pairs
        Number of pairs, each with a frequency and a damping ratio of 0.05 to 1.5.
    integrators
        Poles at zero.
    slowest, fastest
        Range of the break frequencies, rad/s.
    fixed
        A factor that is always there, such as a given roll-off.

    Raises
    ------
    LoopShapingError
        If there are more zeros than poles, or the range is empty.
    """

    zeros: int = 1
    poles: int = 1
    zero_pairs: int = 0
    pole_pairs: int = 0
    integrators: int = 0
    slowest: float
    fastest: float
    fixed: ZeroPoleGain = field(default_factory=ZeroPoleGain)

    def __post_init__(self) -> None:
        above = self.zeros + 2 * self.zero_pairs
        below = self.poles + 2 * self.pole_pairs + self.integrators
        if above > below + self.fixed.relative_degree:
            raise LoopShapingError(
                f"A controller with {above} zeros and {below} poles cannot be built.",
                remedy="Allow as many poles as zeros.",
            )
        if not 0 < self.slowest < self.fastest < math.inf:
            raise LoopShapingError(
                f"{self.slowest:g} to {self.fastest:g} rad/s is no range of "
                f"frequencies.",
                remedy="Give 0 < slowest < fastest.",
            )

    @property
    def size(self) -> int:
        """How many numbers describe a controller, its gain left out."""
        return self.zeros + self.poles + 2 * (self.zero_pairs + self.pole_pairs)

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """The range of each number."""
        frequency = (math.log(self.slowest), math.log(self.fastest))
        damping = (LEAST_DAMPING, MOST_DAMPING)
        single = (frequency,) * (self.zeros + self.poles)
        return single + (frequency, damping) * (self.zero_pairs + self.pole_pairs)

    def roots(self, numbers: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the free zeros and poles, rad/s; integrators are among the poles."""
        singles = -np.exp(numbers[: self.zeros + self.poles]).astype(complex)
        pairs = numbers[self.zeros + self.poles :].reshape(-1, 2)
        both = [_pair(math.exp(w), zeta) for w, zeta in pairs]
        above = [singles[: self.zeros], *both[: self.zero_pairs]]
        below = [singles[self.zeros :], *both[self.zero_pairs :]]
        rest = np.zeros(self.integrators, dtype=complex)
        return np.concatenate(above), np.concatenate([*below, rest])

    def controller(self, numbers: FloatArray) -> ZeroPoleGain:
        """Return the controller that the numbers describe, with leading gain one."""
        zeros, poles = self.roots(numbers)
        free = ZeroPoleGain(
            zeros=tuple(map(complex, zeros)), poles=tuple(map(complex, poles))
        )
        return free * self.fixed

    def numbers(self, controller: ZeroPoleGain) -> FloatArray:
        """Return the numbers nearest to a controller of this structure.

        Raises
        ------
        LoopShapingError
            If it has another number of real zeros or poles, or the structure has pairs.
        """
        zeros = [z for z in controller.zeros if z not in self.fixed.zeros]
        poles = [p for p in controller.poles if p not in self.fixed.poles and p != 0]
        fits = (len(zeros), len(poles)) == (self.zeros, self.poles)
        if not fits or self.zero_pairs or self.pole_pairs:
            raise LoopShapingError(
                f"{controller} is not of this structure.",
                remedy="Start from a controller with the same real zeros and poles.",
            )
        sizes = np.abs(np.array([*zeros, *poles]))
        return np.asarray(np.log(np.clip(sizes, self.slowest, self.fastest)))


def _pair(frequency: float, damping: float) -> ComplexArray:
    """Return the roots of ``s² + 2 ζ ω s + ω²``."""
    root = np.sqrt(complex(damping**2 - 1))
    return np.asarray(frequency * np.array([-damping + root, -damping - root]))
