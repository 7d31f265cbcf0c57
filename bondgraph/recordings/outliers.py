"""Single samples that the machine did not make: candidates for misreadings.

Some jump away and back further than the channel ever changes from one sample to the
next. Where it moves fast they do not stand out so, but alone depart from the smooth
line through the samples beside them.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondgraph.recordings.channel import FloatArray
from bondgraph.recordings.noise import ORDERS, noise_std

FAR = 8.0
"""In noise standard deviations: no noise goes so far."""

USUAL = 0.95
"""Of all changes, and of all departures, so many count as usual."""

UNUSUAL = 4.0
"""Times what is usual in all, and beside the sample, that a candidate departs."""

RARE = 8.0
"""Times what is usual that a departure from a line is: tails of a noise go further."""

BENDS = 2.0
"""Times the change from sample to sample beside it: no corner departs so far."""

ALONE = 0.25
"""Of a departure: so little do its neighbours depart when it is left out."""

BESIDE = 8
"""Samples to each side that tell what is usual there."""

UNEVEN = 3.0
"""Noise of a cubic between uneven samples, squared; between even ones it is 1 or 2."""


def outliers(time: ArrayLike, values: ArrayLike) -> NDArray[np.intp]:
    """Return the single samples that are not of the motion beside them: candidates.

    Parameters
    ----------
    time
        Seconds, strictly increasing.
    values
        Samples of one channel, in any unit.
    """
    v = np.asarray(values, dtype=np.float64)
    there = np.flatnonzero(np.isfinite(v))
    v, time = v[there], np.asarray(time, dtype=np.float64)[there]
    if v.size < 4 * (ORDERS[0] + 1):
        return np.empty(0, dtype=np.intp)
    far = FAR * noise_std(time, v)
    return there[np.union1d(_jumping_back(v, far), _off_the_line(time, v, far))]


def _jumping_back(v: FloatArray, far: float) -> NDArray[np.intp]:
    """Return the samples that jump away from both neighbours and back.

    Further than `far`, than is usual, and than the change across them.
    """
    steps = np.diff(v)
    out, back = steps[:-1], -steps[1:]
    jump = np.where(out * back > 0, np.minimum(np.abs(out), np.abs(back)), 0.0)
    changes = np.abs(steps[steps != 0.0])
    # A handful of changes may be all jumps; they cannot say what is usual.
    usual = float(np.quantile(changes, USUAL)) if changes.size >= 10 else 0.0
    across = np.abs(v[2:] - v[:-2])
    isolated = (jump > max(far, UNUSUAL * usual)) & (jump > UNUSUAL * across)
    return np.flatnonzero(isolated) + 1


def _off_the_line(time: FloatArray, v: FloatArray, far: float) -> NDArray[np.intp]:
    """Return the samples that alone depart from a smooth line by more than `far`."""
    changes = np.abs(np.diff(v))
    if not changes.any():
        return np.empty(0, dtype=np.intp)
    steps = BENDS * float(changes[changes > 0.0].min())  # of a coarse sensor, a flicker
    off = _departures(time, v, (-2, -1, 1, 2))
    usual = float(np.quantile(off[off > 0.0], USUAL)) if off.any() else 0.0
    # What is told of the next ones without it: corners and steps are theirs, too.
    behind = _departures(time, v, (-2, -1, 2, 3))
    ahead = _departures(time, v, (-3, -2, 1, 2))
    found = [
        k
        for k in np.flatnonzero(off > max(far, steps, RARE * usual)).tolist()
        if BESIDE <= k < v.size - BESIDE
        and max(behind[k - 1], ahead[k + 1]) < ALONE * off[k]
        and off[k] > UNUSUAL * _around(off, k, 2).max()
        and off[k] > BENDS * _change_around(v, k)
    ]
    return np.array(found, dtype=np.intp)


def _departures(time: FloatArray, v: FloatArray, nodes: tuple[int, ...]) -> FloatArray:
    """Return how far each sample is from the cubic through those beside it.

    Zero where there are none, and where gaps in time would let the cubic run away.
    """
    reach = max(map(abs, nodes))
    at = np.arange(reach, v.size - reach)
    lapse = [time[at + k] - time[at] for k in nodes]
    shares = [
        np.prod([b / (b - a) for b in lapse if b is not a], axis=0) for a in lapse
    ]
    line = sum(share * v[at + k] for share, k in zip(shares, nodes, strict=True))
    off = np.zeros(v.size)
    even = sum(share**2 for share in shares) < UNEVEN
    off[at] = np.where(even, np.abs(v[at] - line), 0.0)
    return off


def _around(x: FloatArray, k: int, apart: int) -> FloatArray:
    """Return what is within `BESIDE` of element k, and further than `apart`."""
    return np.concatenate([x[k - BESIDE : k - apart], x[k + apart + 1 : k + BESIDE]])


def _change_around(v: FloatArray, k: int) -> float:
    """Return the largest change from sample to sample beside sample k."""
    across = abs(v[k + 1] - v[k - 1]) / 2.0
    beside = np.abs(np.diff(v[k - BESIDE : k])), np.abs(np.diff(v[k + 1 : k + BESIDE]))
    return float(max(across, *(change.max() for change in beside)))
