"""Inputs that go in steps: commands, which stay the same from most samples to the next.

Between samples such an input is held, and not joined to the next by a line.
"""

from collections.abc import Sequence

import numpy as np

from bondgraph.recordings.binding import BoundRecording

STEPS = 0.2
"""An input that changes in fewer samples than this share goes in steps."""


def go_in_steps(recordings: Sequence[BoundRecording]) -> bool:
    """Return whether there are inputs, and all of them go in steps."""
    if not recordings[0].input_names:
        return False
    changes = [np.diff(recording.inputs, axis=0) != 0.0 for recording in recordings]
    return bool((np.concatenate(changes).mean(axis=0) < STEPS).all())
