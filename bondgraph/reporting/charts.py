"""Charts as data for a page: axes, ticks and lines in a square of 1000 by 1000.

A page stretches the square to its width; lines keep their thickness and labels their
size, so a chart reads on a telephone as on a desk. A long recording is cut into slices
of time, of which the smallest and the largest value are kept: the line looks the same
and every spike stays, however many samples there were.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIDE = 1000.0
AIR = 0.05  # free space above and below the lines, as a share of their range
DOT_AIR = 0.015  # and beside dots
MOST_DOTS = 3000


@dataclass(frozen=True, slots=True)
class Tick:
    """A mark on an axis: where, in per cent of its length, and what it says."""

    at: float
    label: str


@dataclass(frozen=True, slots=True)
class Line:
    """One line or cloud of dots: its name, its CSS class and its SVG path."""

    name: str
    css: str
    path: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Chart:
    """Everything a page needs to show one chart.

    Parameters
    ----------
    title, description
        What it shows, and the same in a sentence for those who cannot see it.
    x_range, y_range
        Values at the left and the right edge, and at the lower and the upper one.
    band
        Top and height of a shaded band in the square, or None.
    """

    title: str
    description: str
    x_label: str
    y_label: str
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    x_ticks: tuple[Tick, ...]
    y_ticks: tuple[Tick, ...]
    lines: tuple[Line, ...]
    band: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """The numbers of one line, before they are drawn."""

    name: str
    css: str
    x: Array
    y: Array
    dots: bool = False


def chart(
    curves: Sequence[Curve],
    *,
    title: str,
    description: str,
    x_label: str,
    y_label: str,
    frame: Sequence[str],
    slices: int = 1500,
    band: float | None = None,
) -> Chart:
    """Return the chart of some curves.

    Parameters
    ----------
    frame
        Names of the curves that must fit in; others may leave the picture, up to
        three times its height (a simulation that runs away would flatten the rest).
    slices
        Number of time slices that a long curve is reduced to.
    band
        Half-width of a band to shade around zero.
    """
    # A dot at the edge would be half a dot.
    dotted = any(c.dots for c in curves)
    x_range = _range([c.x for c in curves], DOT_AIR if dotted else 0.0)
    y_range = _y_range(curves, frame, band)
    shaded = None
    if band is not None:
        top, bottom = _across(np.array([band, -band]), y_range[::-1])
        shaded = (float(top), float(bottom - top))
    return Chart(
        title=title,
        description=description,
        x_label=x_label,
        y_label=y_label,
        x_range=x_range,
        y_range=y_range,
        x_ticks=ticks(x_range, 6),
        y_ticks=ticks(y_range, 5, upwards=True),
        lines=tuple(_line(c, x_range, y_range, slices) for c in curves),
        band=shaded,
    )


def extremes(values: Array, slices: int) -> NDArray[np.intp]:
    """Return the indices that keep the look of a line: least and greatest per slice.

    Parameters
    ----------
    values
        One value per sample; NaN marks a gap.
    slices
        Number of slices; the answer has at most about two indices for each.
    """
    count = len(values)
    if count <= 2 * slices:
        return np.arange(count)
    width = -(-count // slices)
    padded = np.full(width * -(-count // width), np.nan)
    padded[:count] = values
    rows = padded.reshape(-1, width)
    start = width * np.arange(len(rows))
    low = np.where(np.isnan(rows), np.inf, rows).argmin(axis=1) + start
    high = np.where(np.isnan(rows), -np.inf, rows).argmax(axis=1) + start
    chosen = np.unique(np.concatenate([[0], low, high, [count - 1]]))
    return chosen[chosen < count]


def ticks(
    limits: tuple[float, float], wanted: int, *, upwards: bool = False
) -> tuple[Tick, ...]:
    """Return round values inside `limits`, about `wanted` of them.

    Parameters
    ----------
    upwards
        Whether places count from the far end, as on a y axis of a page.
    """
    low, high = limits
    rough = (high - low) / wanted
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(s * power for s in (1, 2, 5, 10) if s * power >= rough * 0.999)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    places = []
    for k in range(first, last + 1):
        share = (k * step - low) / (high - low)
        at = 100 * (1 - share if upwards else share)
        places.append(Tick(round(at, 3), _tick_label(k * step, step)))
    return tuple(places)


def _tick_label(value: float, step: float) -> str:
    if value != 0 and not 1e-3 <= abs(value) < 1e5:
        return f"{value:.3g}".replace("-", "−")
    places = max(0, -math.floor(math.log10(step) + 1e-9))
    return f"{value:.{places}f}".replace("-", "−")


def _range(arrays: Sequence[Array], air: float = 0.0) -> tuple[float, float]:
    finite = [a[np.isfinite(a)] for a in arrays]
    low = min((float(a.min()) for a in finite if a.size), default=0.0)
    high = max((float(a.max()) for a in finite if a.size), default=1.0)
    if not high > low:
        half = abs(low) or 1.0
        return low - half, high + half
    return low - air * (high - low), high + air * (high - low)


def _y_range(
    curves: Sequence[Curve], frame: Sequence[str], band: float | None
) -> tuple[float, float]:
    must = [c.y for c in curves if c.name in frame]
    if band is not None:
        must.append(np.array([-band, band]))
    low, high = _range(must)
    reach = high - low
    may = [np.clip(c.y, low - reach, high + reach) for c in curves]
    return _range([np.array([low, high]), *may], AIR)


def _across(values: Array, limits: tuple[float, float]) -> Array:
    """Return values as places in the square, from the first limit to the second."""
    return SIDE * (values - limits[0]) / (limits[1] - limits[0])


def _line(
    curve: Curve,
    x_range: tuple[float, float],
    y_range: tuple[float, float],
    slices: int,
) -> Line:
    if curve.dots:
        chosen = np.arange(0, len(curve.x), max(1, -(-len(curve.x) // MOST_DOTS)))
    else:
        chosen = extremes(curve.y, slices)
    x = _across(curve.x[chosen], x_range)
    y = np.clip(_across(curve.y[chosen], y_range[::-1]), -SIDE, 2 * SIDE)
    return Line(curve.name, curve.css, _path(x, y, dots=curve.dots))


def _path(x: Array, y: Array, *, dots: bool) -> str:
    """Return an SVG path; what is not finite interrupts it."""
    parts: list[str] = []
    broken = True
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        if not (math.isfinite(a) and math.isfinite(b)):
            broken = True
            continue
        if dots:
            parts.append(f"M{a:.1f} {b:.1f}h0")
        else:
            parts.append(f"{'M' if broken else 'L'}{a:.1f} {b:.1f}")
        broken = False
    return "".join(parts)
