"""Fewer samples without aliasing: a recording at a longer step.

Each new sample is a weighted mean of the old ones around it, the weights those of a
low-pass filter (a windowed sinc) over the actual times, so that uneven steps and gaps
need no interpolation first. A shorter step would invent data and is refused.
"""

from dataclasses import replace

import numpy as np

from bondgraph.choices import is_finite
from bondgraph.errors import RecordingError
from bondgraph.recordings.channel import Channel, FloatArray
from bondgraph.recordings.recording import Recording
from bondgraph.recordings.windows import stretches

REACH = 8.0
"""Half width of the filter in new steps. So much is left out next to the ends of a
stretch: there the filter would see one side only, and shift what it sees."""

CUT_OFF = 0.8
"""Of the new Nyquist frequency; half of the amplitude passes there."""

KAISER = 7.0
"""Shape of the window; what would alias is damped by 70 dB above 1.2 Nyquist."""

LEAST_WEIGHT = 0.9
"""A new sample with less of its filter covered by old ones is a gap."""

AT_A_TIME = 4096


def resample(recording: Recording, step: float) -> Recording:
    """Return the recording at a longer, even step, low-pass filtered against aliasing.

    Parameters
    ----------
    recording
        Steps may be uneven; gaps stay gaps.
    step
        Seconds between the new samples.

    Raises
    ------
    RecordingError
        If `step` is shorter than the recording's, or so long that the filter does not
        fit in, or the recording is a steady table.
    """
    if not is_finite(step):
        raise RecordingError(
            f"{recording.name!r} cannot be resampled at a step of {step!r}.",
            (recording.name,),
            "Give seconds.",
        )
    if recording.steady or not step >= recording.step:
        raise RecordingError(
            f"{recording.name!r} cannot be resampled at {step:g} s: its samples are "
            f"{recording.step:.4g} s apart.",
            (recording.name,),
            "Give a longer step; a shorter one would invent data.",
        )
    times, columns = [], []
    for stretch in stretches(recording.time):
        time = recording.time[stretch.samples]
        grid: FloatArray = np.arange(
            time[0] + REACH * step, time[-1] - REACH * step, step
        )
        times.append(grid)
        columns.append(
            [
                _filtered(time, channel.values[stretch.samples], grid, step)
                for channel in recording.channels
            ]
        )
    table = np.concatenate(columns, axis=1)
    measured = np.isfinite(table).any(axis=0)
    if not measured.any():
        raise RecordingError(
            f"{recording.name!r} is too short to be resampled at {step:g} s: no "
            f"stretch of it is as long as the filter, {2 * REACH * step:g} s.",
            (recording.name,),
            "Give a shorter step.",
        )
    channels = tuple(
        Channel(old.name, old.unit, new, gaps=bool(np.isnan(new).any()))
        for old, new in zip(recording.channels, table[:, measured], strict=True)
    )
    return replace(
        recording,
        time=np.concatenate(times)[measured],
        channels=channels,
        notes=(*recording.notes, f"Resampled at {step:g} s behind a low-pass filter."),
    )


def _filtered(
    time: FloatArray, values: FloatArray, grid: FloatArray, step: float
) -> FloatArray:
    """Return one channel on the grid; nan where too few samples are around."""
    there = np.isfinite(values)
    time, values = time[there], values[there]
    width = _cells(time, step) / step
    result = np.full(grid.size, np.nan)
    for start in range(0, grid.size, AT_A_TIME):
        centre = grid[start : start + AT_A_TIME]
        low = np.searchsorted(time, centre - REACH * step)
        high = np.searchsorted(time, centre + REACH * step, side="right")
        count = high - low
        row = np.repeat(np.arange(centre.size), count)
        old = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count - low, count)
        weight = _kernel((time[old] - centre[row]) / step) * width[old]
        share = np.bincount(row, weight, centre.size)
        total = np.bincount(row, weight * values[old], centre.size)
        covered = share > LEAST_WEIGHT
        mean = np.divide(total, share, out=np.full(centre.size, np.nan), where=covered)
        result[start : start + AT_A_TIME] = mean
    return result


def _cells(time: FloatArray, step: float) -> FloatArray:
    """Return how much time each sample stands for, at most a new step."""
    if time.size < 2:
        return np.full(time.size, step)
    steps = np.minimum(np.diff(time), step)
    before = np.concatenate([steps[:1], steps])
    after = np.concatenate([steps, steps[-1:]])
    width: FloatArray = (before + after) / 2
    return width


def _kernel(x: FloatArray) -> FloatArray:
    """Return the low-pass filter's response at `x` new steps from its centre."""
    window = np.i0(KAISER * np.sqrt(np.maximum(1.0 - (x / REACH) ** 2, 0.0)))
    return np.asarray(CUT_OFF * np.sinc(CUT_OFF * x) * window / np.i0(KAISER))
