"""Loops and controllers of chapter 5: printed, modified, tuned; and what they achieve.

Every loop is factored: lead · motor · train · encoder filter. A reading says which of
the thesis's conflicting numbers are put in; `printed_reading` takes eq. 5.10 to 5.24 as
they stand, and then all four loops are unstable; `corrected_reading` makes the two
corrections that the printed margins need:

- the driver's fast pole is 1.61e6 rad/s (eq. 4.36), not 1.16e6 (eq. 5.10 ff., two
  digits swapped);
- the filter's cut-off is 25 Hz (section 3.4), not 25 rad/s (eq. 5.11, 5.15, 5.19 and
  5.23).

The numerators of eq. 5.10 to 5.22 are taken as printed; `flegx_models.loop_numerators`
says what they follow from.
"""

import math
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

from bondgraph import BondGraphError, Lead, Loop, ZeroPoleGain, measure
from flegx_models.characterisation.encoder_filter import ButterworthPair
from flegx_models.parameters_chapter3 import CHAPTER_3
from flegx_models.parameters_control import CONTROL
from flegx_models.published import PUBLISHED, PublishedTransferFunction

MODELS = ("lowerleg_flight", "upperleg_flight", "lowerleg_stance", "upperleg_stance")
"""The four loops, named like their plants in `flegx_models.models`."""

VERSIONS = ("printed", "modified", "tuned")
"""Designed with the bearings' friction; for ten times that; and on the machine."""


@cache
def controller(model: str, version: str = "printed") -> Lead:
    """Return the lead of one of the four loops, from angle error (rad) to current (A).

    Its gain is in A·s/rad, its zero and pole are magnitudes in rad/s.

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
    return Lead(values[f"K_{name}"], values[f"z_{name}"], values[f"p_{name}"])


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

    lead: Lead
    numerator: float
    zero: float
    fast_pole: float
    slow_pole: float
    friction_pole: float
    filter: ButterworthPair

    @property
    def loop(self) -> Loop:
        """The loop in factored form, the filter in its feedback (figure 5.3)."""
        poles = (0.0, -self.friction_pole, -self.slow_pole, -self.fast_pole)
        return Loop(
            plant=ZeroPoleGain(zeros=(-self.zero,), poles=poles, gain=self.numerator),
            controller=self.lead.transfer,
            feedback=ZeroPoleGain(
                poles=self.filter.poles, gain=self.filter.numerator[0]
            ),
        )

    @property
    def figures(self) -> "LoopFigures":
        """Crossovers and phase margin."""
        found = measure(self.loop, step=False)
        return LoopFigures(
            crossover=found.crossover,
            turnover=found.phase_crossovers[0].omega,
            phase_margin=math.radians(found.phase_margin),
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


def evaluated() -> tuple[tuple[str, str, PrintedLoop], ...]:
    """Return model, version and corrected loop of all twelve printed controllers.

    Each against the friction that it is for: the bearings', ten times that (section
    5.2), and for the tuned ones the friction whose pole their zero would cancel.
    """
    growth = CONTROL.values_by_name()["friction_growth"]
    found = []
    for model, version in product(MODELS, VERSIONS):
        loop = printed_loop(model, version)
        friction_poles = {
            "printed": loop.friction_pole,
            "modified": growth * loop.friction_pole,
            "tuned": loop.lead.zero,
        }
        found.append((model, version, loop.rubbed(friction_poles[version])))
    return tuple(found)


def printed_figures(model: str) -> LoopFigures:
    """Return crossover, phase crossover and margin as section 5.2 prints them."""
    values = CONTROL.values_by_name()
    return LoopFigures(
        values[f"crossover_{model}"],
        values[f"turnover_{model}"],
        values[f"margin_{model}"],
    )


def _published(model: str) -> PublishedTransferFunction:
    return next(p for p in PUBLISHED if p.model == model)
