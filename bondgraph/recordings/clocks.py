"""Several clocks: channels of different rates side by side, and how far clocks differ.

Nothing is invented. On a common clock a channel has values where it was measured and
gaps elsewhere; only a command that stays until the next one may be held.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

from bondgraph.choices import is_finite
from bondgraph.errors import RecordingError
from bondgraph.recordings.channel import Channel, FloatArray
from bondgraph.recordings.recording import LEAST_SAMPLES, Recording
from bondgraph.structure.units import compatible

SAME_TIME = 1e-6
"""Times nearer than this share of the finest step are one time."""

COARSE_SAMPLES = 5000
"""Enough to find an offset to within a step."""

LEAST_CORRELATION = 0.5
"""Below it two channels do not show the same motion."""

REFINEMENTS = 6


def on_one_clock(
    recordings: Sequence[Recording],
    *,
    held: Collection[str] = (),
    name: str | None = None,
) -> Recording:
    """Return the channels of several recordings on the union of their clocks.

    Parameters
    ----------
    recordings
        Of the same event, with clocks that agree (see `clock_offset` and
        `Recording.shifted`); their channels have different names.
    held
        Channels that keep their last value between samples, such as commands. Samples
        before the first value of one of them are left out.
    name
        What to call the result; the first recording's name by default.

    Raises
    ------
    RecordingError
        If a recording is a steady table, a channel name comes twice, `held` names no
        channel, or the recordings do not overlap in time.
    """
    _check_mergeable(recordings, held)
    step = min(recording.step for recording in recordings)
    clock = _union([recording.time for recording in recordings], SAME_TIME * step)
    first = np.zeros(clock.size, dtype=np.bool_)
    channels = []
    for recording in recordings:
        rows = _nearest(clock, recording.time)
        for channel in recording.channels:
            values = np.full(clock.size, np.nan)
            values[rows] = channel.values
            if channel.name in held:
                values = _held(values)
                first |= np.isnan(values)
            channels.append(Channel(channel.name, channel.unit, values, gaps=True))
    keep = np.flatnonzero(~first)
    lead = recordings[0]
    digest = sha256("".join(r.sha256 for r in recordings).encode())
    return Recording(
        name=lead.name if name is None else name,
        time=clock[keep],
        channels=tuple(channel.at(keep) for channel in channels),
        source=", ".join(dict.fromkeys(r.source for r in recordings)),
        sha256=digest.hexdigest(),
        notes=tuple(note for r in recordings for note in r.notes),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ClockOffset:
    """How much later one clock shows the same event than another.

    Parameters
    ----------
    seconds
        ``other.shifted(-seconds)`` agrees with the reference.
    std
        Its standard deviation, from what is left after shifting.
    correlation
        Between the two channels after shifting.
    """

    seconds: float
    std: float
    correlation: float


def clock_offset(
    reference: Recording, other: Recording, channel: str, *, most: float
) -> ClockOffset:
    """Return the offset of another clock, from a quantity recorded on both.

    The coarse offset is that of greatest correlation, searched in steps of the finer
    clock; it is refined by least squares (Gauss-Newton) with scale and offset of the
    values left free, as two sensors of one quantity differ in these.

    Parameters
    ----------
    reference, other
        Recordings that both have `channel`.
    channel
        The quantity that both clocks have seen.
    most
        Seconds; the largest offset to look for, either way.

    Raises
    ------
    RecordingError
        If the two do not overlap or do not show the same motion, their units do not
        convert into one another, or one of them was never measured.
    """
    _check_comparable(reference, other, channel, most)
    x, y = (_measured(r, channel) for r in (reference, other))
    step = min(reference.step, other.step)
    stride = -(-x[0].size // COARSE_SAMPLES)
    coarse = (x[0][::stride], x[1][::stride])
    offsets = np.arange(-np.floor(most / step), np.floor(most / step) + 1) * step
    found = [abs(_correlation(coarse, y, offset)) for offset in offsets]
    fits = [-1.0 if np.isnan(fit) else fit for fit in found]  # nan: nothing moves there
    if max(fits) < LEAST_CORRELATION:
        raise RecordingError(
            f"{channel!r} of {reference.name!r} and of {other.name!r} do not show the "
            f"same motion within {most:g} s.",
            (reference.name, other.name, channel),
            "Search further, or compare a channel that both clocks have seen.",
        )
    best = float(offsets[int(np.argmax(fits))])
    std = float("nan")
    for _ in range(REFINEMENTS):
        move, std = _refined(x, y, best)
        best += float(np.clip(move, -step, step))
    return ClockOffset(
        seconds=best, std=std, correlation=float(_correlation(x, y, best))
    )


def _check_comparable(
    reference: Recording, other: Recording, channel: str, most: float
) -> None:
    """Refuse what no offset can be told from; scales and levels may differ."""
    units = [recording.channel(channel).unit for recording in (reference, other)]
    names = (reference.name, other.name, channel)
    if not compatible(*units):
        raise RecordingError(
            f"{channel!r} is in {units[0]!r} in {names[0]!r} and in {units[1]!r} in "
            f"{names[1]!r}.",
            names,
            "Compare a quantity that both clocks have seen.",
        )
    for recording in (reference, other):
        if np.isfinite(recording.channel(channel).values).sum() < LEAST_SAMPLES:
            raise RecordingError(
                f"{channel!r} of {recording.name!r} has fewer than {LEAST_SAMPLES} "
                "samples that were measured.",
                (recording.name, channel),
                "Compare another channel.",
            )
    if not (is_finite(most) and most >= 0.0):
        raise RecordingError(
            f"An offset of at most {most!r} s cannot be looked for.",
            names,
            "Give the largest offset in seconds, such as most=1.0.",
        )


def _measured(recording: Recording, name: str) -> tuple[FloatArray, FloatArray]:
    values = recording.channel(name).values
    there = np.isfinite(values)
    return recording.time[there], values[there]


def _overlapping(
    x: tuple[FloatArray, FloatArray], y: tuple[FloatArray, FloatArray], offset: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return times of x that y covers, with x there and y `offset` later."""
    inside = (x[0] + offset >= y[0][0]) & (x[0] + offset <= y[0][-1])
    time = x[0][inside]
    return time, x[1][inside], np.interp(time + offset, y[0], y[1])


