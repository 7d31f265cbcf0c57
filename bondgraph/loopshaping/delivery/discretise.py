"""From continuous time to samples: three ways, each a choice object, root by root.

`Tustin` keeps the frequency response, exactly at one frequency of choice, and bends the
rest; `Matched` keeps every pole and zero where the sampled signal sees it; `ExactHold`
is exact for what a hold drives, such as a plant, with any delay.
"""

import cmath
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from bondgraph.choices import is_finite
from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.loop import zero_pole_gain
from bondgraph.loopshaping.realisation import realise
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain


class AbstractDiscretisation(ABC):
    """A way to turn a continuous system into a sampled one."""

    __slots__ = ()

    @abstractmethod
    def sampled(self, system: ZeroPoleGain, period: float) -> ZeroPoleGain:
        """Return the system at a sampling period in seconds."""

    def __call__(self, system: ZeroPoleGain, period: float) -> ZeroPoleGain:
        """Return the system at a sampling period in seconds.

        Raises
        ------
        LoopShapingError
            If it is sampled already, or the period is not positive.
        """
        if system.period is not None:
            raise LoopShapingError(
                f"The system is sampled every {system.period:g} s already.",
                remedy="Discretise the continuous one.",
            )
        if not 0 < period < math.inf:
            raise LoopShapingError(
                f"A sampling period of {period} s is no period.",
                remedy="Give a positive number of seconds.",
            )
        return self.sampled(system, period)


def _without_delay(system: ZeroPoleGain) -> None:
    if system.delay:
        raise LoopShapingError(
            f"A controller with a delay of {system.delay:g} s is not discretised.",
            remedy="Say computing_time where the loop is closed.",
        )
    if system.relative_degree < 0:
        raise LoopShapingError(
            "The controller has more zeros than poles and cannot be computed.",
            remedy="Add a pole, such as a roll-off.",
        )


def _check_frequency(omega: float | None, done: str) -> None:
    if omega is not None and not (is_finite(omega) and omega > 0):
        raise LoopShapingError(
            f"A controller cannot be {done} at {omega!r} rad/s.",
            remedy="Give a positive frequency, such as the crossover.",
        )


@dataclass(frozen=True, slots=True)
class Tustin(AbstractDiscretisation):
    """The trapezoidal rule, ``s = k (z - 1)/(z + 1)``.

    Parameters
    ----------
    prewarp
        The frequency (rad/s) at which the response is kept exactly; None for k = 2/T.
    """

    prewarp: float | None = None

    def __post_init__(self) -> None:
        _check_frequency(self.prewarp, "prewarped")

    def sampled(self, system: ZeroPoleGain, period: float) -> ZeroPoleGain:
        """Return the system at a sampling period in seconds."""
        _without_delay(system)
        k = 2 / period
        if self.prewarp is not None:
            if not 0 < self.prewarp * period < math.pi:
                raise LoopShapingError(
                    f"{self.prewarp:g} rad/s is not below half the sampling rate.",
                    remedy="Prewarp at the crossover.",
                )
            k = self.prewarp / math.tan(self.prewarp * period / 2)
        gain = complex(system.gain)
        for zero in system.zeros:
            gain *= k - zero
        for pole in system.poles:
            gain /= k - pole
        zeros = [(k + z) / (k - z) for z in system.zeros]
        return ZeroPoleGain(
            zeros=(*zeros, *([-1.0] * system.relative_degree)),
            poles=tuple((k + p) / (k - p) for p in system.poles),
            gain=gain.real,
            period=period,
        )


@dataclass(frozen=True, slots=True)
class Matched(AbstractDiscretisation):
    """Zeros and poles by ``z = exp(sT)``; zeros at infinity go to -1 but for one.

    Parameters
    ----------
    at
        Frequency (rad/s) at which the magnitude is kept; a tenth of half the sampling
        rate otherwise.
    """

    at: float | None = None

    def __post_init__(self) -> None:
        _check_frequency(self.at, "matched")

    def sampled(self, system: ZeroPoleGain, period: float) -> ZeroPoleGain:
        """Return the system at a sampling period in seconds."""
        _without_delay(system)
        zeros = [cmath.exp(z * period) for z in system.zeros]
        more = max(system.relative_degree - 1, 0)
        shape = ZeroPoleGain(
            zeros=(*zeros, *([-1.0] * more)),
            poles=tuple(cmath.exp(p * period) for p in system.poles),
            period=period,
        )
        omega = np.array([self.at or 0.1 * math.pi / period])
        ratio = complex((system.response(omega) / shape.response(omega))[0])
        return shape.times(math.copysign(abs(ratio), ratio.real))


@dataclass(frozen=True, slots=True)
class ExactHold(AbstractDiscretisation):
    """Exact at the samples for an input that is held in between (zero-order hold).

    A delay need not be a whole number of periods.
    """

    def sampled(self, system: ZeroPoleGain, period: float) -> ZeroPoleGain:
        """Return the system at a sampling period in seconds."""
        if system.relative_degree < 0:
            _without_delay(system)
        if not (system.poles or system.delay):
            return ZeroPoleGain(gain=system.gain, period=period)
        A, B, C, D, whole = held(system, period)
        import control  # noqa: PLC0415  (1 s; only its users wait for it)

        found = zero_pole_gain(control.StateSpace(A, B, C, D, period))
        return ZeroPoleGain(
            zeros=found.zeros,
            poles=found.poles,
            gain=found.gain,
            delay=whole * period,
            period=period,
        )


def held(
    system: ZeroPoleGain, period: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, int]:
    """Return A, B, C, D from sample to sample, and the whole periods of delay.

    Of a fraction of a period that is left, the input of the sample before acts first;
    it becomes the last state.
    """
    A, B, C, D = realise(
        ZeroPoleGain(zeros=system.zeros, poles=system.poles, gain=system.gain)
    )
    whole = math.floor(system.delay / period + 1e-9)
    late = max(system.delay - whole * period, 0.0)
    if late < 1e-9 * period:
        late = 0.0
    move, drive = propagated(A, B, period)
    if not late:
        return move, drive, C, D, whole
    _, new = propagated(A, B, period - late)
    old = drive - new
    n = len(A)
    wide = np.zeros((n + 1, n + 1))
    wide[:n, :n], wide[:n, n:] = move, old
    # At the sampling instant the input of before still acts.
    return wide, np.vstack([new, [[1.0]]]), np.hstack([C, D]), np.zeros((1, 1)), whole


def propagated(
    A: FloatArray, B: FloatArray, time: float
) -> tuple[FloatArray, FloatArray]:
    """Return by what state and constant input are multiplied over some time."""
    n = len(A)
    both = np.zeros((n + 1, n + 1))
    both[:n, :n], both[:n, n:] = A, B
    moved = expm(both * time)
    return moved[:n, :n], moved[:n, n:]
