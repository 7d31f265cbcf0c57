"""From any table of columns to a checked `Recording`: the one gate of this package.

A reader only finds columns and rows (an `AbstractTable`). Which column is which
channel, in what unit, and whether the numbers can be trusted is decided here, the same
way for every kind of file. Nothing is guessed: what is missing, double or broken is
refused with its place in the file, and what is repaired on request is noted.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bondgraph.errors import RecordingError, did_you_mean
from bondgraph.recordings.channel import Channel
from bondgraph.recordings.names import split_header
from bondgraph.recordings.recording import Recording, check_count
from bondgraph.recordings.repairs import (
    AbstractTable,
    Gaps,
    Order,
    Repeats,
    Samples,
    in_order,
    without_gaps,
    without_repeats,
)
from bondgraph.structure.units import compatible, conversion

MOST_NAMES_LISTED = 20
"""A message that lists more names is not one line any more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choices:
    """How a table is to be read; see `read_recording` for the words."""

    name: str | None = None
    mapping: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    channels: tuple[str, ...] | None = None
    time: str | None = "time"
    step: float | None = None
    steady: bool = False
    gaps: Gaps = "refuse"
    order: Order = "refuse"
    repeats: Repeats = "refuse"

    def __post_init__(self) -> None:
        allowed = {
            "gaps": ("refuse", "drop", "keep"),
            "order": ("refuse", "sort"),
            "repeats": ("refuse", "first", "mean"),
        }
        for choice, words in allowed.items():
            word = getattr(self, choice)
            if word not in words:
                raise RecordingError(
                    f"{choice}={word!r} is not a choice.",
                    (choice, str(word)),
                    f"Write one of {', '.join(words)}.",
                )
        if self.step is not None and not 0 < self.step < np.inf:
            raise RecordingError(
                f"step={self.step!r} is not a sampling step.",
                ("step",),
                "Give a positive number of seconds.",
            )

    @property
    def clock(self) -> str | None:
        """The name of the time column, or None if there is none to be read."""
        return None if self.steady or self.step is not None else self.time

    @property
    def rows_are_independent(self) -> bool:
        """Whether the table was said to have no clock at all."""
        return self.steady or (self.time is None and self.step is None)


@dataclass(frozen=True, slots=True)
class _Wanted:
    """One column to be read: its number, and the channel it becomes."""

    index: int
    name: str
    unit: str


def read_table(table: AbstractTable, choices: Choices) -> Recording:
    """Return the recording that `choices` make of `table`.

    Raises
    ------
    RecordingError
        If a channel or unit is missing, or the numbers are not a recording.
    """
    wanted, unread = _plan(table, choices)
    columns = table.columns([w.index for w in wanted])
    steady = choices.rows_are_independent
    check_count(table.source, columns[0].size, steady=steady)
    samples = Samples(table, columns, np.arange(columns[0].size))
    names = [w.name for w in wanted]
    samples = without_gaps(samples, names, choices.gaps, choices.clock)
    if choices.clock is not None:
        samples = samples.scaled(conversion(wanted[0].unit, "s")[0])
        samples = in_order(samples, choices.clock, choices.order)
        samples = without_repeats(samples, choices.clock, choices.repeats)
        time, *columns = samples.columns
        channels = wanted[1:]
    else:
        # With a known step a dropped row leaves a hole in time, not a shorter time.
        time = np.asarray(samples.rows * (choices.step or 1.0), dtype=np.float64)
        columns, channels = samples.columns, wanted
    check_count(table.source, time.size, steady=steady)
    return Recording(
        name=choices.name or table.source,
        time=time,
        channels=tuple(
            Channel(w.name, w.unit, c, gaps=bool(np.isnan(c).any()))
            for w, c in zip(channels, columns, strict=True)
        ),
        source=table.source,
        sha256=table.sha256,
        steady=steady,
        unread=unread,
        notes=(*samples.notes, *_overruled(table, wanted, choices)),
    )


def _overruled(
    table: AbstractTable, wanted: Sequence[_Wanted], choices: Choices
) -> Iterator[str]:
    """Yield a sentence for each thing that the file says and a choice says otherwise.

    A unit that does not convert was changed on purpose.
    """
    written = [split_header(" ".join(header.split())) for header in table.headers]
    if choices.step is not None and choices.time in [name for name, _ in written]:
        yield (
            f"The column {choices.time!r} was left aside: samples are "
            f"{choices.step:g} s apart, as step says."
        )
    for one in wanted:
        unit = written[one.index][1]
        if unit and unit != one.unit and compatible(unit, one.unit):
            yield (
                f"{one.name} was read in {one.unit}, as asked; its header says {unit}."
            )


