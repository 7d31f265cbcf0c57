"""The frequency response of a loop as a curve with bounds on how fast it moves.

Between two frequencies the magnitude and the phase of a factored system can change only
so much: for each root the slopes are elementary functions whose extremes over an
interval are known. `Curve.slopes` adds them up. With such bounds a search is complete:
an interval is dropped when nothing can be in it, not when nothing was seen in it.

A sampled system is looked at through ``z = (1 + s h/2) / (1 - s h/2)``, which maps the
unit circle onto the imaginary axis and keeps inside inside; its frequencies are
``ω = (2/h) atan(ν h/2)``. From there on it is a rational system like any other.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.zero_pole_gain import (
    ComplexArray,
    FloatArray,
    ZeroPoleGain,
)

_AXIS = 1e-13  # a real part below this share of the magnitude lies on the axis
_NO_DELAY = 1e-12  # rad at the fastest root: below rounding
_BESIDE = 1e-9  # how close, relatively, to an undamped root a search goes


Pair = tuple[FloatArray, FloatArray]


class Slopes(NamedTuple):
    """Least and greatest d ln|L| / d ln ν, and dφ / d ln ν in rad, on intervals."""

    magnitude: Pair
    phase: Pair

    def steepest(self) -> Pair:
        """Return the greatest size of each."""
        (a, b), (c, d) = self
        steep = np.maximum(np.abs(a), np.abs(b))
        return steep, np.maximum(np.abs(c), np.abs(d))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve:
    """``gain · Π(jν - root)^order · exp(-jν delay)`` for ν > 0.

    Parameters
    ----------
    roots, orders
        Zeros with order +1 and poles with order -1.
    delay
        Seconds; negative for the reciprocal of a delayed system.
    period
        Sampling period of the system this is the image of.
    """

    roots: ComplexArray
    orders: FloatArray
    gain: float
    delay: float
    period: float | None = None

    def logarithm(self, nu: FloatArray) -> ComplexArray:
        """Return ln of the response: log magnitude, and continuous phase in rad."""
        real, imag = self.roots.real, self.roots.imag
        u = nu[:, None] - imag
        with np.errstate(divide="ignore"):
            magnitude = np.log(np.hypot(real, u)) @ self.orders
        angle = np.where(real <= 0, np.arctan2(u, -real), np.pi - np.arctan2(u, real))
        phase = angle @ self.orders - nu * self.delay
        if self.gain < 0:
            phase = phase - np.pi
        size = math.log(abs(self.gain)) if self.gain else -math.inf
        return np.asarray(magnitude + size + 1j * phase)

    def value(self, nu: FloatArray) -> ComplexArray:
        """Return the response."""
        with np.errstate(over="ignore"):
            return np.asarray(np.exp(self.logarithm(nu)))

    def reciprocal(self) -> "Curve":
        """Return the curve of one over this."""
        return Curve(
            roots=self.roots,
            orders=-self.orders,
            gain=1 / self.gain,
            delay=-self.delay,
            period=self.period,
        )

    def slopes(self, low: FloatArray, high: FloatArray) -> Slopes:
        """Return bounds of the derivatives with respect to ln ν on intervals."""
        a, b = low[:, None], high[:, None]
        size = _scaled(*_magnitude_slope(self.roots, a, b), a, b)
        turn = _scaled(*_phase_slope(self.roots, a, b), a, b)
        slowest, fastest = _weighted(*turn, self.orders)
        lags = (self.delay * low, self.delay * high)
        phase = (slowest - np.maximum(*lags), fastest - np.minimum(*lags))
        return Slopes(_weighted(*size, self.orders), phase)

    def undamped(self) -> FloatArray:
        """Return the frequencies of roots on the imaginary axis, ascending."""
        on_axis = np.abs(self.roots.real) <= _AXIS * np.abs(self.roots)
        return np.unique(self.roots.imag[on_axis & (self.roots.imag > 0)])

    def omega(self, nu: float) -> float:
        """Return the true frequency in rad/s."""
        if self.period is None:
            return nu
        return 2 / self.period * math.atan(nu * self.period / 2)

    def nu(self, omega: FloatArray) -> FloatArray:
        """Return the frequencies ν of true frequencies in rad/s."""
        if self.period is None:
            return omega
        return np.asarray(2 / self.period * np.tan(omega * self.period / 2))

    def pieces(self, low: float, high: float) -> tuple[FloatArray, FloatArray]:
        """Return intervals that cover low to high, an eighth of a decade or less.

        Undamped roots are left out by one part in 10⁹.
        """
        corners = np.abs(self.roots.imag)
        inside = corners[(corners > low) & (corners < high)]
        count = max(2, math.ceil(8 * math.log10(high / low)) + 1)
        ends = np.unique(np.concatenate([np.geomspace(low, high, count), inside]))
        starts, stops = ends[:-1].copy(), ends[1:].copy()
        for w in self.undamped():
            starts[starts == w] = w * (1 + _BESIDE)
            stops[stops == w] = w * (1 - _BESIDE)
        return starts, stops

    def span(self) -> tuple[float, float]:
        """Return frequencies outside of which only asymptotes are left."""
        sizes = np.abs(self.roots)
        corners = [float(x) for x in sizes[sizes > 0]]
        if self.delay:
            corners.append(1 / abs(self.delay))
        if not corners:
            corners.append(1.0)
        low, high = 1e-6 * min(corners), 1e6 * max(corners)
        order = float(self.orders[sizes == 0].sum())
        if order:
            low = min(low, 1e-3 * self._unit_gain(low, order))
        total = float(self.orders.sum())
        if total:
            high = max(high, 1e3 * self._unit_gain(high, total))
        return low, high

    def _unit_gain(self, nu: float, order: float) -> float:
        """Return where the asymptote of that order through ν has magnitude one."""
        size = self.logarithm(np.array([nu]))[0].real
        return float(nu * np.exp(np.clip(-size / order, -600.0, 600.0)))


def curve(system: ZeroPoleGain) -> Curve:
    """Return the frequency curve of a system.

    Raises
    ------
    LoopShapingError
        If the gain is zero, or the system has more zeros than poles.
    """
    if system.gain == 0:
        raise LoopShapingError(
            "The loop's gain is zero: nothing is fed back.",
            remedy="Give the controller and the plant a gain.",
        )
    if system.relative_degree < 0:
        raise LoopShapingError(
            f"The loop has {len(system.zeros)} zeros and {len(system.poles)} poles: "
            f"its gain grows without bound.",
            remedy="Add poles, such as a roll-off.",
        )
    zeros, poles, gain = system.zeros, system.poles, system.gain
    if system.period is not None:
        zeros, poles, gain = _through_bilinear(system, system.period)
    roots = np.array([*zeros, *poles], dtype=complex)
    late = 0.0 if system.period is not None else system.delay
    if late * float(np.abs(roots).max(initial=abs(gain))) < _NO_DELAY:
        late = 0.0
    real = np.where(np.abs(roots.real) <= _AXIS * np.abs(roots), 0.0, roots.real)
    return Curve(
        roots=real + 1j * roots.imag,
        orders=np.array([1.0] * len(zeros) + [-1.0] * len(poles)),
        gain=gain,
        delay=late,
        period=system.period,
    )


def _through_bilinear(
    system: ZeroPoleGain, period: float
) -> tuple[tuple[complex, ...], tuple[complex, ...], float]:
    """Return zeros, poles and gain of ``L(z(s))``."""
    half = period / 2
    late = (0j,) * round(system.delay / period)
    gain = complex(system.gain)
    sides: list[tuple[complex, ...]] = []
    for roots, power in ((system.zeros, 1), (system.poles + late, -1)):
        moved = []
        for given in roots:
            # A pole at z = -1 counts as stable, like one at z = 1 or on the axis.
            root = given + _BESIDE if given == -1 and power < 0 else given
            # z - r = half (1 + r) (s - s_r) / (1 - s half); at r = -1, 2 / (1 - s half)
            if root == -1:
                gain *= 2.0**power
            else:
                gain *= (half * (1 + root)) ** power
                moved.append((root - 1) / (half * (1 + root)))
        sides.append(tuple(moved))
    zeros, poles = sides
    excess = len(system.poles) + len(late) - len(system.zeros)
    # (1 - s half)^excess remains, as zeros at 1/half
    gain *= (-half) ** excess
    zeros += (complex(1 / half),) * excess
    return zeros, poles, gain.real


def _magnitude_slope(
    roots: ComplexArray, a: FloatArray, b: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Bounds of d ln|jν - r| / dν = u / (σ² + u²), u = ν - Im r, on [a, b]."""
    size = np.abs(roots.real)
    u, v = a - roots.imag, b - roots.imag
    with np.errstate(divide="ignore", invalid="ignore"):
        first = _over(u, size)
        last = _over(v, size)
        peak = np.where(size > 0, 1 / (2 * size), np.inf)
    low, high = np.minimum(first, last), np.maximum(first, last)
    high = np.where((u < size) & (v > size), peak, high)
    low = np.where((u < -size) & (v > -size), -peak, low)
    return low, high


