"""Whether what remembers also remembers through a whole recording.

Over short windows, each with its own initial state, a state that a hypothesis adds can
take any value anew: that explains slow disturbances of any kind. Physics with a memory
must explain a whole recording from one initial state, no worse than physics without,
and visibly better than the model as it was. A machine that is free to turn drifts off
over a whole recording whatever is added: there stretches of several windows speak.
"""

from collections.abc import Sequence

from bondgraph.diagnosis.candidates import Candidate, Rejected
from bondgraph.diagnosis.search.base.stretches import long_error, stretch
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording

REASON = (
    "what it remembers had to be set anew in every window; whole recordings, or long "
    "stretches of them, are explained better without it"
)

SHOWS = 0.95
"""What remembers leaves at most this share of the squared error without it: whole
recordings of a machine that drifts off differ by so much whatever is added.
"""


def remembering(
    base: FittedModel,
    candidates: Sequence[Candidate],
    recordings: Sequence[BoundRecording],
) -> tuple[list[Candidate], tuple[Rejected, ...]]:
    """Return the candidates that carry their memory on, and the others.

    Candidates that add no state pass; so do all where windows are whole recordings.
    """
    plain = [c.fitted for c in candidates if not _remembers(base, c)]
    whole = base.problem.shots.n_windows <= len(recordings)
    if whole or len(plain) == len(candidates):
        return list(candidates), ()
    samples = stretch(base, recordings)
    known = SHOWS**0.5 * long_error(base, recordings, samples)
    best = min([known, *(long_error(fitted, recordings, samples) for fitted in plain)])
    kept: list[Candidate] = []
    others: list[Rejected] = []
    for candidate in candidates:
        remembers = _remembers(base, candidate)
        if remembers and not long_error(candidate.fitted, recordings, samples) < best:
            others.append(Rejected(candidate.hypothesis, REASON))
        else:
            kept.append(candidate)
    return kept, tuple(others)


def _remembers(base: FittedModel, candidate: Candidate) -> bool:
    """Return whether a hypothesis adds a state."""
    return candidate.fitted.problem.model.n_states > base.problem.model.n_states
