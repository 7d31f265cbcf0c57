"""How close a loop comes to -1, and how often it runs around it.

Over an interval the response stays within a disc whose radius the slope bounds give. A
disc that is farther from -1 than the closest point known is dropped, which makes the
peak of the sensitivity ``1/|1 + L|`` a global one. A disc that leaves -1 out fixes how
far the line from -1 to L turns, which makes the count of unstable closed-loop poles an
exact one, with delays, integrators and undamped or unstable plants.
"""

import math
from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.optimize import minimize_scalar

from bondgraph.loopshaping.crossings import gain_crossovers
from bondgraph.loopshaping.curve import Curve
from bondgraph.loopshaping.zero_pole_gain import FloatArray

_CERTAIN = 1e-3  # relative width of the bounds at which the polishing starts
_NARROW = 1e-9
MOST_TURNS = 500  # around -1 that are counted
_MARGINAL = 1e-9  # closer to -1 than this, relative to 1 + |L|, counts as through it


@dataclass(frozen=True, slots=True)
class Peak:
    """The largest value of a sensitivity, and its frequency in rad/s.

    ``omega`` is 0 or infinite where the value is only approached towards there.
    """

    value: float
    omega: float


def sensitivity_peak(loop: Curve) -> Peak:
    """Return the greatest ``|1 / (1 + L)|``: one over the modulus margin."""
    low, high = _relevant(loop)
    a, b = loop.pieces(low, high)
    ends = np.array([low, high, *a, *b])
    distances = np.abs(1 + loop.value(ends))
    best = float(distances.min())
    place = float(ends[distances.argmin()])
    kept: list[tuple[float, float]] = []
    while len(a):
        middle = np.sqrt(a * b)
        disc = _disc(loop, a, middle, b)
        distance = disc.distance
        least = np.maximum(np.maximum(disc.near, disc.inner), disc.outer)
        if distance.min() < best:
            best, place = float(distance.min()), float(middle[distance.argmin()])
        open_ = least < best
        sure = distance - least < _CERTAIN * best
        done = open_ & (sure | (np.log(b / a) < _NARROW))
        kept += zip(a[done], b[done], strict=True)
        rest = open_ & ~done
        a, b, middle = a[rest], b[rest], middle[rest]
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    for start, stop in _joined(kept):
        candidate, value = _polished(loop, start, stop)
        if value < best:
            best, place = value, candidate
    return _peak(loop, best, place, (low, high))


def _peak(loop: Curve, best: float, place: float, span: tuple[float, float]) -> Peak:
    value = math.inf if best == 0 else 1 / best
    low, high = span
    if place <= low * (1 + 1e-9):
        return Peak(value, 0.0)
    if place >= high * (1 - 1e-9):
        return Peak(value, math.inf if loop.period is None else math.pi / loop.period)
    return Peak(value, loop.omega(place))


@dataclass(frozen=True, slots=True, eq=False)
class _Disc:
    """Bounds around the middle of intervals.

    ``distance`` is |1 + L| in the middle. On all of the interval |1 + L| is at least
    ``near`` (from a disc around L), ``inner`` (because |L| is below one) and ``outer``
    (because |L| is above one); what is negative says nothing.
    """

    distance: FloatArray
    near: FloatArray
    inner: FloatArray
    outer: FloatArray


def _disc(loop: Curve, a: FloatArray, middle: FloatArray, b: FloatArray) -> _Disc:
    value = loop.value(middle)
    size = np.abs(value)
    reach = np.log(b / middle)
    steep, turn = (slope * reach for slope in loop.slopes(a, b).steepest())
    distance = np.minimum(np.abs(1 + value), 1e300)
    with np.errstate(invalid="ignore", over="ignore"):
        # |exp(x) - 1| <= exp|x| - 1 with x the change of ln L
        strays = size * np.expm1(np.minimum(np.hypot(steep, turn), 50.0))
        near = np.nan_to_num(distance - strays, nan=-1.0)
        inner = 1 - size * np.exp(np.minimum(steep, 50.0))
        outer = np.minimum(size * np.exp(-steep) - 1, 1e300)
    return _Disc(distance, near, inner, outer)


