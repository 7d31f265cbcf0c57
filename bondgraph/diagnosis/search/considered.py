"""What a round of search considers: where it starts, and what belongs there."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.candidates import (
    CURVE,
    Candidate,
    Promised,
    propose_all,
)
from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.search.laws.mending import mends
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.trials.worth import fault_of
from bondgraph.fitting.estimate import FittedModel
from bondgraph.physics.contact import Backlash
from bondgraph.physics.dynamics import LATE, Delay
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.relaxation import StoreBehind
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.domains import Quantity
from bondgraph.structure.edits import InsertElement, LoosenBond

Array = NDArray[np.float64]

NEARLY = 0.25
"""A law that promises this share of what it does at another place may be there."""

SPARE = 2
"""Samples that a law wants for each of its numbers, beside those of the model."""

TWICE = 2
"""So many stores behind resistances of their own may be found at a place."""


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """What a round of search starts from.

    Parameters
    ----------
    base
        The model to improve.
    recordings
        Those that it was fitted to.
    noise
        Residual per output that noise excuses, 0 where it is not known.
    number
        Of the round, from 1.
    found
        What earlier rounds have added and not taken out: no law is added twice.
    curves
        Whether curves without a name are considered.
    supported
        What tells the laws that earlier rounds supported, see `Hypothesis.told_by`.
    pieces
        Of what was found, what a curve may be told in the place of.
    """

    base: FittedModel
    recordings: Sequence[BoundRecording]
    noise: Array
    options: Options
    number: int
    found: tuple[Hypothesis, ...]
    curves: bool
    supported: frozenset[tuple[str, ...]] = frozenset()
    pieces: tuple[Hypothesis, ...] = ()

    @property
    def is_first(self) -> bool:
        """Whether this is the first round."""
        return self.number == 1

    def is_piece(self, chosen: Judged) -> bool:
        """Return whether a curve mends such a law: alone it is drawn, if at all."""
        return any(mends(chosen.candidate.hypothesis, law) for law in self.pieces)

    def fault(self, candidate: Candidate, chunks: int) -> str | None:
        """Return why a law that leads is not the one after all, None where it is.

        Parameters
        ----------
        chunks
            Into how many the data are dealt.
        """
        return fault_of(self.base, candidate, self.recordings, chunks)


def considered(setting: Setting) -> tuple[Hypothesis, ...]:
    """Return what the library proposes for the model, as far as it belongs here.

    A wrong sign or unit shows before anything else. Beside a law that has been found it
    would only bend it: in a unit a thousand times larger every smooth edge is a sharp
    one. So would a law at the contact of a play that has been found, a curve of what
    another law has hung there, or one of the very variable of which a curve has been
    found there; not of a displacement, where a ripple is finer than any curve. And a
    second delay on the only way from an input to a reading: few states draw a delay,
    and two of half the time do so more exactly. No law is added twice but a store
    behind a resistance: what spreads through a body or a cell is a row of them. And no
    law has as many numbers as there are samples to spare.
    """
    contacts = {name for one in setting.found for name in _contact_of(one)}
    drawn = {_variable_of(one) for one in setting.found if one.physics == CURVE}
    there = Counter(_as_told(one) for one in setting.found)
    hung = {o.element for o in setting.found if isinstance(o.edit, InsertElement)}
    # A law with as many numbers passes through every sample, whatever is missing.
    problem = setting.base.problem
    most = (int(problem.measured.sum()) - problem.unknowns) / SPARE
    late = _is_late(setting)
    return tuple(
        one
        for one in propose_all(setting.base, setting.options.library)
        if (setting.curves or one.physics != CURVE)
        and len(one.strengths) <= most
        and (setting.is_first or not one.is_slip)
        and (there[_as_told(one)] == 0 or _in_a_row(one, there[_as_told(one)], setting))
        and one.place not in contacts
        and not (one.physics == CURVE and one.place in hung)
        and not (late and one.physics == Delay.word)
        and (_variable_of(one) is None or _variable_of(one) not in drawn)
    )


def _as_told(law: Hypothesis) -> tuple[str, str, str]:
    """Return what makes a law the same as one that was found."""
    return law.physics, law.place, law.words


def _in_a_row(law: Hypothesis, found: int, setting: Setting) -> bool:
    """Return whether a store that fills in a time of its own may be found once more."""
    if law.physics != StoreBehind.word or found >= TWICE:
        return False
    added = law.apply(setting.base.graph).parameters
    return any(added[name].unit == "s" for name in law.parameters)


def _is_late(setting: Setting) -> bool:
    """Return whether a delay was found where there is one way from input to reading."""
    if all(one.physics != Delay.word for one in setting.found):
        return False
    shots = setting.base.problem.shots
    changing = np.count_nonzero(np.nanstd(shots.inputs, axis=0) > 0.0)
    return bool(changing <= 1 and shots.outputs.shape[1] <= 1)


def _variable_of(law: Hypothesis) -> tuple[str, str] | None:
    """Return the place of what is hung there, and the one flow or effort it reads."""
    common = {Quantity.FLOW.value, Quantity.EFFORT.value}
    hung = isinstance(law.edit, InsertElement) and law.factor == 1
    if not hung or len(law.depends_on) != 1 or law.depends_on[0] not in common:
        return None
    return law.place, law.depends_on[0]


def _contact_of(found: Hypothesis) -> set[str]:
    """Return the names of what a play has put between two motions."""
    edit = found.edit
    if found.physics != Backlash.word or not isinstance(edit, LoosenBond):
        return set()
    return {edit.name, edit.split, *(element.name for element in edit.elements)}


def promising(promised: Sequence[Promised], options: Options) -> list[Promised]:
    """Return the hypotheses worth a fit, those that promise most first.

    And what the best of them contain: a wider law may promise what the narrower one is,
    backlash without a gap what a spring does. And they themselves at other places where
    they promise nearly as much, and the other forms in which a signal comes late.
    """
    worth = options.rule.materiality / 4
    leading = [one for one in promised if one.reduction >= worth][: options.fitted]
    best = leading[: options.judged]
    known = {id(one) for one in leading}
    others = (
        one
        for one in promised
        if id(one) not in known
        and any(
            led.hypothesis.contains(one.hypothesis)
            or _make_one_late(led.hypothesis, one.hypothesis)
            or (
                one.reduction >= NEARLY * led.reduction
                and one.hypothesis.is_elsewhere(led.hypothesis)
            )
            for led in best
        )
    )
    return [*leading, *others]


def _make_one_late(law: Hypothesis, other: Hypothesis) -> bool:
    """Return whether both make the same signal late."""
    return law.physics in LATE and other.physics in LATE and law.place == other.place
