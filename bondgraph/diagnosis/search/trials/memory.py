"""Whether what remembers also remembers through a whole recording.

Over short windows, each with its own initial state, a state that a hypothesis adds can
take any value anew: that explains slow disturbances of any kind. Physics with a memory
must explain a whole recording from one initial state, no worse than physics without,
and visibly better than the model as it was. A machine that is free to turn drifts off
over a whole recording whatever is added: there stretches of several windows speak.

Nor may it explain the first samples alone: there its own state may begin anywhere, and
takes up a misread start.
"""

from collections.abc import Sequence

import numpy as np

from bondgraph.diagnosis.candidates import Candidate, Rejected
from bondgraph.diagnosis.evidence.explained import share_explained
from bondgraph.diagnosis.search.base.stretches import long_error, stretch
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording

REASON = (
    "what it remembers had to be set anew in every window; whole recordings, or long "
    "stretches of them, are explained better without it"
)

ONLY_BEGINS = (
    "what it explains is the first samples, where its own state may begin anywhere"
)

FIRST, ALL_OF_IT = 3, 0.8
"""So many samples of every window are the first; a law that explains so much of what it
explains there explains how windows begin.
"""

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

    Candidates that add no state pass. Where windows are whole recordings only the first
    samples are looked at.
    """
    begins = [_remembers(base, c) and _only_begins(base, c) for c in candidates]
    both = list(zip(candidates, begins, strict=True))
    hasty = tuple(Rejected(c.hypothesis, ONLY_BEGINS) for c, only in both if only)
    candidates = [c for c, only in both if not only]
    plain = [c.fitted for c in candidates if not _remembers(base, c)]
    whole = base.problem.shots.n_windows <= len(recordings)
    if whole or len(plain) == len(candidates):
        return candidates, hasty
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
    return kept, (*hasty, *others)


def _remembers(base: FittedModel, candidate: Candidate) -> bool:
    """Return whether a hypothesis adds a state."""
    return candidate.fitted.problem.model.n_states > base.problem.model.n_states


def _only_begins(base: FittedModel, candidate: Candidate) -> bool:
    """Return whether nearly all that it explains lies in the windows' first samples."""
    shots, fitted = base.problem.shots, candidate.fitted
    if shots.timeless or fitted.problem.shots.edges != shots.edges:
        return False
    first = np.zeros(len(shots.time), dtype=bool)
    for start in shots.edges[:-1]:
        first[start : start + FIRST] = True
    return share_explained(base, fitted, first) > ALL_OF_IT