def _relevant(loop: Curve) -> tuple[float, float]:
    """Return the span, without the far end at which a delay turns a mere remnant."""
    low, high = loop.span()
    if loop.delay and not loop.orders.sum():
        corner = float(np.abs(loop.roots).max(initial=0.0))
        high = 30 * max(corner, low) + 4 * math.pi / abs(loop.delay)
    return low, high


def _joined(pieces: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return neighbouring intervals as one."""
    joined: list[tuple[float, float]] = []
    for start, stop in sorted(pieces):
        if joined and start <= joined[-1][1] * (1 + 1e-12):
            joined[-1] = (joined[-1][0], max(stop, joined[-1][1]))
        else:
            joined.append((start, stop))
    return joined


def _polished(loop: Curve, start: float, stop: float) -> tuple[float, float]:
    """Return the closest point within a small interval, and its distance."""

    def distance(x: float) -> float:
        return float(np.abs(1 + loop.value(np.array([math.exp(x)])))[0])

    grid = np.linspace(math.log(start), math.log(stop), 33)
    values = np.abs(1 + loop.value(np.exp(grid)))
    k = int(values.argmin())
    a, b = grid[max(k - 1, 0)], grid[min(k + 1, 32)]
    found = minimize_scalar(
        distance, bounds=(a, b), method="bounded", options={"xatol": 1e-12}
    )
    x = cast(float, found.x)
    return math.exp(x), distance(x)


@dataclass(frozen=True, slots=True)
class Encirclements:
    """How many closed-loop poles are unstable, by the argument principle.

    ``unstable`` is None where the response passes through -1 (the loop is at the limit
    of stability), or where a delay makes them hundreds or infinitely many.
    """

    unstable: int | None
    marginal: bool


def encirclements(loop: Curve) -> Encirclements:
    """Return the number of unstable closed-loop poles from the Nyquist curve.

    ``Z = P - (2 Δ - π n) / 2π``, with Δ the angle by which 1 + L turns from ν = 0 to
    infinity, P the unstable poles of L and n its poles on the imaginary axis, around
    which the contour bends to the right.
    """
    low, high = _relevant(loop)
    if not loop.orders.sum():
        last = loop.value(np.array([high]))[0]
        if loop.delay and abs(last) >= 1:
            return Encirclements(None, marginal=False)
        if not loop.delay and abs(1 + last) < _MARGINAL * (1 + abs(last)):
            return Encirclements(None, marginal=True)
    if loop.delay and _beyond_counting(loop):
        return Encirclements(None, marginal=False)
    turned = _turn(loop, *loop.pieces(low, high))
    if turned is None:
        return Encirclements(None, marginal=True)
    if loop.delay:  # behind a delay 1 + L closes towards one
        turned -= float(np.angle(1 + loop.value(np.array([high]))[0]))
    poles = loop.roots[loop.orders < 0]
    axis = int((poles.real == 0).sum())
    unstable = int((poles.real > 0).sum())
    count = unstable - (2 * turned - math.pi * axis) / (2 * math.pi)
    return Encirclements(round(count), marginal=False)


def _beyond_counting(loop: Curve) -> bool:
    """Return whether the delay winds L around -1 hundreds of times."""
    last = max(gain_crossovers(loop), default=0.0)
    return loop.delay * last > math.pi * (len(loop.roots) + MOST_TURNS)


def _turn(loop: Curve, a: FloatArray, b: FloatArray) -> float | None:
    """Return by how much arg(1 + L) grows over the intervals; None through -1."""
    total = 0.0
    while len(a):
        middle = np.sqrt(a * b)
        disc = _disc(loop, a, middle, b)
        sure = (disc.near > 0) | (disc.inner > 0)
        ends = 1 + loop.value(np.concatenate([a[sure], b[sure]]))
        first, last = np.split(ends, 2)
        total += float(np.angle(last / first).sum())
        a, b, middle = a[~sure], b[~sure], middle[~sure]
        scale = 1 + np.abs(loop.value(middle))
        if (disc.distance[~sure] < _MARGINAL * scale).any():
            return None
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    return total
