"""A line is no noise: what a model leaves hums at a frequency of its own.

A rotor out of balance, the mains, a pump next door: a swing that goes on by itself
follows nothing that was recorded, as noise does not. But noise has no frequency of its
own.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.answer.wording import unit_after
from bondgraph.diagnosis.records import Verdict
from bondgraph.fitting.fitted import FittedModel

Array = NDArray[np.float64]

HALF = 0.5
"""Of what is left at least, in squares, is at one frequency."""

NONE = 0.01
"""Something has a line where more of its power than this share is there."""

STANDS_OUT = 10.0
"""And where that is so many times what is about it: steps and sweeps have no line."""

ABOUT = 20
"""Bins to both sides that are about a line."""

WIDE = 2
"""As many bins to both sides a line takes up under the taper (Hann)."""

OFTEN = 6
"""A swing that comes less often in a stretch is a slow drift."""

SHORTEST = 128
"""Samples of a stretch, in fewer of which a line and noise look alike."""

EVEN = 1e-3
"""Samples as even as this share of their interval have a spectrum."""


@dataclass(frozen=True, slots=True)
class Hum:
    """A swing in what a model leaves of one output.

    Parameters
    ----------
    output
        Its name.
    frequency
        In Hz.
    share
        Of the squared error.
    amplitude
        In the unit of the output.
    """

    output: str
    frequency: float
    share: float
    amplitude: float


def with_hum(
    verdict: Verdict, statement: str, final: FittedModel
) -> tuple[Verdict, str]:
    """Return the verdict where half of what is left is one swing: not `adequate`."""
    hum = swinging(final)
    if hum is None:
        return verdict, statement
    unit = next(m.unit for m in final.graph.measurements if m.name == hum.output)
    size = f"{hum.amplitude:.2g}{unit_after(unit)}"
    told = (
        f"What the model leaves of {hum.output} is no noise: {100 * hum.share:.0f} % "
        f"of it swings at {hum.frequency:.4g} Hz by {size}, where neither an input nor "
        "the model does. Something that was not recorded drives the machine or its "
        "sensor: a rotor out of balance, the mains, a pump."
    )
    if verdict is Verdict.ADEQUATE:
        return Verdict.CANNOT_TELL, told
    return verdict, f"{statement} {told}"


def swinging(fitted: FittedModel) -> Hum | None:
    """Return the clearest swing of which half of what is left is made, if any is."""
    shots, names = fitted.problem.shots, fitted.problem.model.output_names
    longest = max(shots.slices, key=lambda part: part.stop - part.start)
    size = longest.stop - longest.start
    steps = np.diff(shots.time[longest])
    if size < SHORTEST or np.ptp(steps) > EVEN * steps.mean():
        return None
    whole = [part for part in shots.slices if part.stop - part.start == size]
    residuals = np.nan_to_num(fitted.residuals())
    left = np.sum([_power(residuals[part]) for part in whole], axis=0)
    # What swings by itself, as a pendulum does, has the line in what it is told to do.
    told = np.hstack([shots.inputs, np.nan_to_num(shots.outputs - residuals)])
    driven = [_power(told[part]) for part in whole]
    frequency = np.fft.rfftfreq(size, steps.mean())
    found = []
    for name, power, own in zip(names, left.T, residuals.T, strict=True):
        line, share = _line(power)
        if share < HALF or line < OFTEN:
            continue
        # A line of one recording is lost among the steps of another.
        if not any(_is_in(one, line) for one in driven):
            amplitude = float(np.sqrt(2.0 * share * np.mean(own**2)))
            found.append(Hum(name, float(frequency[line]), share, amplitude))
    return max(found, key=lambda hum: hum.share, default=None)


def _line(power: Array) -> tuple[int, float]:
    """Return where most of the power is, and the share of it that is there."""
    line, total = int(np.argmax(power)), float(power.sum())
    return line, float(power[_near(line)].sum()) / total if total > 0.0 else 0.0


def _is_in(driven: Array, line: int) -> bool:
    """Return whether something has a line there, too."""
    there = driven[_near(line)]
    about = np.median(driven[_near(line, ABOUT)], axis=0)
    much = there.sum(axis=0) > NONE * driven.sum(axis=0)
    return bool(np.any(much & (there.max(axis=0) > STANDS_OUT * about)))


def _near(line: int, wide: int = WIDE) -> slice:
    return slice(max(line - wide, 0), line + wide + 1)


def _power(part: Array) -> Array:
    """Return the power of signals by frequency, about their means."""
    taper = np.hanning(len(part))[:, None]
    spectrum = np.fft.rfft(taper * (part - part.mean(axis=0)), axis=0)
    return np.asarray(np.abs(spectrum) ** 2)
