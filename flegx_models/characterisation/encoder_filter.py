"""The encoder's PWM output and the filter behind it: steps, noise, bandwidth, delay.

The absolute angle arrives once per PWM frame, in steps; two second-order Butterworth
sections follow (eq. 3.34). The text of section 3.4 gives the cutoff as 25 Hz, eq. 3.34
divides s by 25, which is 25 rad/s, 3.98 Hz. Cutoffs here are in rad/s, so that the two
cannot be mixed up. With 25 Hz the attenuation at 133 Hz is 58.1 dB; 60 dB, as asked,
needs 23.7 Hz.
"""

import cmath
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flegx_models.characterisation.errors import CharacterisationError

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class PwmEncoder:
    """An absolute encoder read through its pulse width.

    Parameters
    ----------
    step
        Angle of one clock period, rad.
    clock
        Duration of a clock period, s.
    frame
        Clock periods of a PWM frame.
    """

    step: float
    clock: float
    frame: float

    @property
    def frame_rate(self) -> float:
        """Frames per second, Hz; the control loop has to sample more slowly."""
        return 1 / (self.frame * self.clock)

    @property
    def steps_per_turn(self) -> float:
        """Steps in a full turn."""
        return 2 * math.pi / self.step

    @property
    def quantisation_std(self) -> float:
        """Standard deviation of the rounding, step/√12, rad."""
        return self.step / math.sqrt(12)

    def delay(self, sampling: float) -> float:
        """Return the mean age of a reading, s, when sampled at `sampling` Hz.

        Assumed, for the thesis does not say: the angle is taken at the start of a
        frame, known at its end, and waits half a frame on average until it is sampled.
        Holding the sample adds half a sampling interval.

        Raises
        ------
        CharacterisationError
            If the sampling is not slower than the frames (section 3.4: f_s < f_PWM).
        """
        if not 0 < sampling < self.frame_rate:
            raise CharacterisationError(
                f"{sampling:g} Hz sampling is not below the encoder's "
                f"{self.frame_rate:.4g} frames per second.",
                ("sampling",),
                "Sample more slowly than the frames arrive.",
            )
        return 1.5 / self.frame_rate + 0.5 / sampling

    def read(self, angle: ArrayLike) -> FloatArray:
        """Return angles rounded to steps, rad."""
        return self.step * np.round(np.asarray(angle, dtype=float) / self.step)


@dataclass(frozen=True, slots=True, kw_only=True)
class ButterworthPair:
    """Two equal second-order low-pass sections in series (eq. 3.34).

    1/(1 + 2ζ s/ω_c + (s/ω_c)²)², static gain 1.

    Parameters
    ----------
    cutoff
        ω_c, rad/s.
    damping_term
        2ζ: √2 for Butterworth sections (the thesis prints 1.414).
    """

    cutoff: float
    damping_term: float = math.sqrt(2)

    @property
    def numerator(self) -> tuple[float, ...]:
        """Coefficients of s, highest power first."""
        return (self.cutoff**4,)

    @property
    def denominator(self) -> tuple[float, ...]:
        """Coefficients of s, highest power first."""
        section = [1.0, self.damping_term * self.cutoff, self.cutoff**2]
        return tuple(float(c) for c in np.polymul(section, section))

    @property
    def poles(self) -> tuple[complex, ...]:
        """The four poles in rad/s, each section's pair twice."""
        half = self.damping_term / 2
        above = self.cutoff * (-half + cmath.sqrt(half**2 - 1))
        return (above, above.conjugate()) * 2

    def response(self, omega: ArrayLike) -> ComplexArray:
        """Return the frequency response at `omega`, rad/s."""
        z = 1j * np.asarray(omega, dtype=float) / self.cutoff
        return np.asarray(1 / (1 + self.damping_term * z + z**2) ** 2, dtype=complex)

    def attenuation(self, omega: float) -> float:
        """Return -20 log₁₀ of the magnitude at `omega` in rad/s, dB."""
        return float(-20 * np.log10(np.abs(self.response(omega))))

    @property
    def bandwidth(self) -> float:
        """Where the magnitude is 1/√2, rad/s.

        0.802 ω_c with Butterworth sections: at ω_c itself each takes 3 dB, the pair 6.
        """
        # |section|² = 1/(1 + (d² - 2) w² + w⁴) = 1/√2, w = ω/ω_c.
        middle = (self.damping_term**2 - 2) / 2
        square = -middle + math.sqrt(middle**2 + math.sqrt(2) - 1)
        return self.cutoff * math.sqrt(square)

    @property
    def delay(self) -> float:
        """Delay of slow signals, s: group delay at zero frequency, 4ζ/ω_c."""
        return 2 * self.damping_term / self.cutoff

    @property
    def noise_bandwidth(self) -> float:
        """∫₀^∞ |G|² dω / 2π, Hz: white noise keeps this share of its one-sided density.

        The integral of 1/(1 + d z + z²)² has the closed form ω_c (d² + 1)/(8 d³)
        (Newton, Gould and Kaiser 1957, table E: order 4).
        """
        d = self.damping_term
        return self.cutoff * (d**2 + 1) / (8 * d**3)

    @classmethod
    def attenuating(cls, attenuation: float, *, at: float) -> "ButterworthPair":
        """Return the Butterworth pair with `attenuation` dB at `at` rad/s.

        1 + (ω/ω_c)⁴ = 10^(dB/20): the fastest filter that suppresses the noise enough.
        """
        if attenuation <= 0:
            raise CharacterisationError(
                f"An attenuation of {attenuation:g} dB is none.",
                ("attenuation",),
                "Give a positive number of decibels.",
            )
        ratio = math.sqrt(math.sqrt(10 ** (attenuation / 20) - 1))
        return cls(cutoff=at / ratio)

    def filtered(self, values: ArrayLike, *, sampling: float) -> FloatArray:
        """Return samples passed through the filter, discretised by Tustin's rule.

        Parameters
        ----------
        values
            Samples at `sampling` Hz; the filter starts settled at the first.
        """
        from scipy.signal import bilinear, lfilter, lfilter_zi  # noqa: PLC0415

        x = np.asarray(values, dtype=float)
        b, a = bilinear(self.numerator, self.denominator, fs=sampling)
        state = lfilter_zi(b, a) * x[0]
        return np.asarray(lfilter(b, a, x, zi=state)[0], dtype=float)
