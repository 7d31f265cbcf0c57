"""What the numbers say about their sensor: its step, its noise, its limits.

The noise is read from combinations of neighbouring samples that no smooth signal can
reach. With divided differences of order k over the actual times, a polynomial of degree
below k gives zero and white noise of standard deviation s gives s, whatever the steps.
Higher orders let less of the signal through; the least order after which nothing more
falls away is taken, and its median, not its mean square, so that events do not count.
(Order k on a uniform grid is the k-th difference over sqrt(binomial(2k, k)).)
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bondgraph.errors import RecordingError
from bondgraph.recordings.channel import FloatArray

ORDERS = range(2, 9)
AGREEMENT = 1.15
"""Estimates of two orders within this factor are the same."""

SAMENESS = 1.04
"""Estimates of all orders within this factor, and their error, show white noise."""

MAD_TO_STD = 1.482602218505602
"""Standard deviation over median absolute deviation, of a normal distribution."""

LEAST_LEVELS = 8
"""So few values lie on a grid by chance, or are the steps of a command."""

FLICKER = 0.05
"""A channel of few levels that changes in more samples than this is a sensor's."""

MOST_CONTRASTS = 200_000
"""Enough for any median; of longer recordings, evenly spaced windows are taken."""

NEARLY_ALL = 0.98
"""Contrasts of which so many are smaller than rounding leaves them know no rounding."""

