"""The controller as it runs: 400 samples a second on a quantised, noisy encoder.

Per joint: the reading goes through the encoder filter of eq. 3.34 (with its cut-off at
25 Hz), the error through the lead of chapter 5, both discretised by Tustin's rule. The
command is a current; it is held over the sampling period and limited by the driver. The
motor follows at once: its slow pole of eq. 4.36 is ten times faster than the sampling.

The printed noise of 0.2 rad peak to peak at a third of the sampling rate (section 3.4)
is a cosine that repeats every three samples.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bondgraph import Lead
from flegx_models.characterisation.encoder_filter import ButterworthPair

Array = NDArray[np.float64]

_NOISE_SAMPLES = 3  # section 3.4: the noise is at a third of the sampling frequency


class DifferenceEquation:
    """A transfer function run sample by sample.

    Parameters
    ----------
    numerator, denominator
        Coefficients of s, highest power first.
    rate
        Samples per second.
    settled_at
        The input at which it has settled before it starts.
    """

    def __init__(
        self,
        numerator: Sequence[float],
        denominator: Sequence[float],
        rate: float,
        *,
        settled_at: float = 0.0,
    ) -> None:
        from scipy.signal import bilinear, lfilter_zi  # noqa: PLC0415

        b, a = bilinear(numerator, denominator, fs=rate)
        self._b, self._a = np.asarray(b) / a[0], np.asarray(a) / a[0]
        self._state: Array = settled_at * np.asarray(lfilter_zi(self._b, self._a))

    def __call__(self, value: float) -> float:
        """Return the output for the next input."""
        out = float(self._b[0] * value + self._state[0])
        shifted = np.append(self._state[1:], 0.0)
        self._state = shifted + self._b[1:] * value - self._a[1:] * out
        return out


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder:
    """The absolute encoder as section 3.4 describes it.

    Parameters
    ----------
    step
        rad per count.
    noise
        Peak to peak in rad.
    """

    step: float
    noise: float

    def read(self, angle: float, sample: int) -> float:
        """Return the reading of the sample with this number."""
        noise = math.cos(2 * math.pi * sample / _NOISE_SAMPLES)
        # The cosine's three values span 3/2 of its amplitude.
        disturbed = angle + self.noise * noise * 2 / _NOISE_SAMPLES
        return self.step * round(disturbed / self.step)


@dataclass(slots=True)
class JointController:
    """The two leads of one joint, one per phase, switched without a jump of state.

    Both run all the time on the same error; the phase says whose output is used.
    """

    flight: Lead
    stance: Lead
    rate: float
    _runs: dict[bool, DifferenceEquation] = field(init=False)

    def __post_init__(self) -> None:
        self._runs = {
            grounded: sampled_lead(law, self.rate)
            for grounded, law in ((False, self.flight), (True, self.stance))
        }

    def command(self, error: float, *, grounded: bool) -> float:
        """Return the current in A for the next error in rad."""
        outputs = {phase: run(error) for phase, run in self._runs.items()}
        return outputs[grounded]


def sampled_lead(law: Lead, rate: float) -> DifferenceEquation:
    """Return a lead K (s + z)/(1 + s/p) of chapter 5 at `rate` Hz."""
    return DifferenceEquation(
        (law.gain, law.gain * law.zero), (1 / law.pole, 1.0), rate
    )


def encoder_filter(cutoff: float, rate: float, start: float) -> DifferenceEquation:
    """Return the filter of eq. 3.34 with this cut-off (rad/s) at `rate` Hz.

    Parameters
    ----------
    start
        The angle in rad at which it has settled.
    """
    pair = ButterworthPair(cutoff=cutoff)
    return DifferenceEquation(pair.numerator, pair.denominator, rate, settled_at=start)
