"""Rows as they come, and the repairs that a user may ask for before they are samples.

Every repair has a refusal as its default, which names the place in the file, and leaves
a note when it is done: a recording that was mended says so.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import RecordingError
from bondgraph.recordings.channel import FloatArray

LARGEST = 1e100
"""No reading in any unit is beyond it, and its square is a number all the same."""

Gaps = Literal["refuse", "drop", "keep"]
Order = Literal["refuse", "sort"]
Repeats = Literal["refuse", "first", "mean"]


class AbstractTable(ABC):
    """Named columns of numbers somewhere outside.

    Parameters
    ----------
    source
        Path or description, as messages name it.
    sha256
        Of the content.
    headers
        One text per column, ``name`` or ``name [unit]``.
    """

    source: str
    sha256: str
    headers: tuple[str, ...]
    has_units = True

    @abstractmethod
    def columns(self, indices: Sequence[int]) -> list[FloatArray]:
        """Return the columns numbered `indices`; nan stands for an empty cell."""

    def blocks(self, indices: Sequence[int]) -> Iterator[list[FloatArray]]:
        """Yield the columns numbered `indices` in consecutive blocks of rows.

        All at once where the kind of file has no pieces to be read by.
        """
        yield self.columns(indices)

    def row(self, i: int) -> str:
        """Return what row `i` of the columns is called in the file."""
        return f"row {i}"


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """Columns of a table on their way to a recording, time first if there is one.

    ``rows`` keeps the number of each sample in the table, for messages.
    """

    table: AbstractTable
    columns: list[FloatArray]
    rows: NDArray[np.intp]
    notes: tuple[str, ...] = ()

    def take(
        self, chosen: NDArray[np.bool_] | NDArray[np.intp], note: str
    ) -> "Samples":
        """Return the chosen samples, with a note saying why."""
        return replace(
            self,
            columns=[column[chosen] for column in self.columns],
            rows=self.rows[chosen],
            notes=(*self.notes, note),
        )

    def scaled(self, scale: float) -> "Samples":
        """Return the samples with the first column (time) multiplied."""
        return replace(self, columns=[self.columns[0] * scale, *self.columns[1:]])

    def where(self, i: int) -> str:
        """Return what sample `i` is called in the file."""
        return self.table.row(int(self.rows[i]))


def without_gaps(
    samples: Samples, names: Sequence[str], gaps: Gaps, clock: str | None
) -> Samples:
    """Return the samples whose cells are all finite, or refuse the first gap.

    Where gaps are kept, the clock must be finite all the same.
    """
    table, keep = samples.table, np.ones(samples.rows.size, dtype=np.bool_)
    if gaps == "keep":
        samples = _with_gaps(samples, names, clock)
    for name, column in zip(names, samples.columns, strict=True):
        if gaps == "keep" and name != clock:
            continue
        bad = np.flatnonzero(~_measurable(column))
        if bad.size and gaps != "drop":
            raise RecordingError(
                f"Channel {name!r} of {table.source!r} is {_fault(column[bad])} in "
                f"{bad.size} of {column.size} samples, first {column[bad[0]]} at "
                f"{samples.where(int(bad[0]))}.",
                (table.source, name),
                'Drop those rows with gaps="drop", keep what else they hold with '
                'gaps="keep", or leave the channel out with channels=(...).',
            )
        keep[bad] = False
    dropped = int(keep.size - keep.sum())
    if not dropped:
        return samples
    return samples.take(keep, f"{dropped} samples with missing values were dropped.")


def _measurable(column: FloatArray) -> NDArray[np.bool_]:
    """Return which numbers can be readings; squares of what is not overflow."""
    good: NDArray[np.bool_] = np.abs(column) < LARGEST
    return good


def _fault(values: FloatArray) -> str:
    if np.isfinite(values).all():
        return f"beyond {LARGEST:g}"
    return "not a finite number"


def _with_gaps(samples: Samples, names: Sequence[str], clock: str | None) -> Samples:
    """Return the samples with NaN for what is missing, and a note for each channel."""
    columns, notes = [], []
    for name, column in zip(names, samples.columns, strict=True):
        missing = ~_measurable(column)
        if name != clock and missing.any():
            column = np.where(missing, np.nan, column)  # noqa: PLW2901
            notes.append(
                f"{missing.sum()} samples of {name} with missing values are kept as "
                "gaps."
            )
        columns.append(column)
    return replace(samples, columns=columns, notes=(*samples.notes, *notes))


def in_order(samples: Samples, clock: str, order: Order) -> Samples:
    """Return the samples sorted by time, or refuse the first step backward."""
    time = samples.columns[0]
    backward = np.flatnonzero(np.diff(time) < 0)
    if not backward.size:
        return samples
    i = int(backward[0])
    if order == "refuse":
        raise RecordingError(
            f"The time of {samples.table.source!r} runs backward in {_places(backward)}"
            f" {samples.where(i + 1)}: {time[i + 1]:.9g} s after {time[i]:.9g} s.",
            (samples.table.source, clock),
            'Sort the samples with order="sort" if their times are right.',
        )
    return samples.take(
        np.argsort(time, kind="stable"), "The samples were sorted by time."
    )


def without_repeats(samples: Samples, clock: str, repeats: Repeats) -> Samples:
    """Return one sample per time, or refuse the first time that comes twice."""
    time = samples.columns[0]
    repeated = np.flatnonzero(np.diff(time) == 0)
    if not repeated.size:
        return samples
    i = int(repeated[0]) + 1
    if repeats == "refuse":
        raise RecordingError(
            f"The time of {samples.table.source!r} repeats in {_places(repeated)} "
            f"{samples.where(i)}: {time[i]:.9g} s again.",
            (samples.table.source, clock),
            'Keep the first sample of each time with repeats="first", or average '
            'them with repeats="mean".',
        )
    first = np.flatnonzero(np.diff(time, prepend=-np.inf) > 0)
    verb = "averaged" if repeats == "mean" else "dropped"
    kept = samples.take(
        first, f"{repeated.size} samples with a repeated time were {verb}."
    )
    if repeats == "first":
        return kept
    counts = np.diff(first, append=time.size)
    means = [np.add.reduceat(column, first) / counts for column in samples.columns[1:]]
    return replace(kept, columns=[kept.columns[0], *means])


def _places(where: NDArray[np.intp]) -> str:
    if where.size == 1:
        return "one place,"
    return f"{where.size} places, first at"
