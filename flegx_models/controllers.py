"""Loops and controllers of chapter 5: printed, modified, tuned; and what they achieve.

Every loop is factored: lead · motor · train · encoder filter. A reading says which of
the thesis's conflicting numbers are put in; `printed_reading` takes eq. 5.10 to 5.24 as
they stand, and then all four loops are unstable; `corrected_reading` makes the two
corrections that the printed margins need:

- the driver's fast pole is 1.61e6 rad/s (eq. 4.36), not 1.16e6 (eq. 5.10 ff., two
  digits swapped);
- the filter's cut-off is 25 Hz (section 3.4), not 25 rad/s (eq. 5.11 ff.).

The numerators of eq. 5.10 to 5.22 need a third number that is not printed. With
controllers in ampere per radian and a driver scaling that makes one ampere of command
one ampere of current (5 % of duty per ampere, 1/0.20), all four follow, to their three
digits, from K_m = 0.042 N·m/A where Table 2.1 prints 0.0427; see `numerator`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from bondgraph import BondGraphError
from flegx_models.characterisation.encoder_filter import ButterworthPair
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_control import CONTROL
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.published import PUBLISHED, PublishedTransferFunction

ComplexArray = NDArray[np.complex128]

MODELS = ("lowerleg_flight", "upperleg_flight", "lowerleg_stance", "upperleg_stance")
"""The four loops, named like their plants in `flegx_models.models`."""

VERSIONS = ("printed", "modified", "tuned")
"""Designed with the bearings' friction; for ten times that; and on the machine."""


@dataclass(frozen=True, slots=True)
class Controller:
    """A lead K (s + z)/(1 + s/p), from angle error (rad) to current (A).

    ``gain`` K in A·s/rad, ``zero`` z and ``pole`` p as magnitudes in rad/s.
    """

    gain: float
    zero: float
    pole: float

    @property
    def numerator(self) -> tuple[float, float]:
        """Coefficients of s, highest power first."""
        return self.gain, self.gain * self.zero

    @property
    def denominator(self) -> tuple[float, float]:
        """Coefficients of s, highest power first."""
        return 1 / self.pole, 1.0

    def response(self, s: ComplexArray) -> ComplexArray:
        """Return the values at points of the s-plane."""
        return np.asarray(self.gain * (s + self.zero) / (1 + s / self.pole))


@cache
def controller(model: str, version: str = "printed") -> Controller:
    """Return the controller of one of the four loops.

    Parameters
    ----------
    model
        One of `MODELS`.
    version
        ``printed`` (eq. 5.12, 5.16, 5.20, 5.24), ``modified`` (section 5.2, for ten
        times the friction) or ``tuned`` (eq. 6.1 to 6.4).

    Raises
    ------
    BondGraphError
        If there is no such loop or version.
    """
    if model not in MODELS or version not in VERSIONS:
        raise BondGraphError(
            f"There is no {version} controller of {model!r}.",
            (model, version),
            f"Choose one of {', '.join(MODELS)} and {', '.join(VERSIONS)}.",
        )
    values = CONTROL.values_by_name()
    name = model if version == "printed" else f"{model}_{version}"
    return Controller(values[f"K_{name}"], values[f"z_{name}"], values[f"p_{name}"])


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """Which of the conflicting numbers a loop is made of.

    Parameters
    ----------
    fast_pole
        Of the driver, rad/s.
    filter_cutoff
        rad/s.
    corrections
        What differs from the printed formulas, in words.
    """

    fast_pole: float
    filter_cutoff: float
    corrections: tuple[str, ...] = ()


def printed_reading() -> Reading:
    """Return eq. 5.10 to 5.24 as they stand."""
    return Reading(
        fast_pole=CONTROL.values_by_name()["fast_pole_loop"],
        filter_cutoff=CHAPTER_3.values_by_name()["omega_filter"],
    )


