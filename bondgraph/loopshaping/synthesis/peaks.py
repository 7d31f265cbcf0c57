"""The largest value of ``|F / (1 + L)|`` over all frequencies, by branch and bound.

Both logarithms have bounded slopes on an interval (see `curve`), so that an interval in
which the ratio cannot exceed the largest value known is dropped. What remains is
narrowed until the bounds agree.
"""

import math

import numpy as np

from bondgraph.loopshaping.curve import Curve, curve
from bondgraph.loopshaping.distance import Peak
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain

_CERTAIN = 1e-7  # relative width of the bounds of the peak
_NARROW = 1e-9


def peak_gain(forward: ZeroPoleGain, open_loop: ZeroPoleGain) -> Peak:
    """Return the peak of ``|forward / (1 + open_loop)|`` of a stable loop.

    Raises
    ------
    LoopShapingError
        If one of the two has more zeros than poles, or is zero.
    """
    ahead, around = curve(forward), curve(open_loop)
    low, high = _span(ahead, around)
    a, b = _pieces(ahead, around, low, high)
    ends = np.concatenate([[low, high], a, b])
    values = _size(ahead, around, ends)
    best, place = float(values.max()), float(ends[values.argmax()])
    while len(a):
        middle = np.sqrt(a * b)
        here = _size(ahead, around, middle)
        if here.max() > best:
            best, place = float(here.max()), float(middle[here.argmax()])
        most = here + _reach(ahead, around, a, middle, b)
        open_ = (most > best + _CERTAIN) & (np.log(b / a) > _NARROW)
        a, b, middle = a[open_], b[open_], middle[open_]
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    if place <= low * (1 + 1e-9):
        return Peak(math.exp(best), 0.0)
    if place >= high * (1 - 1e-9):
        end = math.inf if around.period is None else math.pi / around.period
        return Peak(math.exp(best), end)
    return Peak(math.exp(best), around.omega(place))


def _span(ahead: Curve, around: Curve) -> tuple[float, float]:
    first, second = ahead.span(), around.span()
    high = max(first[1], second[1])
    late = abs(around.delay)
    if late:  # beyond this a delay turns a mere remnant
        corners = [*np.abs(ahead.roots), *np.abs(around.roots)]
        high = 30 * max([float(c) for c in corners], default=1.0) + 4 * math.pi / late
    return min(first[0], second[0]), high


def _pieces(
    ahead: Curve, around: Curve, low: float, high: float
) -> tuple[FloatArray, FloatArray]:
    """Return intervals free of undamped roots of either."""
    a, b = around.pieces(low, high)
    for omega in ahead.undamped():
        inside = (a < omega) & (omega < b)
        if inside.any():
            left, right = a[inside], b[inside]
            a = np.concatenate([a[~inside], left, [omega * (1 + 1e-9)]])
            b = np.concatenate([b[~inside], [omega * (1 - 1e-9)], right])
    return a, b


def _size(ahead: Curve, around: Curve, nu: FloatArray) -> FloatArray:
    """Return ln of the ratio."""
    loop = around.logarithm(nu)
    # |F/(1 + L)| is |F/L| / |1 + 1/L|, which does not overflow where L is large.
    large = loop.real > 0
    turned = np.where(large, -loop, loop)
    shift = np.where(large, loop.real, 0.0)
    with np.errstate(divide="ignore"):
        near = np.log(np.abs(1 + np.exp(turned)))
    return np.asarray(ahead.logarithm(nu).real - shift - near)


def _reach(
    ahead: Curve, around: Curve, a: FloatArray, middle: FloatArray, b: FloatArray
) -> FloatArray:
    """Return by how much ln of the ratio can grow from the middle of intervals."""
    forward, loop = ahead.slopes(a, b), around.slopes(a, b)
    step = np.log(b / middle)
    rate = np.hypot(*loop.steepest())
    value = around.logarithm(middle)
    large = value.real > 0
    size = np.exp(-np.abs(value.real))  # of L, or of 1/L where L is large
    clear = np.abs(1 + np.exp(np.where(large, -value, value)))
    strays = size * np.expm1(np.minimum(rate * step, 50.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        drop = np.where(strays < clear, -np.log1p(-strays / clear), np.inf)
    (least, most), (down, up) = forward.magnitude, loop.magnitude
    ratio = np.maximum(np.abs(least - up), np.abs(most - down))
    slope = np.where(large, ratio, np.maximum(np.abs(least), np.abs(most)))
    return np.asarray(slope * step + drop)
