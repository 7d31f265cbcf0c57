"""What is worth judging: laws that are there, determined, and remember if they must."""

from collections.abc import Sequence

import numpy as np

from bondgraph.diagnosis.candidates import Candidate, Rejected
from bondgraph.diagnosis.evidence.left_out import FOLDS, left_out_errors
from bondgraph.diagnosis.search.base.stretches import long_error, stretch
from bondgraph.diagnosis.search.trials.determined import determined
from bondgraph.diagnosis.search.trials.memory import remembering
from bondgraph.diagnosis.search.trials.vanished import without_vanished
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording

RUINED = 2.0
"""A law with which whole recordings are simulated so many times worse is not the one:
it fits by states that one has to know, a runaway of its own for instance.
"""

LOST_FROM_THE_START = (
    "whole recordings, or long stretches of them, simulated from one initial state, "
    "are lost"
)
NOT_CARRIED_OVER = (
    "it helps between what is known, but where a quarter of the recordings is left out "
    "in one piece it makes the error larger"
)


def worth_judging(
    base: FittedModel,
    candidates: Sequence[Candidate],
    recordings: Sequence[BoundRecording],
) -> tuple[list[Candidate], tuple[Rejected, ...]]:
    """Return the candidates worth judging, and the others with their reasons."""
    there, vanished = without_vanished(candidates)
    known, undetermined = determined(base, there)
    worth, forgetful = remembering(base, known, recordings)
    return worth, (*vanished, *undetermined, *forgetful)


def fault_of(
    base: FittedModel,
    candidate: Candidate,
    recordings: Sequence[BoundRecording],
    chunks: int,
) -> str | None:
    """Return why a law that leads is not the one, or None.

    Whole recordings, or stretches of them, have to do about as well as before. Quarters
    that are left out in one piece may not be worse in all, and in half of them: what a
    law says between two pieces that are known it may know by heart. The rows of a table
    come in no order.
    """
    samples = stretch(base, recordings)
    before = long_error(base, recordings, samples)
    if long_error(candidate.fitted, recordings, samples) > RUINED * before:
        return LOST_FROM_THE_START
    if base.problem.shots.timeless:
        return None
    quarter = np.arange(chunks) * FOLDS // chunks
    without, with_it = (
        np.bincount(quarter, left_out_errors(one, chunks, in_one=True).chunks)
        for one in (base, candidate.fitted)
    )
    worse = np.count_nonzero(with_it > without) >= FOLDS / 2
    return NOT_CARRIED_OVER if worse and with_it.sum() > without.sum() else None
