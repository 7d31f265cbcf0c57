"""How long a simulation runs from each estimated initial state: a choice, as an object.

Whole recordings use the data best where errors of the model do not pile up. Where the
output integrates (a free shaft, a recording taken in closed loop) or the plant is
unstable, whatever the model leaves out accumulates without bound, and shorter windows,
each with its own initial state, weigh it rightly.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.windows import windows
from bondgraph.simulation.shooting import Shots

SHORTEST = 25
"""Samples in the shortest automatic window."""


@dataclass(frozen=True, slots=True)
class WholeRecordings:
    """Simulate each recording (or stretch between gaps) from one initial state."""


@dataclass(frozen=True, slots=True)
class Windows:
    """Simulate windows of `samples` samples, each from its own initial state."""

    samples: int


@dataclass(frozen=True, slots=True)
class Seconds:
    """Simulate windows of `duration` seconds, each from its own initial state."""

    duration: float


@dataclass(frozen=True, slots=True)
class Automatic:
    """Whole recordings unless the model integrates or is unstable; else the longest
    window over which measurement noise still hides what the model leaves out.
    """  # noqa: D205  (one sentence)


Horizon = WholeRecordings | Windows | Seconds | Automatic


def cut(recordings: Sequence[BoundRecording], horizon: Horizon) -> Shots:
    """Return the recordings cut into windows, laid end to end.

    A row of a steady table is a window of its own.
    """
    times, inputs, outputs, edges = [], [], [], [0]
    for recording in recordings:
        for part in _parts(recording, horizon):
            times.append(recording.time[part])
            inputs.append(recording.inputs[part])
            outputs.append(recording.outputs[part])
            edges.append(edges[-1] + part.stop - part.start)
    return Shots(
        np.concatenate(times),
        np.concatenate(inputs),
        np.concatenate(outputs),
        tuple(edges),
    )


def _parts(recording: BoundRecording, horizon: Horizon) -> list[slice]:
    if recording.steady:
        return [slice(i, i + 1) for i in range(len(recording))]
    match horizon:
        case Windows(samples):
            chosen = windows(recording, samples=samples)
        case Seconds(duration):
            chosen = windows(recording, seconds=duration)
        case _:
            chosen = windows(recording)
    return [window.samples for window in chosen]