def _over(u: FloatArray, size: FloatArray) -> FloatArray:
    return np.asarray(np.where(u == 0, 0.0, u / (size**2 + u**2)))


def _phase_slope(
    roots: ComplexArray, a: FloatArray, b: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Bounds of d arg(jν - r) / dν = -σ / (σ² + u²) on [a, b]."""
    real = roots.real
    u, v = a - roots.imag, b - roots.imag
    nearest = np.where((u < 0) & (v > 0), 0.0, np.minimum(np.abs(u), np.abs(v)))
    farthest = np.maximum(np.abs(u), np.abs(v))
    with np.errstate(divide="ignore", invalid="ignore"):
        steep = np.where(real == 0, 0.0, -real / (real**2 + nearest**2))
        flat = np.where(real == 0, 0.0, -real / (real**2 + farthest**2))
    return np.minimum(steep, flat), np.maximum(steep, flat)


def _scaled(
    low: FloatArray, high: FloatArray, a: FloatArray, b: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return bounds of a product with ν in [a, b], ν > 0."""
    return np.minimum(low * a, low * b), np.maximum(high * a, high * b)


def _weighted(
    low: FloatArray, high: FloatArray, orders: FloatArray
) -> tuple[FloatArray, FloatArray]:
    zeros, poles = orders > 0, orders < 0
    least = low[:, zeros].sum(axis=1) - high[:, poles].sum(axis=1)
    most = high[:, zeros].sum(axis=1) - low[:, poles].sum(axis=1)
    return least, most