def _correlation(
    x: tuple[FloatArray, FloatArray], y: tuple[FloatArray, FloatArray], offset: float
) -> float:
    _, one, two = _overlapping(x, y, offset)
    if one.size < max(LEAST_SAMPLES, 0.1 * min(x[0].size, y[0].size)):
        return float("nan")
    one, two = one - one.mean(), two - two.mean()
    size = float(np.sqrt((one @ one) * (two @ two)))
    return float(one @ two) / size if size > 0.0 else float("nan")


def _refined(
    x: tuple[FloatArray, FloatArray], y: tuple[FloatArray, FloatArray], offset: float
) -> tuple[float, float]:
    """Return the least-squares move of the offset and its standard deviation."""
    time, one, two = _overlapping(x, y, offset)
    # x = scale * y(t + offset + move) + level, linear in (scale, level, scale * move)
    slope = np.gradient(two, time)
    columns = np.column_stack([two, np.ones_like(two), slope])
    found, *_ = np.linalg.lstsq(columns, one, rcond=None)
    left = one - columns @ found
    covariance = np.linalg.pinv(columns.T @ columns) * (left @ left) / max(one.size, 1)
    scale = found[0] if found[0] != 0.0 else np.inf
    return float(found[2] / scale), float(np.sqrt(covariance[2, 2]) / abs(scale))


def _union(clocks: Sequence[FloatArray], tolerance: float) -> FloatArray:
    """Return all times in order, those nearer than `tolerance` once."""
    times = np.sort(np.concatenate(clocks))
    union: FloatArray = times[np.diff(times, prepend=-np.inf) > tolerance]
    return union


def _nearest(clock: FloatArray, time: FloatArray) -> NDArray[np.intp]:
    """Return for each time the row of the clock that stands for it."""
    after = np.clip(np.searchsorted(clock, time), 1, clock.size - 1)
    nearer = np.abs(time - clock[after - 1]) <= np.abs(clock[after] - time)
    return np.where(nearer, after - 1, after)


def _held(values: FloatArray) -> FloatArray:
    """Return the values with each gap filled by the last one before it."""
    rows = np.where(np.isnan(values), -1, np.arange(values.size))
    last = np.maximum.accumulate(rows)
    return np.where(last >= 0, values[last], np.nan)


def _check_mergeable(recordings: Sequence[Recording], held: Collection[str]) -> None:
    if not recordings:
        raise RecordingError("There is no recording.", (), "Give at least one.")
    names = [name for recording in recordings for name in recording.names]
    for recording in recordings:
        if recording.steady:
            raise RecordingError(
                f"{recording.name!r} is a steady table and has no clock.",
                (recording.name,),
                "Put recordings in time on one clock only.",
            )
    for name in names:
        if names.count(name) > 1:
            raise RecordingError(
                f"Two of the recordings have a channel {name!r}.",
                (name,),
                "Rename one with renamed({...}), or leave it out with select(...).",
            )
    for name in held:
        if name not in names:
            raise RecordingError(
                f"held names {name!r}, which is not a channel.",
                (name,),
                f"There are {', '.join(names)}.",
            )
    begin = max(recording.time[0] for recording in recordings)
    end = min(recording.time[-1] for recording in recordings)
    if begin > end:
        raise RecordingError(
            "The recordings do not overlap in time.",
            tuple(recording.name for recording in recordings),
            "Set their clocks with shifted(seconds) first.",
        )
