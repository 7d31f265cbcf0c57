"""Misreadings: single samples that jump away and back are no motion, and no physics.

They are taken for missing, so that no law is bent to explain them, and they are told.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.noise import outliers


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


def _misread(recording: BoundRecording, column: int) -> list[int]:
    if recording.steady:
        return []
    rows = outliers(recording.time, recording.outputs[:, column])
    return [int(row) for row in rows]