def _plan(
    table: AbstractTable, choices: Choices
) -> tuple[list[_Wanted], tuple[str, ...]]:
    """Return the columns to read (time first) and the names left in the file."""
    written = [split_header(" ".join(header.split())) for header in table.headers]
    names = [name for name, _ in written]
    sources = _sources(table, names, choices)
    wanted = []
    for name, source in sources.items():
        column, unit = split_header(source)
        index = _find(table, names, name, column)
        unit = choices.units.get(name) or unit or written[index][1]
        wanted.append(_Wanted(index, name, _checked_unit(table, name, unit, choices)))
    if len(wanted) == (choices.clock is not None):
        raise RecordingError(
            f"{table.source!r} has no channel to read.",
            (table.source,),
            "Check the header, and channels=(...) if it was given.",
        )
    for name in choices.units:
        known = {*sources, *names, *choices.mapping}
        if name not in known:
            raise RecordingError(
                f"units names {name!r}, which is not a channel of {table.source!r}.",
                (table.source, name),
                did_you_mean(name, known),
            )
    read = {w.index for w in wanted}
    return wanted, tuple(n for i, n in enumerate(names) if i not in read and n)


def _sources(
    table: AbstractTable, names: list[str], choices: Choices
) -> dict[str, str]:
    """Return for every channel wanted, time first, the column it comes from."""
    if choices.channels is not None:
        chosen = list(choices.channels)
    elif table.has_units:
        _check_headers(table, names)
        back = {split_header(source)[0]: n for n, source in choices.mapping.items()}
        chosen = [back.get(name, name) for name in names] + list(choices.mapping)
    elif choices.mapping:
        chosen = list(choices.mapping)
    else:
        raise RecordingError(
            f"{table.source!r} does not say which of its variables are channels.",
            (table.source,),
            'Say so with mapping={"time": "t [s]", "position": "x [m]"}; it has '
            f"{', '.join(names[:MOST_NAMES_LISTED]) or 'none'}.",
        )
    if choices.clock is not None:
        chosen.insert(0, choices.clock)
    return {name: choices.mapping.get(name, name) for name in chosen}


def _check_headers(table: AbstractTable, names: list[str]) -> None:
    for i, name in enumerate(names):
        if not name:
            raise RecordingError(
                f"Column {i + 1} of {table.source!r} has no name.",
                (table.source,),
                "Name it in the header, or say which to read with channels=(...).",
            )


def _find(table: AbstractTable, names: list[str], name: str, column: str) -> int:
    """Return the number of the column called `column`, wanted as `name`."""
    found = [i for i, known in enumerate(names) if known == column]
    if len(found) == 1:
        return found[0]
    mapped = "" if name == column else f" (wanted as {name!r})"
    if found:
        raise RecordingError(
            f"{table.source!r} has {len(found)} columns called {column!r}{mapped}: "
            f"{' and '.join(str(i + 1) for i in found)}.",
            (table.source, column),
            "Rename one of them.",
        )
    known = sorted({n for n in names if n})
    remedy = did_you_mean(column, known)
    if name == "time" and column == "time":
        remedy += (
            " Name the time column with time=..., give step=... in seconds, or say "
            "steady=True if every row is an operating point of its own."
        )
    else:
        remedy += f" Map another to it: {name}=COLUMN."
    raise RecordingError(
        f"{table.source!r} has no column {column!r}{mapped}.",
        (table.source, column),
        remedy,
    )


def _checked_unit(
    table: AbstractTable, name: str, unit: str | None, choices: Choices
) -> str:
    if unit is None:
        raise RecordingError(
            f"Channel {name!r} of {table.source!r} has no unit.",
            (table.source, name),
            f"Write it as '{name} [unit]' ([1] if it has none), or give "
            f'units={{"{name}": "UNIT"}}.',
        )
    # Other units are free words until a model asks for them (see `bind`).
    if name == choices.clock and not compatible(unit, "s"):
        raise RecordingError(
            f"The time {name!r} of {table.source!r} is in {unit!r}.",
            (table.source, name, unit),
            f'Give it in s, ms or min, or say so with units={{"{name}": "s"}}.',
        )
    return unit
