"""The printed loops of chapter 5: crossovers and margins with their rounding.

The response is the product of its factors at jω, so no digits are lost beside the fast
pole. The gain falls monotonically with frequency, so the gain crossover is one root in
a bracket, and so is the phase crossover, where the filter takes over.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

from scipy.optimize import brentq

from flegx_models.audit.records import Remark, Row, Verdict
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_control import CONTROL
from flegx_models.published import PUBLISHED

_HERTZ = 2 * math.pi


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedLoop:
    """Controller, motor driver, leg and encoder filter of one loop.

    L = K (s + z)/(1 + s/p) · numerator (s + zero)/(s (s + fast) (s + slow)
    (s + friction)) · filter, eq. 5.10 to 5.24.

    Parameters
    ----------
    gain, zero, pole
        K, z and p of the controller.
    numerator, friction, fast_pole
        Of the direct branch; rad/s for the poles.
    cut_off
        Of the filter, rad/s.
    """

    gain: float
    zero: float
    pole: float
    numerator: float
    friction: float
    fast_pole: float
    cut_off: float

    def magnitude(self, omega: float) -> float:
        """Return |L(jω)|."""
        return abs(self._value(omega))

    def phase(self, omega: float) -> float:
        """Return the phase in degrees, continuous from -90° at low frequency on."""
        fast, slow = self.fast_pole, _number("slow_pole_driver")
        lead = math.atan2(omega, self.zero) + math.atan2(omega, _number("zero_driver"))
        lags = (self.pole, fast, slow, self.friction)
        lag = math.pi / 2 + sum(math.atan2(omega, pole) for pole in lags)
        x = omega / self.cut_off
        damping = CHAPTER_3["filter_damping_term"].value or 0.0
        lag += 2 * math.atan2(damping * x, 1 - x * x)
        return math.degrees(lead - lag)

    def _value(self, omega: float) -> complex:
        s = 1j * omega
        controller = self.gain * (s + self.zero) / (1 + s / self.pole)
        driver = (s + _number("zero_driver")) / (
            (s + self.fast_pole) * (s + _number("slow_pole_driver"))
        )
        leg = self.numerator / (s * (s + self.friction))
        x = s / self.cut_off
        damping = CHAPTER_3["filter_damping_term"].value or 0.0
        return controller * driver * leg / (1 + damping * x + x * x) ** 2

    def figures(self) -> tuple[float, float, float]:
        """Return gain crossover, phase crossover (rad/s), phase margin (degrees)."""
        crossover = _root(lambda w: math.log(self.magnitude(w)), 1e-3, 1e3)
        turnover = _root(lambda w: self.phase(w) + 180, 1.0, 1e3)
        return crossover, turnover, 180 + self.phase(crossover)


def _root(function: object, low: float, high: float) -> float:
    found = brentq(function, low, high, xtol=1e-12)  # type: ignore[call-overload]
    return float(found)


def _number(name: str) -> float:
    value = CONTROL[name].value
    assert value is not None
    return value


def corrected_loop(model: str, *, controller: str = "") -> PrintedLoop:
    """Return one loop with the fast pole of eq. 4.36 and the filter at 25 Hz.

    Parameters
    ----------
    controller
        ``modified`` or ``tuned`` for the other controllers of the thesis.
    """
    key = f"{model}_{controller}" if controller else model
    (entry,) = (e for e in PUBLISHED if e.model == model)
    return PrintedLoop(
        gain=_number(f"K_{key}"),
        zero=_number(f"z_{key}"),
        pole=_number(f"p_{key}"),
        numerator=_number(f"numerator_{model}"),
        friction=entry.friction_pole,
        fast_pole=_number("fast_pole_driver"),
        cut_off=_HERTZ * (CHAPTER_3["f_filter"].value or 0.0),
    )


def as_printed(model: str) -> PrintedLoop:
    """Return one loop exactly as eq. 5.10 to 5.24 print it."""
    return replace(
        corrected_loop(model),
        fast_pole=_number("fast_pole_loop"),
        cut_off=CHAPTER_3["omega_filter"].value or 0.0,
    )


def _intervals(model: str) -> list[tuple[float, float]]:
    """Return the ranges of the figures over the rounding of the loop's numbers.

    The figures are monotone in each number over so small a box: its corners do.
    """
    loop = corrected_loop(model)
    ends = []
    for field, name in (
        ("gain", f"K_{model}"),
        ("zero", f"z_{model}"),
        ("pole", f"p_{model}"),
        ("numerator", f"numerator_{model}"),
    ):
        parameter = CONTROL[name]
        half = parameter.rounding or 0.0
        value = getattr(loop, field)
        ends.append([(field, value - half), (field, value + half)])
    friction = [
        ("friction", loop.friction - 0.005),
        ("friction", loop.friction + 0.005),
    ]
    found = [
        replace(loop, **dict(corner)).figures() for corner in product(*ends, friction)
    ]
    return [(min(f), max(f)) for f in zip(*found, strict=True)]


_FIGURES = (
    ("crossover", "gain crossover", "rad/s", 1.0),
    ("turnover", "phase crossover", "rad/s", 1.0),
    ("margin", "phase margin", "°", math.pi / 180),
)
_CORRECTION = (
    "fast pole 1.61e6 of eq. 4.36 (1.16e6 in eq. 5.10 ff. has two digits swapped) and "
    "filter at 25 Hz as in section 3.4 (the formula divides by 25 rad/s)"
)


def rows() -> Iterator[Row]:
    """Yield the rows of the loops of section 5.2."""
    for entry in PUBLISHED:
        printed = as_printed(entry.model).figures()
        figures = corrected_loop(entry.model).figures()
        ranges = _intervals(entry.model)
        for k, (key, quantity, unit, size) in enumerate(_FIGURES):
            parameter = CONTROL[f"{key}_{entry.model}"]
            value = (parameter.value or 0.0) / size
            half = (parameter.rounding or 0.0) / size
            low, high = ranges[k]
            meets = low <= value + half and high >= value - half
            yield Row(
                chapter=5,
                where="section 5.2",
                quantity=f"{quantity}, {entry.model.replace('_', ', ')}",
                printed=value,
                unit=unit,
                derived=printed[k],
                corrected=figures[k],
                verdict=Verdict.CORRECTED if meets else Verdict.NOT_REPRODUCIBLE,
                cause=_CORRECTION
                if meets
                else f"with the fast pole 1.61e6 and the filter at 25 Hz the rounding "
                f"of the loop's numbers leaves {low:.2f} to {high:.2f}",
            )


def remarks() -> Iterator[Remark]:
    """Yield what the loops say beside their figures."""
    yield Remark(
        where="section 5.2",
        statement="The gain crossover is called ω_cp there and the phase crossover "
        "ω_cg, the other way round than usual.",
    )
    readings: tuple[tuple[str, tuple[str, ...]], ...] = (
        ("exactly as printed", ()),
        ("as printed but the fast pole, 1.61e6,", ("fast_pole",)),
        ("as printed but the filter, at 25 Hz,", ("cut_off",)),
    )
    for words, fields in readings:
        margins = [_margin(entry.model, fields) for entry in PUBLISHED]
        yield Remark(
            where="eq. 5.10 to 5.24",
            statement=f"With the equations {words} the phase margins are "
            + ", ".join(f"{margin:.1f}°" for margin in margins)
            + ".",
        )
    yield _highest_turnover()


def _margin(model: str, corrected: tuple[str, ...]) -> float:
    """Return the phase margin with only these fields corrected."""
    right = corrected_loop(model)
    changes = {field: getattr(right, field) for field in corrected}
    return replace(as_printed(model), **changes).figures()[2]


def _highest_turnover() -> Remark:
    controllers = [
        corrected_loop(entry.model, controller=kind)
        for entry in PUBLISHED
        for kind in ("", "modified", "tuned")
    ]
    best = max(
        replace(
            corrected_loop(model), gain=other.gain, zero=other.zero, pole=other.pole
        ).figures()[1]
        for model in ("upperleg_flight", "upperleg_stance")
        for other in controllers
    )
    return Remark(
        where="figures 5.6, 5.10",
        statement=f"Of all {len(controllers)} printed controllers none brings the "
        f"upper leg's phase crossover above {best:.1f} rad/s; 67.25 and 65.75 are "
        f"printed.",
    )
