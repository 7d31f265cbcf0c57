"""The measurement noise of every output, as the recordings themselves tell it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.noise import NoiseEstimate, estimate_noise
from bondgraph.recordings.spread import size
from bondgraph.recordings.table_noise import table_noise

Array = NDArray[np.float64]
FINEST = 1e-6
"""Of a channel's spread: no channel is taken to be less noisy than this."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputNoise:
    """The noise of one output: white std, step of its grid, whether it looks white.

    ``std`` is None where nothing can be said, as of a short steady table.
    """

    std: float | None
    quantisation: float | None
    white: bool


def output_noise(recordings: Sequence[BoundRecording]) -> tuple[OutputNoise, ...]:
    """Return the noise of each output, the largest over recordings."""
    found = []
    for i in range(len(recordings[0].output_names)):
        seen = channel_noise(recordings, i)
        steps = [one.quantisation for one in seen if one.quantisation is not None]
        found.append(
            OutputNoise(
                std=max((one.std for one in seen), default=None),
                quantisation=max(steps, default=None),
                white=bool(seen) and all(one.white for one in seen),
            )
        )
    return tuple(found)


def channel_noise(
    recordings: Sequence[BoundRecording], output: int
) -> list[NoiseEstimate]:
    """Return the noise of one output in each recording that tells it."""
    seen = [
        table_noise(r.inputs, r.outputs[:, output])
        if r.steady
        else estimate_noise(r.time, r.outputs[:, output])
        for r in recordings
        if np.isfinite(r.outputs[:, output]).any()
    ]
    return [one for one in seen if one is not None]


def noise_scale(fitted: FittedModel, recordings: Sequence[BoundRecording]) -> Array:
    """Return a positive noise level per output, in its unit.

    What the recordings tell; where they cannot, the residual's size.
    """
    residual = np.sqrt(np.nanmean(fitted.residuals() ** 2, axis=0))
    told = [one.std for one in output_noise(recordings)]
    scale = np.array(
        [r if s is None else s for s, r in zip(told, residual, strict=True)]
    )
    floor = FINEST * size(fitted.problem.shots.outputs)
    positive: Array = np.maximum(scale, floor)
    return positive
