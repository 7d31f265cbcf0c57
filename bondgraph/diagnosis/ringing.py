"""Where what a model leaves rings: where to begin with a part that it does not have.

A resonance that is missing stands out of the spectrum of the residuals, close by the
frequency of the part that makes it. Begun a third of it away a fit may not get there:
in between the phase is turned round.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincc

from bondgraph.fitting.fitted import FittedModel
from bondgraph.fitting.problem import FitProblem

Array = NDArray[np.float64]

SHORTEST = 32
"""Samples of a window that can show a resonance."""

PER_OCTAVE = 12
"""Bands over which the spectrum is averaged; a resonance damped to 5 % fills one."""

STANDS_OUT = 10.0
"""As many times stronger than what is about it a peak is one: 10 dB."""

BY_CHANCE = 0.01
"""White noise shows a peak in no more spectra than this share."""

MOST = 2

ENTANGLED = 1.5
"""As many neighbouring frequencies count as one under the taper (Hann)."""

EVEN = 1e-3
"""Samples as even as this share of their interval have a spectrum."""


def ringing(fitted: FittedModel) -> tuple[float, ...]:
    """Return up to two frequencies at which the residuals ring, the clearest first.

    In rad/s; none where windows are short or samples uneven. In a gap nothing is left.
    """
    residuals = fitted.optimum.linearisation.residuals
    peaks = sorted(_peaks(fitted.problem, residuals), reverse=True)
    return tuple(frequency for _, frequency in peaks[:MOST])


def _peaks(problem: FitProblem, residuals: Array) -> Iterator[tuple[float, float]]:
    """Yield how far each peak of an output's spectrum stands out, and where it is."""
    for frequency, power, count in _spectra(problem, residuals):
        about = _around(power)
        ratio = power / np.median(about, axis=1)
        chance = len(power) * gammaincc(count, count * ratio)
        shown = (
            (power == about.max(axis=1)) & (ratio > STANDS_OUT) & (chance < BY_CHANCE)
        )
        yield from zip(ratio[shown].tolist(), frequency[shown].tolist(), strict=True)


def _around(power: Array) -> Array:
    """Return for every band those within an octave of it, (n_bands, n)."""
    padded = np.pad(power, PER_OCTAVE, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * PER_OCTAVE + 1)


def _spectra(
    problem: FitProblem, residuals: Array
) -> Iterator[tuple[Array, Array, Array]]:
    """Yield frequency (rad/s), power and independent values in bands, by outputs."""
    shots = problem.shots
    longest = max(shots.slices, key=lambda part: part.stop - part.start)
    size = longest.stop - longest.start
    steps = np.diff(shots.time[longest])
    if size < SHORTEST or np.ptp(steps) > EVEN * steps.mean():
        return
    whole = [part for part in shots.slices if part.stop - part.start == size]
    taper = np.hanning(size)[:, None]
    frequency = 2 * np.pi * np.fft.rfftfreq(size, steps.mean())[1:]
    power = np.zeros((frequency.size, residuals.shape[1]))
    for part in whole:
        left = np.nan_to_num(residuals[part])
        power += np.abs(np.fft.rfft(taper * left, axis=0)[1:]) ** 2
    band = np.floor(PER_OCTAVE * np.log2(frequency / frequency[0])).astype(int)
    within = np.bincount(band)
    held = within > 0
    within, middle = within[held], np.bincount(band, frequency)[held] / within[held]
    for one in power.T:
        mean = np.bincount(band, one)[held] / within
        if (mean > 0.0).all():
            yield middle, mean, np.asarray(within * (len(whole) / ENTANGLED))
