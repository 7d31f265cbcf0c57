"""Windows: stretches of a recording without gaps, cut to length; splits and blocks.

A step of more than three median steps is a gap, unless its neighbours are as long (a
logger that slows down at rest), or such steps are common and not much longer (an uneven
clock). Nothing may be simulated across a gap.
A window is a range of samples, so that it costs nothing and means the same for every
channel. Steady tables have no time to be cut in; their rows are dealt out evenly.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from bondgraph.errors import RecordingError
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.recording import Recording

GAP_FACTOR = 3.0
"""A step of more than this many median steps is a gap, where such steps are rare."""

SURE_GAP = 10.0
"""And one of more than this many always is."""

NEIGHBOURS = 5
"""The median of so many steps around one is what is typical there."""

RARE_SHARE, RARE_COUNT = 0.02, 5
"""So many steps, of all or at all, are rare."""

BURSTS = 10
"""So many stretches, all of them short, are how a logger writes."""

SHORTEST_WINDOW = 8
"""Samples; a remainder shorter than this joins the window before it."""

AnyRecording = TypeVar("AnyRecording", Recording, BoundRecording)


@dataclass(frozen=True, slots=True, order=True)
class Window:
    """The samples ``start <= i < stop`` of a recording."""

    start: int
    stop: int

    def __post_init__(self) -> None:
        if not 0 <= self.start < self.stop:
            raise RecordingError(
                f"{self.start} to {self.stop} is not a window.",
                (),
                "Give 0 <= start < stop.",
            )

    def __len__(self) -> int:
        return self.stop - self.start

    @property
    def samples(self) -> slice:
        """The window as an index."""
        return slice(self.start, self.stop)


def stretches(time: FloatArray) -> tuple[Window, ...]:
    """Return the longest windows without a gap, in order.

    Parameters
    ----------
    time
        Seconds, strictly increasing; steps need not be equal.
    """
    if time.size < 2:
        return (Window(0, time.size),)
    steps = np.diff(time)
    typical = np.maximum(np.median(steps), median_filter(steps, NEIGHBOURS))
    longer = steps / typical
    long = np.count_nonzero(longer > GAP_FACTOR)
    rare = long <= max(RARE_SHARE * steps.size, RARE_COUNT)
    starts = np.flatnonzero(longer > (GAP_FACTOR if rare else SURE_GAP)) + 1
    return _between((0, *starts.tolist(), time.size))


def windows(
    recording: Recording | BoundRecording,
    *,
    seconds: float | None = None,
    samples: int | None = None,
    least: int = SHORTEST_WINDOW,
) -> tuple[Window, ...]:
    """Return contiguous windows of a given length; none of them spans a gap.

    Parameters
    ----------
    recording
        What to cut.
    seconds, samples
        The length, in one of the two. With neither, the stretches between gaps.
    least
        Samples in the shortest window: a shorter remainder joins the window before
        it, and a shorter stretch between two gaps is left out.

    Raises
    ------
    RecordingError
        If both lengths are given, the length is shorter than `least` samples, the
        recording is a steady table, or no window is left.
    """
    _check_lengths(recording, seconds, samples, least)
    kept: list[Window] = []
    for stretch in stretches(recording.time):
        if len(stretch) < least:
            continue
        time = recording.time[stretch.samples]
        if samples is not None:
            cuts = list(range(0, time.size, samples))
        elif seconds is not None:
            # Half a step of slack: rounding in a clock must not move the cuts.
            count = int((time[-1] - time[0]) / seconds) + 1
            marks = time[0] + seconds * np.arange(count) - recording.step / 2
            cuts = sorted(set(np.searchsorted(time, marks).tolist()))
        else:
            cuts = [0]
        kept.extend(_joined(stretch.start, cuts, time.size, least))
    if not kept:
        raise RecordingError(
            f"{recording.name!r} has no {least} samples in a row without a gap: "
            f"{_counted(recording)}.",
            (recording.name,),
            f"A gap is a step of more than {GAP_FACTOR:g} median steps "
            f"({recording.step:.4g} s). {_way_out(recording)}",
        )
    return tuple(kept)


def _way_out(recording: Recording | BoundRecording) -> str:
    """Return what to do about a recording that is nothing but gaps."""
    count = len(stretches(recording.time))
    together = len(recording) / count
    if count < BURSTS or together < 2:
        return "Record for longer, or split elsewhere."
    return (
        f"Its rows come in bursts of about {together:.0f}: keep one row of each burst, "
        "and what lies between is a step like any other."
    )


def split(
    recording: AnyRecording, fraction: float
) -> tuple[AnyRecording, AnyRecording]:
    """Return the part to train on and the part held out.

    The first `fraction` of the time is for training; of a steady table, that fraction
    of the rows, dealt out evenly so that both parts cover the range of the table.

    Parameters
    ----------
    recording
        What to split.
    fraction
        Between 0 and 1.

    Raises
    ------
    RecordingError
        If one of the parts would be empty.
    """
    if not 0.0 < fraction < 1.0:
        raise RecordingError(
            f"{fraction!r} is not a fraction to train on.",
            (recording.name,),
            "Give a number between 0 and 1, as 0.6.",
        )
    if recording.steady:
        train = _dealt(len(recording), fraction)
        _check_parts(recording.name, int(train.sum()), len(recording))
        return (
            recording.rows(
                np.flatnonzero(train).tolist(), name=f"{recording.name}[train]"
            ),
            recording.rows(
                np.flatnonzero(~train).tolist(), name=f"{recording.name}[held out]"
            ),
        )
    time = recording.time
    border = time[0] + fraction * (time[-1] - time[0])
    stop = int(np.searchsorted(time, border))
    _check_parts(recording.name, stop, len(recording))
    return recording.part(0, stop), recording.part(stop, len(recording))


def blocks(recording: Recording | BoundRecording, count: int) -> tuple[Window, ...]:
    """Return `count` contiguous windows of equal duration, for leaving out in turn.

    A block may span gaps: cut it further with `windows`. The blocks of a steady table
    are equal in rows.

    Raises
    ------
    RecordingError
        If there are fewer samples than would fill the blocks.
    """
    least = 1 if recording.steady else SHORTEST_WINDOW
    if count < 1 or len(recording) < count * least:
        raise RecordingError(
            f"{recording.name!r} ({len(recording)} samples) cannot be cut into "
            f"{count} blocks of at least {least} samples.",
            (recording.name,),
            "Ask for fewer blocks.",
        )
    marks = np.linspace(recording.time[0], recording.time[-1], count + 1)[1:-1]
    cuts = np.searchsorted(recording.time, marks).tolist()
    equal = _between((0, *cuts, len(recording)))
    if len(equal) == count and min(map(len, equal)) >= least:
        return equal
    # Long gaps leave some durations without samples: equal numbers of samples then.
    rows = np.linspace(0, len(recording), count + 1).round().astype(int).tolist()
    return _between(rows)


def _counted(recording: Recording | BoundRecording) -> str:
    """Return how many samples a recording has, and how many gaps."""
    gaps = len(stretches(recording.time)) - 1
    return f"{len(recording)} samples, {gaps} gap{'' if gaps == 1 else 's'}"


def _joined(
    origin: int, cuts: Sequence[int], size: int, least: int
) -> tuple[Window, ...]:
    """Return the windows between cuts, a short one joined to the one before it."""
    kept = [0]
    for cut in cuts[1:]:
        if cut - kept[-1] >= least and size - cut >= least:
            kept.append(cut)
    return _between([origin + cut for cut in (*kept, size)])


def _between(cuts: Sequence[int]) -> tuple[Window, ...]:
    """Return the windows between neighbouring cuts, leaving out empty ones."""
    return tuple(Window(a, b) for a, b in pairwise(cuts) if b > a)


def _dealt(count: int, fraction: float) -> NDArray[np.bool_]:
    """Return which of `count` rows to train on, spread evenly."""
    # Held-out rows sit mid-way through each stretch of trained ones, so that the ends
    # of the range are trained on: prediction, not extrapolation.
    share = np.floor(np.arange(count + 1) * (1.0 - fraction) + 0.5 - 1e-9)
    dealt: NDArray[np.bool_] = np.diff(share) <= 0
    return dealt


def _check_parts(name: str, train: int, count: int) -> None:
    if not 0 < train < count:
        raise RecordingError(
            f"Splitting {name!r} leaves {train} samples to train on and "
            f"{count - train} held out.",
            (name,),
            "Choose a fraction nearer to one half.",
        )


def _check_lengths(
    recording: Recording | BoundRecording,
    seconds: float | None,
    samples: int | None,
    least: int,
) -> None:
    if recording.steady:
        raise RecordingError(
            f"{recording.name!r} is a steady table and has no windows in time.",
            (recording.name,),
            "Its rows are independent: use split or blocks.",
        )
    if seconds is not None and samples is not None:
        raise RecordingError(
            "A window has one length.", (), "Give it in seconds or in samples."
        )
    length = samples if seconds is None else seconds / recording.step
    if length is not None and not length >= least - 0.5:
        raise RecordingError(
            f"A window of {length:.3g} samples is shorter than {least} samples.",
            (recording.name,),
            f"Give at least {least * recording.step:.4g} s.",
        )
