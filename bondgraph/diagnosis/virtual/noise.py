"""The measurement noise of every output, as the recordings themselves tell it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.noise import AGREEMENT, NoiseEstimate, estimate_noise
from bondgraph.recordings.spread import size
from bondgraph.recordings.table_noise import table_noise

Array = NDArray[np.float64]
FINEST = 1e-6
"""Of a channel's spread: no channel is taken to be less noisy than this."""

MOVING = 0.5
"""A command that changes in more of the samples than this does not rest between steps.
"""


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
        else _beside_jumps(r, r.outputs[:, output])
        for r in recordings
        if np.isfinite(r.outputs[:, output]).any()
    ]
    return [one for one in seen if one is not None]


def _beside_jumps(recording: BoundRecording, values: Array) -> NoiseEstimate:
    """Return the noise of a channel; what jumps with a command is none.

    The voltage across a resistance follows each step of the current at once: where
    there are many, that looks like white noise. Only commands that rest between steps
    count: what moves all the time may carry the sensor's own noise, fed back.
    """
    plain = estimate_noise(recording.time, values)
    if len(values) < 2:
        return plain
    moves = np.mean(np.diff(recording.inputs, axis=0) != 0.0, axis=0)
    steps = recording.inputs[:, (moves > 0.0) & (moves < MOVING)]
    changes, answers = np.diff(steps, axis=0), np.diff(values)
    there = np.isfinite(answers) & np.isfinite(changes).all(axis=1)
    coarse = (plain.quantisation or 0.0) > plain.std
    if coarse or not changes[there].any():
        return plain
    share, *_ = np.linalg.lstsq(changes[there], answers[there])
    rest = estimate_noise(recording.time, values - steps @ share)
    std = max(rest.std, (plain.quantisation or 0.0) / np.sqrt(12.0))
    if std * AGREEMENT > plain.std:
        return plain
    return replace(rest, std=float(std), quantisation=plain.quantisation)


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
