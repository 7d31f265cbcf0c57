"""All frequencies at which a loop's gain is one or its phase is -180°.

Branch and bound on the exact response: an interval is dropped when the bounds of its
slope prove that no level is reached in it, solved by Brent's method when they prove
that the function is monotone there, and halved otherwise. No grid decides what is
found. Two crossings closer together than one part in 10¹¹ count as touching, not
crossing.

With a delay the phase crosses for ever; the search ends one turn after the last
frequency at which the gain is above 1/1000, and at the latest one turn after 30 times
the largest zero or pole.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from bondgraph.loopshaping.curve import Curve
from bondgraph.loopshaping.zero_pole_gain import FloatArray

NARROWEST = 1e-11  # relative width of an interval that is not halved any more
SMALLEST_GAIN = 1e-3  # of phase crossovers that are searched for behind a delay

Function = Callable[[FloatArray], FloatArray]
Bounds = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Search:
    """A function of ν and bounds of its slope d/d ln ν on intervals.

    Parameters
    ----------
    spacing
        Distance of the levels that are searched for: one level, zero, if infinite;
        zero plus whole multiples otherwise.
    """

    function: Function
    bounds: Bounds
    spacing: float = math.inf

    def crossings(self, low: FloatArray, high: FloatArray) -> list[float]:
        """Return where the function reaches a level, ascending."""
        found: list[float] = []
        while len(low):
            middle = np.sqrt(low * high)
            values = self.function(middle)
            least, most = self.bounds(low, high)
            reach = np.log(high / middle)
            spread = np.maximum(np.abs(least), np.abs(most)) * reach
            open_ = self._reaches(values, spread)
            low, high, middle = low[open_], high[open_], middle[open_]
            least, most = least[open_], most[open_]
            monotone = (least >= 0) | (most <= 0)
            tiny = np.log(high / low) < NARROWEST
            for a, b in zip(low[monotone | tiny], high[monotone | tiny], strict=True):
                found += self._solved(float(a), float(b))
            rest = ~(monotone | tiny)
            low, high, middle = low[rest], high[rest], middle[rest]
            low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        return _distinct(found)

    def _reaches(self, values: FloatArray, spread: FloatArray) -> Any:
        """Return whether a level may lie within `spread` of each value."""
        if math.isinf(self.spacing):
            return np.abs(values) <= spread
        nearest = np.abs(values - self.spacing * np.round(values / self.spacing))
        return nearest <= spread

    def _solved(self, a: float, b: float) -> list[float]:
        """Return the crossings of a monotone stretch."""
        first, last = (float(v) for v in self.function(np.array([a, b])))
        if math.isinf(self.spacing):
            levels = [0.0] if min(first, last) <= 0 <= max(first, last) else []
        else:
            lowest = math.ceil(min(first, last) / self.spacing)
            highest = math.floor(max(first, last) / self.spacing)
            levels = [k * self.spacing for k in range(lowest, highest + 1)]
        return [self._root(a, b, level) for level in levels if first != last]

    def _root(self, a: float, b: float, level: float) -> float:
        def shifted(x: float) -> float:
            return float(self.function(np.array([math.exp(x)]))[0]) - level

        x, y = math.log(a), math.log(b)
        for end in (x, y):
            if shifted(end) == 0:
                return math.exp(end)
        if shifted(x) * shifted(y) > 0:  # a level at the very end, lost in rounding
            return a if abs(shifted(x)) < abs(shifted(y)) else b
        return math.exp(brentq(shifted, x, y, xtol=1e-15, rtol=1e-14))


def gain_crossovers(loop: Curve) -> list[float]:
    """Return every ν at which the gain is one."""
    search = Search(
        function=lambda nu: loop.logarithm(nu).real,
        bounds=lambda a, b: loop.slopes(a, b).magnitude,
    )
    return search.crossings(*loop.pieces(*loop.span()))


def phase_crossovers(loop: Curve) -> list[float]:
    """Return every ν at which the phase is -180° plus whole turns."""
    low, high = loop.span()
    if loop.delay:
        high = _end_behind_delay(loop, low, high)
    search = Search(
        function=lambda nu: loop.logarithm(nu).imag - np.pi,
        bounds=lambda a, b: loop.slopes(a, b).phase,
        spacing=2 * np.pi,
    )
    found = search.crossings(*loop.pieces(low, high))
    return [nu for nu in found if _truly_negative(loop, nu)]


def _truly_negative(loop: Curve, nu: float) -> bool:
    """Return whether the response there is a finite negative number."""
    value = loop.value(np.array([nu]))[0]
    return bool(np.isfinite(value) and abs(value) > 0 and value.real < 0)


def _end_behind_delay(loop: Curve, low: float, high: float) -> float:
    """Return one turn of the delay after the last gain of `SMALLEST_GAIN`."""
    floor = math.log(SMALLEST_GAIN)
    search = Search(
        function=lambda nu: loop.logarithm(nu).real - floor,
        bounds=lambda a, b: loop.slopes(a, b).magnitude,
    )
    last = max(search.crossings(*loop.pieces(low, high)), default=low)
    if loop.logarithm(np.array([high]))[0].real > floor:
        last = high
    # Beyond that the response is a mere spiral; thousands of turns tell nothing.
    last = min(last, 30 * float(np.abs(loop.roots).max(initial=1 / abs(loop.delay))))
    return last + 3 * math.pi / abs(loop.delay)


def _distinct(found: list[float]) -> list[float]:
    """Return the crossings ascending; one at a shared end of two pieces once."""
    kept: list[float] = []
    for nu in sorted(found):
        if not kept or nu > kept[-1] * (1 + 1e-12):
            kept.append(nu)
    return kept
