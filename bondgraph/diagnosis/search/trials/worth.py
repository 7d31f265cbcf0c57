"""What is worth judging: laws that are there, determined, and remember if they must."""

from collections.abc import Sequence

from bondgraph.diagnosis.candidates import Candidate, Rejected
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


def holds_for_whole(
    base: FittedModel, candidate: Candidate, recordings: Sequence[BoundRecording]
) -> bool:
    """Return whether whole recordings, or stretches, do about as well as before."""
    samples = stretch(base, recordings)
    before = long_error(base, recordings, samples)
    return not long_error(candidate.fitted, recordings, samples) > RUINED * before