ON_GRID = 0.1
"""A distance from the grid, in its steps, that counts as on it (0.2 by chance)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NoiseEstimate:
    """The measurement noise of one channel, in its unit.

    Parameters
    ----------
    std
        Standard deviation of the white part, at least ``quantisation / sqrt(12)``.
    quantisation
        The step of the value grid, None where there is none.
    white
        Whether the noise is seen to be white: all orders of difference agree. If not,
        signal or coloured noise reaches into the fastest band, which one cannot be told
        from this channel alone; of coloured noise `std` is the fastest part only, a
        lower bound.
    """

    std: float
    quantisation: float | None
    white: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Saturation:
    """Samples that sit exactly at an extreme value far more than just beside it.

    ``side`` is ``"least"`` or ``"greatest"``; ``runs`` counts unbroken stays. A machine
    that rests at the end of its travel looks the same as a sensor at its limit.
    """

    side: str
    level: float
    samples: int
    runs: int


def quantisation(values: ArrayLike) -> float | None:
    """Return the step of the grid that the values lie on, or None.

    Every value must be a whole number of steps from every other, to within what the
    written digits (9, or single precision) allow; a few strays are forgiven. Fewer than
    8 different values count only if they are 3 or more, evenly spaced, and the channel
    changes between them often: else they are the levels of a command.

    Parameters
    ----------
    values
        Samples of one channel, in any unit.
    """
    v = np.asarray(values, dtype=np.float64)
    v = v[np.isfinite(v)]
    if v.size == 0:
        return None
    written = float(np.max(np.abs(v)))
    single = np.array_equal(v, v.astype(np.float32).astype(np.float64))
    blur = written * (2.0**-23 if single else 1e-9)
    levels = _merged(np.unique(v), 4 * blur)
    gaps = np.diff(levels)
    if levels.size < LEAST_LEVELS:
        return _flicker_step(v, gaps, blur)
    seeds = np.quantile(gaps, [0.0, 0.01, 0.05, 0.25, 0.5], method="lower")
    candidates = {float(seed) / divisor for seed in seeds for divisor in range(1, 7)}
    for step in sorted(candidates, reverse=True):
        if step > 20 * blur and (refined := _grid_step(levels, step)) is not None:
            return refined
    return None


def noise_std(time: ArrayLike, values: ArrayLike) -> float:
    """Return the standard deviation of the white measurement noise.

    At least the quantisation step over sqrt(12). Smooth signal, steps and rare events
    are let pass; of coloured noise only the fastest part is seen (`estimate_noise` says
    so). A constant channel has 0.

    Parameters
    ----------
    time
        Seconds, strictly increasing.
    values
        Samples of one channel, in any unit.
    """
    return estimate_noise(time, values).std


def estimate_noise(time: ArrayLike, values: ArrayLike) -> NoiseEstimate:
    """Return the noise of one channel, its grid, and whether the noise looks white.

    What moves on by whole steps and yet runs smoother than rounding would leave it was
    not rounded: its times are those at which it passed a step, as of a turning wheel.
    It has no grid.

    Parameters
    ----------
    time
        Seconds, strictly increasing.
    values
        Samples of one channel, in any unit; nan where it was not measured.

    Raises
    ------
    RecordingError
        If the two do not belong together, or nothing was measured.
    """
    t, v = _measured(time, values)
    step = quantisation(v)
    floor = 0.0 if step is None else step / np.sqrt(12.0)
    orders = [k for k in ORDERS if v.size >= 4 * (k + 1)]
    if not orders or np.ptp(v) == 0.0:
        return NoiseEstimate(std=float(floor), quantisation=step, white=True)
    contrasts = [_contrasts(t, v, k) for k in orders]
    scales = np.array([_scale(one) for one in contrasts])
    if step is not None and np.median(np.abs(np.diff(v))) > 0.0:
        if min(np.quantile(np.abs(one), NEARLY_ALL) for one in contrasts) < floor:
            step, floor = None, 0.0
        else:
            scales = _scales_off_grid(t, v, step, orders)
    settled = scales <= AGREEMENT * np.minimum.accumulate(scales[::-1])[::-1]
    chosen = int(np.argmax(settled))
    sameness = SAMENESS + 3.0 / np.sqrt(v.size)  # about three of its own errors
    white = bool(np.max(scales) <= sameness * np.min(scales))
    std = max(float(scales[chosen]), float(floor))
    return NoiseEstimate(std=std, quantisation=step, white=white)


def _measured(time: ArrayLike, values: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the times and values that were measured."""
    try:
        t = np.asarray(time, dtype=np.float64)
        v = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise RecordingError(
            "Times and values are not made of real numbers.", (), "Give two lists."
        ) from error
    if t.ndim != 1 or t.shape != v.shape:
        raise RecordingError(
            f"There are times of shape {t.shape} and values of shape {v.shape}.",
            (),
            "Give one value for each time.",
        )
    there = np.isfinite(v)
    if not there.any():
        raise RecordingError(
            f"None of the {v.size} values is a number: nothing was measured.",
            (),
            "Leave the channel out.",
        )
    t, v = t[there], v[there]
    if not np.all(np.diff(t) > 0.0):
        raise RecordingError(
            "The times do not increase.", (), "Sort them, and give finite seconds."
        )
    return t, v


def saturation(values: ArrayLike) -> tuple[Saturation, ...]:
    """Return where samples sit at the least or greatest value, if they do.

    Reported when at least 5 samples and 0.5 % of all are exactly at the extreme, more
    than 4 times as many as at the values next to it (a quantised peak gives at most
    2.4), and the channel has more than 16 values, so that it is no switch or command.

    Parameters
    ----------
    values
        Samples of one channel, in any unit.
    """
    v = np.asarray(values, dtype=np.float64)
    v = v[np.isfinite(v)]
    if np.unique(v).size <= 2 * LEAST_LEVELS:
        return ()
    width = max(quantisation(v) or 0.0, 1e-3 * float(np.ptp(v)))
    found = []
    for side, sign in (("least", -1.0), ("greatest", 1.0)):
        distance = np.max(sign * v) - sign * v
        at = distance == 0.0
        beside = np.count_nonzero((distance > 0.0) & (distance <= 1.5 * width))
        count = int(np.count_nonzero(at))
        if count >= max(5, 0.005 * v.size) and count > 4 * beside:
            runs = int(np.count_nonzero(np.diff(at.astype(np.int8), prepend=0) == 1))
            level = float(v[np.argmax(at)])
            found.append(Saturation(side=side, level=level, samples=count, runs=runs))
    return tuple(found)


