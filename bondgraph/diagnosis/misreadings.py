"""Misreadings: single samples that jump away and back are no motion, and no physics.

They are taken for missing, so that no law is bent to explain them, and they are told.
A channel that never changes is refused: any law that stops its output explains it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bondgraph.errors import RecordingError
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.noise import outliers
from bondgraph.recordings.spread import changes


@dataclass(frozen=True, slots=True)
class Cleared:
    """Recordings whose misread samples are missing, and a sentence for each channel."""

    recordings: tuple[BoundRecording, ...]
    notes: tuple[str, ...]


def without_misreadings(recordings: Sequence[BoundRecording]) -> Cleared:
    """Return recordings with misread samples of outputs taken for missing."""
    cleared, notes = [], []
    for recording in recordings:
        outputs = recording.outputs.copy()
        for column, name in enumerate(recording.output_names):
            rows = _misread(recording, column)
            if not len(rows):
                continue
            outputs[rows, column] = np.nan
            where = ", ".join(str(row) for row in rows[:5])
            more = f" and {len(rows) - 5} more" if len(rows) > 5 else ""
            notes.append(
                f"{name} of {recording.name} jumps away and back at sample "
                f"{where}{more} (counted from 0): taken for a misreading, not used."
            )
        found = bool(np.isnan(outputs).sum() > np.isnan(recording.outputs).sum())
        cleared.append(replace(recording, outputs=outputs) if found else recording)
    return Cleared(tuple(cleared), tuple(notes))


def refuse_unchanging(recordings: Sequence[BoundRecording]) -> None:
    """Refuse outputs that hold one value throughout all recordings.

    Raises
    ------
    RecordingError
        If there is one: a sensor that is stuck, or a machine that does not move.
    """
    driven = [recording for recording in recordings if not recording.steady]
    if not driven:
        return
    names = driven[0].output_names
    outputs = np.concatenate([recording.outputs for recording in driven])
    resting = np.flatnonzero(~changes(outputs))
    if not len(resting):
        return
    told = " and ".join(
        f"{names[i]!r} ({np.nanmax(outputs[:, i]):.6g} throughout)" for i in resting
    )
    raise RecordingError(
        f"In the {len(outputs)} samples to diagnose from, nothing changes in {told}: a "
        "sensor that is stuck, or a machine that does not move.",
        tuple(names[i] for i in resting),
        "Leave it out of what the model measures, or record it while it changes.",
    )


def _misread(recording: BoundRecording, column: int) -> list[int]:
    if recording.steady:
        return []
    rows = outliers(recording.time, recording.outputs[:, column])
    return [int(row) for row in rows]
