"""Whether held-out recordings say anything where they are predicted hardly better.

A recording that goes where no other has gone, a kettle twice as hot, may be missed for
what was not known of the model's own numbers. That says nothing against what was found.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.answer.carrying import Shown
from bondgraph.fitting.certainty.prediction import prediction_std
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording

REACH = 2.0
"""Standard deviations of a prediction, within which an error is to be expected."""


def is_left_open(
    final: FittedModel, held_out: Sequence[BoundRecording], shown: Shown
) -> bool:
    """Return whether open numbers alone may miss held-out recordings by as much."""
    names = shown.idle or shown.missed
    if not names:
        return False
    std, missed = prediction_std(final, held_out), shown.held_out.after.rmse
    return all(missed[name] <= REACH * std[name] for name in names)
