"""What a model leaves, held against the noise and against what was measured.

The noise is estimated from the recordings alone.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.virtual.noise import channel_noise, output_noise
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.noise import NoiseEstimate
from bondgraph.recordings.spread import spread

Array = NDArray[np.float64]
ADEQUATE_RATIO = 3.0
"""A residual below this many times the noise floor needs no more explanation."""

SIZEABLE = 0.1
"""Of an output's spread: a coloured residual larger than that is no mere noise."""

FORETOLD = 0.5
"""Of the noise floor: a model that leaves less has foretold what is no noise."""

SLOWLY = 0.015
"""Whole recordings that are missed by less, where windows are not, show nothing slow.

Rounding of a command adds up on a machine that integrates, and looks like a dead zone.
"""


def noise_floor(recordings: Sequence[BoundRecording]) -> dict[str, float]:
    """Return the measurement noise of each output, the largest over recordings."""
    names, noise = recordings[0].output_names, output_noise(recordings)
    return {name: one.std or 0.0 for name, one in zip(names, noise, strict=True)}


def foretold(fitted: FittedModel, floor: Mapping[str, float]) -> dict[str, float]:
    """Return the noise floor, no higher than what a model leaves that is below it.

    No model foretells noise. Fast motion looks like it to an estimate that sees one
    channel alone: the current of a shaker, say.
    """
    times = residual_over_noise(fitted, floor)
    return {
        name: std * times[name] if times.get(name, 1.0) < FORETOLD else std
        for name, std in floor.items()
    }


def excusable(recordings: Sequence[BoundRecording]) -> Array:
    """Return per output the residual that noise alone excuses.

    The noise where it is certain, that is where it looks white: fast motion looks like
    noise to an estimate that sees one channel. And half a step of a quantised channel,
    within which rounding follows the motion and looks like physics.
    """
    certain = [
        [_excused(one) for one in channel_noise(recordings, output)]
        for output in range(len(recordings[0].output_names))
    ]
    return np.array([min(excuses, default=0.0) for excuses in certain])


def _excused(noise: NoiseEstimate) -> float:
    step = 0.0 if noise.quantisation is None else noise.quantisation
    return max(noise.std if noise.white else 0.0, step / 2)


def residual_over_noise(
    fitted: FittedModel, floor: Mapping[str, float]
) -> dict[str, float]:
    """Return per output how many times the residual exceeds the noise floor."""
    rms = np.sqrt(np.nanmean(fitted.residuals() ** 2, axis=0))
    names = fitted.problem.model.output_names
    return {
        name: float(size / floor[name])
        for name, size in zip(names, rms, strict=True)
        if floor[name] > 0.0
    }


def residual_over_spread(fitted: FittedModel) -> dict[str, float]:
    """Return per output the residual over the standard deviation of what was read."""
    rms = np.sqrt(np.nanmean(fitted.residuals() ** 2, axis=0))
    moved = spread(fitted.problem.shots.outputs)
    shares = rms / np.where(moved > 0.0, moved, np.inf)
    names = fitted.problem.model.output_names
    return dict(zip(names, map(float, shares), strict=True))


def too_large(
    fitted: FittedModel, floor: Mapping[str, float], share: float = SIZEABLE
) -> str | None:
    """Return the output whose residual is worst beyond any noise; None where none is.

    Large beside the noise alone is not enough: a sensor may be finer than a machine.

    Parameters
    ----------
    share
        Of the output's spread, from which a residual is large.
    """
    ratios, shares = residual_over_noise(fitted, floor), residual_over_spread(fitted)
    large = [
        name
        for name, ratio in ratios.items()
        if ratio > ADEQUATE_RATIO and shares[name] > share
    ]
    return max(large, key=lambda name: shares[name], default=None)
