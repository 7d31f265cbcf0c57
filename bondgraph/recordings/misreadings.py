"""Misreadings: what a sensor told that the machine did not do.

A single sample that jumps away and back, a stretch in which a sensor has frozen, and
what a log repeats between two updates of a slow one are taken for missing, so that no
law is bent to explain them. An angle that begins again after a whole turn is made to
go on. All of it is told.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import bdtrc

from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.held import frozen, held, stale
from bondgraph.recordings.outliers import outliers
from bondgraph.recordings.turns import unwrapped

STEPPED = 0.05
"""An input steps where it changes by more than this share of its range at once."""

SELDOM = 0.2
"""Of an input that steps in more of the rows than this any row follows a step."""

BY_CHANCE = 0.01
"""Misreadings come with the steps of an input so often with this probability."""


@dataclass(frozen=True, slots=True)
class Cleared:
    """Recordings as they can be compared, and a sentence for each channel changed."""

    recordings: tuple[BoundRecording, ...]
    notes: tuple[str, ...]


def without_misreadings(recordings: Sequence[BoundRecording]) -> Cleared:
    """Return recordings with misread samples of outputs missing, and angles that go on.

    Only what was measured is taken for misread, not what was commanded; and a machine
    that is switched may well jump: jumps that come as an input steps are kept, where
    more of them do than by chance.
    """
    cleared, notes = [], []
    for recording in recordings:
        told: list[str] = []
        outputs = recording.outputs.copy()
        driven = _driven(recording.inputs)
        for column, name in enumerate(recording.output_names):
            of = f"{name} of {recording.name}"
            if not recording.steady:
                unit = recording.output_units[column]
                told += _gone_on(outputs[:, column], unit, of)
                told += _read_anew(outputs[:, column], of)
                told += _in_time(outputs[:, column], recording.time, driven, of)
                told += _thawed(outputs[:, column], recording.time, driven, of)
                told += _left_out(outputs[:, column], recording.time, driven, of)
        cleared.append(replace(recording, outputs=outputs) if told else recording)
        notes += told
    return Cleared(tuple(cleared), tuple(notes))


def _gone_on(values: FloatArray, unit: str, of: str) -> list[str]:
    """Let `values` of an angle go on, and return what was done."""
    found = unwrapped(values, unit)
    if found is None:
        return []
    values[:], times = found
    often = "once" if times == 1 else f"{times} times"
    return [f"{of} jumps by a whole turn {often}: taken to go on turning."]


def _read_anew(values: FloatArray, of: str) -> list[str]:
    """Leave what is merely repeated out of `values`, and return what was done."""
    found = held(values)
    if found is None:
        return []
    values[found.rows] = np.nan
    return [
        f"{of} changes only every {found.every} samples or so: what is repeated in "
        "between is taken for held, not read anew."
    ]


def _thawed(
    values: FloatArray, time: FloatArray, driven: NDArray[np.bool_], of: str
) -> list[str]:
    """Leave stretches in which a sensor has frozen out of `values`, and say so."""
    stretches = [rows for rows in frozen(time, values) if not driven[rows.stop]]
    for rows in stretches:
        values[rows.start + 1 : rows.stop] = np.nan
    if not stretches:
        return []
    where = ", ".join(
        f"{time[rows.start]:.6g} to {time[rows.stop - 1]:.6g} s"
        for rows in stretches[:3]
    )
    more = f" and {len(stretches) - 3} more times" if len(stretches) > 3 else ""
    return [
        f"{of} stands still from {where}{more} and then jumps: taken for frozen, not "
        "used."
    ]


def _in_time(
    values: FloatArray, time: FloatArray, driven: NDArray[np.bool_], of: str
) -> list[str]:
    """Leave readings of before a gap in time out of `values`, and say so."""
    rows = [int(row) for row in stale(time, values) if not driven[row + 1]]
    if not rows:
        return []
    values[rows] = np.nan
    return [
        f"{of} has at {_counted(rows, time)}, behind a gap in time, what was read "
        "before the gap: not used."
    ]


def _counted(rows: Sequence[int], time: FloatArray) -> str:
    """Return where the first of some samples are, and how many more there are."""
    more = f" and {len(rows) - 5} more" if len(rows) > 5 else ""
    when = ", ".join(f"{time[row]:.6g} s" for row in rows[:5])
    which = ", ".join(map(str, rows[:5]))
    word = "sample" if len(rows) == 1 else "samples"
    return f"{when}{more} ({word} {which}, counted from 0)"


def _driven(inputs: FloatArray) -> NDArray[np.bool_]:
    """Return which rows an input that seldom steps has just stepped in or before."""
    driven = np.zeros(len(inputs), dtype=bool)
    for values in inputs.T:
        changes = np.abs(np.diff(values, prepend=values[:1]))
        stepped = changes > STEPPED * np.ptp(values)
        if np.mean(stepped) <= SELDOM:
            driven |= stepped
            driven[1:] |= stepped[:-1]
    return driven


def _left_out(
    values: FloatArray, time: FloatArray, driven: NDArray[np.bool_], of: str
) -> list[str]:
    """Leave misread samples out of `values`, and return what was done."""
    found = outliers(time, values)
    switched, share = int(driven[found].sum()), float(driven.mean())
    if bdtrc(switched - 1, len(found), share) <= BY_CHANCE:
        found = found[~driven[found]]
    rows = [int(row) for row in found]
    if not rows:
        return []
    values[rows] = np.nan
    return [
        f"{of} jumps away and back at {_counted(rows, time)}: taken for a misreading, "
        "not used."
    ]