def corrected_reading() -> Reading:
    """Return the reading that gives the printed margins of the lower leg."""
    return Reading(
        fast_pole=CONTROL.values_by_name()["fast_pole_driver"],
        filter_cutoff=2 * math.pi * CHAPTER_3.values_by_name()["f_filter"],
        corrections=(
            "the driver's fast pole is 1.61e6 rad/s as in eq. 4.36, not 1.16e6",
            "the filter's cut-off is 25 Hz as in section 3.4, not 25 rad/s",
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedLoop:
    """One of the four loops, around once: lead, motor, train and encoder filter.

    Parameters
    ----------
    numerator
        Of eq. 5.10 to 5.22, without the lead.
    zero, fast_pole, slow_pole
        Of the motor with its driver, magnitudes in rad/s.
    friction_pole
        Of the train, magnitude in rad/s.
    """

    lead: Controller
    numerator: float
    zero: float
    fast_pole: float
    slow_pole: float
    friction_pole: float
    filter: ButterworthPair

    def response(self, omega: float) -> complex:
        """Return the loop's frequency response at `omega` in rad/s."""
        s = np.array([1j * omega])
        motor = (s + self.zero) / (s + self.fast_pole) / (s + self.slow_pole)
        train = self.numerator / (s * (s + self.friction_pole))
        around = self.lead.response(s) * motor * train * self.filter.response(omega)
        return complex(around[0])

    def phase(self, omega: float) -> float:
        """Return the phase in rad, continuous from -π or -π/2 at low frequency."""
        corner = math.atan2(
            self.filter.damping_term * omega * self.filter.cutoff,
            self.filter.cutoff**2 - omega**2,
        )
        lags = (self.fast_pole, self.slow_pole, self.friction_pole, self.lead.pole)
        leads = (self.zero, self.lead.zero)
        return (
            sum(math.atan(omega / z) for z in leads)
            - sum(math.atan(omega / p) for p in lags)
            - 2 * corner
            - math.pi / 2
        )

    @property
    def figures(self) -> "LoopFigures":
        """Crossovers and phase margin."""
        low, high = 1e-3 * self.lead.pole, 1e2 * self.lead.pole
        crossover = _root(lambda w: math.log(abs(self.response(w))), low, high)
        return LoopFigures(
            crossover=crossover,
            turnover=_root(lambda w: self.phase(w) + math.pi, low, high),
            phase_margin=math.pi + self.phase(crossover),
        )

    def rubbed(self, friction_pole: float) -> "PrintedLoop":
        """Return the loop with another friction pole in the train."""
        return replace(self, friction_pole=friction_pole)


@dataclass(frozen=True, slots=True)
class LoopFigures:
    """Gain crossover and phase crossover in rad/s, phase margin in rad."""

    crossover: float
    turnover: float
    phase_margin: float


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq  # noqa: PLC0415

    return float(brentq(function, low, high))


def printed_loop(
    model: str, version: str = "printed", reading: Reading | None = None
) -> PrintedLoop:
    """Return a loop of chapter 5 with one of its controllers.

    Parameters
    ----------
    model, version
        See `controller`.
    reading
        The corrected one by default.
    """
    chosen = corrected_reading() if reading is None else reading
    values = CONTROL.values_by_name()
    return PrintedLoop(
        lead=controller(model, version),
        numerator=values[f"numerator_{model}"],
        zero=values["zero_driver"],
        fast_pole=chosen.fast_pole,
        slow_pole=values["slow_pole_driver"],
        friction_pole=_published(model).friction_pole,
        filter=ButterworthPair(
            cutoff=chosen.filter_cutoff,
            damping_term=CHAPTER_3.values_by_name()["filter_damping_term"],
        ),
    )


def printed_figures(model: str) -> LoopFigures:
    """Return crossover, phase crossover and margin as section 5.2 prints them."""
    values = CONTROL.values_by_name()
    return LoopFigures(
        values[f"crossover_{model}"],
        values[f"turnover_{model}"],
        values[f"margin_{model}"],
    )


def numerator(gain: float, torque_constant: float | None = None) -> float:
    """Return the numerator of eq. 5.10 to 5.22 that follows from eq. 4.36.

    K_m · p₁ p₂ / z · gain in 1/s³, for a command in ampere that the driver turns into
    as many ampere at rest.

    Parameters
    ----------
    gain
        Of the train, rad/s² per N·m (eq. 4.7, 4.12, 4.30, 4.35).
    torque_constant
        K_m in N·m/A; Table 2.1's by default.
    """
    values = CONTROL.values_by_name()
    K_m = DATASHEETS.values_by_name()["K_m"]
    poles = values["fast_pole_driver"] * values["slow_pole_driver"]
    chosen = K_m if torque_constant is None else torque_constant
    return chosen * poles / values["zero_driver"] * gain


def torque_constants_of_the_numerators() -> tuple[float, float]:
    """Return the least and greatest K_m (N·m/A) from which all four numerators follow.

    If no one K_m gave them all, the greatest would lie below the least.
    """
    lows, highs = [], []
    for model in MODELS:
        printed = CONTROL.find(f"numerator_{model}")
        assert printed.value is not None
        assert printed.rounding is not None
        unit = numerator(_published(model).gain, 1.0)
        lows.append((printed.value - printed.rounding) / unit)
        highs.append((printed.value + printed.rounding) / unit)
    return max(lows), min(highs)


def _published(model: str) -> PublishedTransferFunction:
    return next(p for p in PUBLISHED if p.model == model)
