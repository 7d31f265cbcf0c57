"""What is worth judging: laws that are there, determined, and remember if they must."""

from collections.abc import Sequence

import numpy as np

from bondgraph.diagnosis.candidates import CURVE, Candidate, Rejected
from bondgraph.diagnosis.drawn_laws import curve_of
from bondgraph.diagnosis.evidence.left_out import FOLDS, left_out_errors
from bondgraph.diagnosis.search.base.stretches import long_error, stretch
from bondgraph.diagnosis.search.trials.determined import determined
from bondgraph.diagnosis.search.trials.memory import remembering
from bondgraph.diagnosis.search.trials.vanished import without_vanished
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.places.base import MECHANICAL
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.elements import Compliance, Inertance

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

FALLS = 0.25
"""A store whose curve falls by more than this share of what it rises has a negative
capacity somewhere; less is how few knots follow what is flat.
"""
NEGATIVE = (
    "somewhere it would give less the more it holds, as no store but a spring does: "
    "what it holds stands for the time there"
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


def is_negative_store(candidate: Candidate) -> bool:
    """Return whether what a store that is no spring holds lets its answer fall."""
    hypothesis = candidate.hypothesis
    if hypothesis.physics != CURVE:
        return False
    element = candidate.fitted.graph.by_name.get(hypothesis.element)
    if not isinstance(element, Compliance | Inertance):
        return False
    domains = {d.name for d in candidate.fitted.graph.domains_at(hypothesis.place)}
    shape = hypothesis.shape
    if shape is None or domains & MECHANICAL:
        return False
    steps = np.diff(curve_of(candidate.fitted, shape.argument, shape.value)[1])
    rises, falls = steps[steps > 0.0].sum(), -steps[steps < 0.0].sum()
    return bool(falls > FALLS * rises)