def _flicker_step(values: FloatArray, gaps: FloatArray, blur: float) -> float | None:
    """Return the common gap of a few levels that a channel flickers between."""
    changes = np.count_nonzero(np.diff(values))
    often = changes > FLICKER * values.size
    if gaps.size < 2 or np.ptp(gaps) > 4 * blur or not often:
        return None
    return float(gaps.mean())


def _merged(levels: FloatArray, blur: float) -> FloatArray:
    """Return the first of each group of sorted levels closer together than `blur`."""
    keep = np.diff(levels, prepend=-np.inf) > blur
    return levels[keep]


def _grid_step(levels: FloatArray, step: float) -> float | None:
    """Return the refined step if the levels lie on a grid of about `step`.

    Gaps between neighbouring levels are short, so that each is rounded safely even
    with a rough step; their sum then fixes the step to many digits.
    """
    gaps = np.diff(levels)
    for reach in (4.0, 40.0, 4000.0, np.inf):
        near = gaps < reach * step
        whole = np.rint(gaps[near] / step)
        if not whole.sum() > 0:
            return None
        distance = np.abs(gaps[near] / step - whole)
        if np.mean(distance < ON_GRID) < 0.98:
            return None
        # A stray beside the grid by less than that is still not of it.
        good = distance <= min(ON_GRID, 5 * float(np.median(distance)) + 1e-9)
        if whole[good].sum() > 0:
            step = float(gaps[near][good].sum() / whole[good].sum())
    return step


def _contrasts(time: FloatArray, values: FloatArray, order: int) -> FloatArray:
    """Return the divided differences of `order`, scaled to unit response to noise."""
    count = values.size - order
    stride = -(-count // MOST_CONTRASTS)
    t, v = (
        np.stack([x[i : i + count : stride] for i in range(order + 1)])
        for x in (time, values)
    )
    # Relative to the window: else short steps underflow, and where the values do not
    # change at all rounding would stand in for noise.
    t = (t - t[0]) / (t[-1] - t[0])
    v = v - v[0]
    total, power = np.zeros(t.shape[1]), np.zeros(t.shape[1])
    for i in range(order + 1):
        weight = np.ones(t.shape[1])
        for j in range(order + 1):
            if j != i:
                weight /= t[i] - t[j]
        total += weight * v[i]
        power += weight**2
    return np.asarray(total / np.sqrt(power), dtype=np.float64)


def _scales_off_grid(
    time: FloatArray, values: FloatArray, step: float, orders: Sequence[int]
) -> FloatArray:
    """Return the scales of contrasts of values on a grid, as if they lay on none.

    Contrasts of few steps take few values, and their median is one of these. So half a
    step either way is added to each value by chance, and its variance taken off again
    (non-subtractive dither: Gray and Stockham, IEEE Trans. Inf. Theory 39, 1993).
    """
    dither = np.random.default_rng(values.size).uniform(-0.5, 0.5, values.size)
    dithered = values + step * dither
    squares = [_scale(_contrasts(time, dithered, k)) ** 2 for k in orders]
    return np.sqrt(np.maximum(np.array(squares) - step**2 / 12.0, step**2 / 12.0))


def _scale(contrasts: FloatArray) -> float:
    """Return a standard deviation that rare large contrasts do not move."""
    sizes = np.abs(contrasts)
    scale = MAD_TO_STD * float(np.median(sizes))
    if scale > 0.0:
        return scale
    # More than half are exactly zero: a value held between updates.
    moving = sizes[sizes > 0.0]
    if moving.size == 0:
        return 0.0
    return MAD_TO_STD * float(np.median(moving) * np.sqrt(moving.size / sizes.size))
