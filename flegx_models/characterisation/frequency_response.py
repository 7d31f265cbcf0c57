"""Frequency response from impacts: hits are averaged, noise is put where it belongs.

The hammer's force and the response are both recorded. H1 = S_fy / S_ff is unbiased when
only the response is noisy, H2 = S_yy / S_yf when only the force is; with noise in both
|H1| ≤ |H| ≤ |H2| on average, and the coherence H1/H2 says how far apart they are.

A lightly damped strip still rings when the record ends. Both signals are therefore
multiplied by exp(-σ t). That is not an approximation like other windows: weighting both
sides of a convolution this way gives the response at s = σ + jω instead of at jω, and
`FrequencyResponse.s` says so, so that no damping has to be corrected afterwards.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from flegx_models.characterisation.errors import CharacterisationError

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

NOISE_LINES = 41
"""Frequency lines over which the noise spectrum is taken as smooth."""


class Estimator(StrEnum):
    """Which signal the noise is in; the value is the sentence."""

    H1 = "S_fy / S_ff: noise in the response"
    H2 = "S_yy / S_yf: noise in the force"


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyResponse:
    """Response over force at one pair of places.

    Parameters
    ----------
    frequency
        Hz, one per line.
    value
        Complex response over force at `s`, in the units of the recordings.
    coherence
        |S_fy|² / (S_ff S_yy), 1 where all hits agree; 1 throughout for one hit.
    std
        Standard deviation of real and imaginary part each, from the noise spectrum
        smoothed over `NOISE_LINES` lines; None for a single hit.
    decay
        σ of the exponential weight, 1/s.
    """

    frequency: FloatArray
    value: ComplexArray
    coherence: FloatArray
    std: FloatArray | None
    decay: float

    @property
    def s(self) -> ComplexArray:
        """Where the response was evaluated: σ + 2πj f, 1/s."""
        return np.asarray(self.decay + 2j * np.pi * self.frequency, dtype=complex)

    def within(self, low: float, high: float) -> "FrequencyResponse":
        """Return the lines between two frequencies, Hz."""
        keep = (self.frequency >= low) & (self.frequency <= high)
        return FrequencyResponse(
            frequency=self.frequency[keep],
            value=self.value[keep],
            coherence=self.coherence[keep],
            std=None if self.std is None else self.std[keep],
            decay=self.decay,
        )


def frequency_response(
    force: NDArray[np.float64],
    response: NDArray[np.float64],
    *,
    interval: float,
    estimator: Estimator = Estimator.H1,
    decay: float = 0.0,
) -> FrequencyResponse:
    """Return the frequency response from one or several hits at one place.

    Parameters
    ----------
    force, response
        ``[hit, sample]`` (or one hit ``[sample]``), starting before the hit.
    interval
        Seconds between samples.
    estimator
        `Estimator.H1` or `Estimator.H2`.
    decay
        σ in 1/s. exp(-(σ + ζω) T) is what truncating the record leaves as error.

    Raises
    ------
    CharacterisationError
        If the two recordings differ in shape or hold too few samples.
    """
    f, y = np.atleast_2d(force), np.atleast_2d(response)
    if f.shape != y.shape or f.ndim != 2 or f.shape[1] < 2 * NOISE_LINES:
        raise CharacterisationError(
            f"The force has the shape {f.shape} and the response {y.shape}.",
            ("force", "response"),
            f"Give both as [hit, sample] with at least {2 * NOISE_LINES} samples.",
        )
    hits, samples = f.shape
    weight = np.exp(-decay * interval * np.arange(samples))
    F, Y = np.fft.rfft(f * weight), np.fft.rfft(y * weight)
    # The first and last line are real, not complex: they are left out.
    F, Y = F[:, 1:-1], Y[:, 1:-1]
    frequency = np.asarray(np.fft.rfftfreq(samples, interval)[1:-1], dtype=float)
    S_ff = np.mean(np.abs(F) ** 2, axis=0)
    S_yy = np.mean(np.abs(Y) ** 2, axis=0)
    S_fy = np.mean(np.conj(F) * Y, axis=0)
    coherence = np.abs(S_fy) ** 2 / (S_ff * S_yy)
    value = S_fy / S_ff if estimator is Estimator.H1 else S_yy / np.conj(S_fy)
    return FrequencyResponse(
        frequency=frequency,
        value=value,
        coherence=coherence,
        std=None if hits == 1 else _std(S_ff, S_yy, S_fy, hits),
        decay=decay,
    )


def pulse_only(force: NDArray[np.float64], *, samples: int) -> FloatArray:
    """Return the force with everything but the pulse set to zero.

    Between hits the hammer's signal is noise. Left in, it disturbs every line in
    proportion to the response there, most at the resonances.

    Parameters
    ----------
    force
        ``[hit, sample]`` or ``[sample]``, N.
    samples
        Samples kept on either side of the largest magnitude.
    """
    f = np.atleast_2d(force)
    top = np.argmax(np.abs(f), axis=1)[:, None]
    near = np.abs(np.arange(f.shape[1]) - top) <= samples
    return np.where(near, f, 0.0).reshape(np.shape(force))


def _std(
    S_ff: FloatArray, S_yy: FloatArray, S_fy: ComplexArray, hits: int
) -> FloatArray:
    """Return the standard deviation of real and imaginary part of H1.

    The noise power S_yy - |S_fy|²/S_ff has hits - 1 complex degrees of freedom, few; a
    median over neighbouring lines makes it usable as a weight. The mean of a power with
    k complex degrees of freedom is larger than its median, by k over the median of a
    gamma variable of shape k.
    """
    noise = np.maximum(S_yy - np.abs(S_fy) ** 2 / S_ff, 0.0) * hits / (hits - 1)
    shape = hits - 1
    smooth = median_filter(noise, NOISE_LINES, mode="nearest")
    smooth = smooth * shape / (shape - 1 / 3 + 0.02 / shape)
    floor = np.finfo(float).eps * S_yy
    return np.asarray(np.sqrt(np.maximum(smooth, floor) / (hits * S_ff) / 2))
