"""A channel that never changes is refused: any law that stops its output fits it."""

from collections.abc import Sequence

import numpy as np

from bondgraph.errors import RecordingError
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.spread import changes


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
