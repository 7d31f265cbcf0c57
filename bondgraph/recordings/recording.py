"""A recording: channels with names and units on one clock, frozen once it is made.

Time is in seconds and strictly increasing; steps need not be equal. Values are
read-only and finite, except that a channel with gaps has nan where it was not
measured. A *steady* recording is a table of independent operating points: it has no
clock, and its ``time`` merely counts the rows.
"""

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondgraph.errors import MissingExtraError, RecordingError, did_you_mean
from bondgraph.recordings.channel import Channel, FloatArray, numbers, read_only
from bondgraph.recordings.names import join_header

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

LEAST_SAMPLES = 8
"""A recording with fewer samples says nothing about dynamics."""

LEAST_ROWS = 2
"""A steady table with fewer rows says nothing at all."""

UNIFORM_TOLERANCE = 1e-3
"""Steps that differ from the median step by less than this share are equal."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recording:
    """Channels sampled together.

    Parameters
    ----------
    name
        What the recording is called in answers and reports.
    time
        Seconds, strictly increasing; the row number where `steady`.
    channels
        In the order of the file; names differ.
    source
        Path of the file, or where else the numbers came from.
    sha256
        Of the file's content (of the numbers, where there is no file).
    steady
        Whether the rows are independent operating points.
    unread
        Names of columns that were left in the file.
    notes
        What was repaired or assumed on the way in, in sentences.
    """

    name: str
    time: FloatArray
    channels: tuple[Channel, ...]
    source: str = ""
    sha256: str = ""
    steady: bool = False
    unread: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", read_only(self.time))
        _check_clock(self.name, self.time)
        for channel in self.channels:
            if channel.values.shape != self.time.shape:
                raise RecordingError(
                    f"Channel {channel.name!r} of {self.name!r} has "
                    f"{channel.values.size} samples and time has {self.time.size}.",
                    (self.name, channel.name),
                    "Give every channel one value per time.",
                )
        for name in self.names:
            if self.names.count(name) > 1:
                raise RecordingError(
                    f"Two channels of {self.name!r} are called {name!r}.",
                    (self.name, name),
                    "Give every channel a name of its own.",
                )

    @classmethod
    def from_arrays(
        cls,
        name: str,
        time: ArrayLike | None,
        channels: Mapping[str, tuple[ArrayLike, str]],
        *,
        source: str = "arrays",
    ) -> "Recording":
        """Return the recording made of arrays.

        Parameters
        ----------
        name
            What to call it.
        time
            Seconds, or None if the rows are independent operating points.
        channels
            ``{name: (values, unit)}``.
        source
            Where the numbers came from.

        Raises
        ------
        RecordingError
            If the arrays are not numbers of one length, not finite, fewer than 8
            samples (2 rows without time), or time does not increase.
        """
        made = tuple(
            Channel(n, unit, numbers(n, v)) for n, (v, unit) in channels.items()
        )
        if not made:
            raise RecordingError(
                f"{name!r} has no channels.", (name,), "Give at least one."
            )
        if time is None:
            clock = np.arange(made[0].values.size, dtype=np.float64)
        else:
            clock = numbers("time", time)
        check_count(name, clock.size, steady=time is None)
        content = sha256(np.ascontiguousarray(clock).data)
        for channel in made:
            content.update(f"{channel.name} [{channel.unit}]".encode())
            content.update(channel.values.data)
        return cls(
            name=name,
            time=clock,
            channels=made,
            source=source,
            sha256=content.hexdigest(),
            steady=time is None,
        )

    def to_pandas(self) -> "pd.DataFrame":
        """Return a data frame with the columns ``time [s]`` and ``name [unit]``.

        A steady recording has no time column.

        Raises
        ------
        MissingExtraError
            If pandas is not installed.
        """
        try:
            import pandas as pd  # noqa: PLC0415
        except ImportError as error:
            raise MissingExtraError(
                "A data frame needs pandas.",
                ("pandas",),
                "Install bondgraph-workbench[data].",
            ) from error
        columns = {} if self.steady else {join_header("time", "s"): self.time}
        columns |= {join_header(c.name, c.unit): c.values for c in self.channels}
        return pd.DataFrame({header: v.copy() for header, v in columns.items()})

    def to_xarray(self) -> "xr.Dataset":
        """Return a data set along ``time`` with units in ``attrs["units"]``.

        The dimension of a steady recording is called ``row``.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        try:
            import xarray as xr  # noqa: PLC0415
        except ImportError as error:
            raise MissingExtraError(
                "A data set needs xarray.",
                ("xarray",),
                "Install bondgraph-workbench[data].",
            ) from error
        along = "row" if self.steady else "time"
        time = (along, self.time.copy(), {"units": "s"})
        return xr.Dataset(
            {
                c.name: (along, c.values.copy(), {"units": c.unit})
                for c in self.channels
            },
            coords={} if self.steady else {along: time},
            attrs={"name": self.name, "source": self.source},
        )

    def __len__(self) -> int:
        return self.time.size

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the channels, in order."""
        return tuple(channel.name for channel in self.channels)

    @property
    def duration(self) -> float:
        """Seconds from the first sample to the last; nan for a steady table."""
        return float("nan") if self.steady else float(self.time[-1] - self.time[0])

    @property
    def step(self) -> float:
        """The median sampling step in seconds; nan for a steady table."""
        if self.steady or len(self) < 2:
            return float("nan")
        return float(np.median(np.diff(self.time)))

    @property
    def uniform(self) -> bool:
        """Whether all steps are equal to within 0.1 %; False for a steady table."""
        if self.steady or len(self) < 2:
            return False
        steps = np.diff(self.time)
        return bool(np.all(abs(steps - self.step) <= UNIFORM_TOLERANCE * self.step))

    def channel(self, name: str) -> Channel:
        """Return the channel called `name`, or refuse naming the closest ones."""
        for channel in self.channels:
            if channel.name == name:
                return channel
        raise RecordingError(
            f"Recording {self.name!r} has no channel {name!r}.",
            (self.name, name),
            did_you_mean(name, self.names),
        )

    def values(self, *names: str) -> FloatArray:
        """Return the named channels as an array ``[sample, channel]``."""
        columns = [self.channel(name).values for name in names or self.names]
        return read_only(np.stack(columns, axis=1) if columns else [[]] * len(self))

    def part(self, start: int, stop: int) -> "Recording":
        """Return the samples ``start <= i < stop`` (negative: from the end).

        The part keeps the clock, the source and its hash; its name says which samples.
        """
        part = part_range(self.name, len(self), start, stop)
        return self.rows(part, name=f"{self.name}[{part.start}:{part.stop}]")

    def between(self, first: float, last: float) -> "Recording":
        """Return the part between two fractions (0 to 1) of the samples."""
        if not 0.0 <= first < last <= 1.0:
            raise RecordingError(
                f"{first} to {last} is not a part of {self.name!r}.",
                (self.name,),
                "Give two fractions with 0 <= first < last <= 1.",
            )
        return self.part(round(first * len(self)), round(last * len(self)))

    def rows(self, rows: Sequence[int], *, name: str | None = None) -> "Recording":
        """Return the samples numbered `rows` (increasing)."""
        chosen = as_index(rows)
        return replace(
            self,
            name=self.name if name is None else name,
            time=self.time[chosen],
            channels=tuple(channel.at(chosen) for channel in self.channels),
        )

    def select(self, *names: str) -> "Recording":
        """Return the recording with these channels only, in this order."""
        left = tuple(name for name in self.names if name not in names)
        return replace(
            self,
            channels=tuple(self.channel(name) for name in names),
            unread=self.unread + left,
        )

    def renamed(self, mapping: Mapping[str, str]) -> "Recording":
        """Return the recording with channels renamed, ``{old name: new name}``."""
        for old in mapping:
            self.channel(old)
        return replace(
            self,
            channels=tuple(
                replace(c, name=mapping.get(c.name, c.name)) for c in self.channels
            ),
        )

    def converted(self, name: str, unit: str) -> "Recording":
        """Return the recording with one channel converted to another unit."""
        new = self.channel(name).to(unit)
        return replace(
            self,
            channels=tuple(new if c.name == name else c for c in self.channels),
        )

    def shifted(self, seconds: float) -> "Recording":
        """Return the recording with its clock set later by `seconds`."""
        if self.steady:
            raise RecordingError(
                f"{self.name!r} is a steady table and has no clock.",
                (self.name,),
                "Shift recordings in time only.",
            )
        return replace(self, time=self.time + seconds)

    def __repr__(self) -> str:
        clock = "steady" if self.steady else f"{self.duration:.4g} s"
        names = ", ".join(f"{c.name} [{c.unit}]" for c in self.channels)
        return f"<Recording {self.name!r}: {len(self)} samples, {clock}; {names}>"

    def _repr_html_(self) -> str:
        clock = (
            "independent rows"
            if self.steady
            else f"{self.duration:.4g} s, median step {self.step:.4g} s"
        )
        body = "".join(_html_row(channel) for channel in self.channels)
        caption = html.escape(f"{self.name}: {len(self)} samples, {clock}")
        heads = "".join(f"<th>{h}</th>" for h in ("channel", "unit", *_STATISTICS))
        return (
            f"<table><caption>{caption}</caption>"
            f"<thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>"
        )


_STATISTICS = ("least", "mean", "greatest", "std")


def _html_row(channel: Channel) -> str:
    v = channel.values
    numbers = (np.nanmin(v), np.nanmean(v), np.nanmax(v), np.nanstd(v))
    cells = (channel.name, channel.unit, *(f"{number:.4g}" for number in numbers))
    return "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"


def _check_clock(name: str, time: FloatArray) -> None:
    if time.ndim != 1 or time.size == 0 or not np.all(np.isfinite(time)):
        raise RecordingError(
            f"The time of {name!r} is not a vector of finite numbers.",
            (name, "time"),
            "Give one time in seconds per sample.",
        )
    backward = np.flatnonzero(np.diff(time) <= 0)
    if backward.size:
        i = int(backward[0])
        raise RecordingError(
            f"The time of {name!r} does not increase from sample {i} ({time[i]:.9g} s) "
            f"to {i + 1} ({time[i + 1]:.9g} s).",
            (name, "time"),
            "Sort the samples and keep one per time.",
        )


def check_count(name: str, count: int, *, steady: bool) -> None:
    """Refuse a recording that is too short to say anything."""
    least = LEAST_ROWS if steady else LEAST_SAMPLES
    if count < least:
        raise RecordingError(
            f"{name!r} has {count} sample{'s' * (count != 1)}; "
            f"at least {least} are needed.",
            (name,),
            "Record longer, or check that the recording is complete.",
        )


def part_range(name: str, size: int, start: int, stop: int) -> range:
    """Return the samples of a part, refusing an empty one."""
    first, last, _ = slice(start, stop).indices(size)
    if last <= first:
        raise RecordingError(
            f"The part {start}:{stop} of {name!r} is empty.",
            (name,),
            f"It has {size} samples.",
        )
    return range(first, last)


def as_index(rows: Sequence[int]) -> slice | NDArray[np.intp]:
    """Return `rows` as an index; a range is a slice, which copies nothing."""
    if isinstance(rows, range):
        return slice(rows.start, rows.stop, rows.step)
    return np.asarray(rows, dtype=np.intp)
