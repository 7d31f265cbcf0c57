"""The printed results of chapter 3, each computed again from the printed data.

A result agrees where the interval that its data's rounding allows meets the interval
that its own rounding allows. Every formula is monotone in each of its data within the
rounding, so the corners of the rounding box give that interval.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

from bondgraph import Parameter, ParameterSet
from flegx_models.characterisation.added_mass import equivalent_mass
from flegx_models.characterisation.cantilever import Cantilever
from flegx_models.characterisation.encoder_filter import ButterworthPair, PwmEncoder
from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.free_decay import (
    damping_factor,
    natural_frequency,
    printed_damping_factor,
)
from flegx_models.characterisation.pendulum import centre_of_mass, joint_centre
from flegx_models.characterisation.tendons import RoundColumn
from flegx_models.parameters import PRINTED
from flegx_models.parameters_chapter3 import CHAPTER_3

_ALL = CHAPTER_3.merged([PRINTED["I_gear"]])


@dataclass(frozen=True, slots=True, kw_only=True)
class Recomputed:
    """A printed result beside the one that the printed data give.

    Parameters
    ----------
    quantity, equation
        Name in `flegx_models.parameters_chapter3`, and where the relation is.
    printed, rounding, unit
        As printed, and half a unit of its last digit.
    derived, low, high
        From the data as printed, and from the corners of their rounding.
    cause
        Why the two differ, or what was corrected; empty for the formula as printed.
    """

    quantity: str
    equation: str
    printed: float
    rounding: float
    unit: str
    derived: float
    low: float
    high: float
    cause: str = ""

    @property
    def agrees(self) -> bool:
        """Whether the two intervals meet."""
        margin = 1e-9 * abs(self.printed)
        return (
            self.low <= self.printed + self.rounding + margin
            and self.high >= self.printed - self.rounding - margin
        )

    @property
    def relative_difference(self) -> float:
        """(derived - printed) / printed."""
        return (self.derived - self.printed) / self.printed


_Formula = Callable[..., float]
_Row = tuple[str, str, tuple[str, ...], _Formula, str]

_SQUARE = "δ² printed for δ in eq. 3.32; with the right ζ, c is larger by 1/δ"


def recomputed(parameters: ParameterSet = _ALL) -> tuple[Recomputed, ...]:
    """Return every result of chapter 3 that its printed data determine."""
    return tuple(_result(parameters, row) for row in _rows())


def _result(parameters: ParameterSet, row: _Row) -> Recomputed:
    quantity, equation, names, formula, cause = row
    printed = parameters.find(quantity)
    data = [parameters.find(name) for name in names]
    known = [_known(parameter) for parameter in data]
    ends = [(value - rounding, value + rounding) for value, rounding in known]
    corners = [formula(*corner) for corner in product(*ends)]
    value, rounding = _known(printed)
    return Recomputed(
        quantity=quantity,
        equation=equation,
        printed=value,
        rounding=rounding,
        unit=printed.unit,
        derived=formula(*(value for value, _ in known)),
        low=min(corners),
        high=max(corners),
        cause=cause,
    )


def _known(parameter: Parameter) -> tuple[float, float]:
    """Return a parameter's value and rounding, or refuse."""
    if parameter.value is None or parameter.rounding is None:
        raise CharacterisationError(
            f"{parameter.name!r} has no value or no rounding interval.",
            (parameter.name,),
            "Give both: rounding=0.0 says that the value is exact.",
        )
    return parameter.value, parameter.rounding


def _rows() -> Iterator[_Row]:
    yield from _static_rows()
    for part in ("upperleg", "lowerleg", "lowerleg_total"):
        yield from _swing_rows(part)
    yield from _mass_rows()
    yield from _encoder_rows()


def _static_rows() -> Iterator[_Row]:
    def radius(n: float, E: float, length: float, safety: float, force: float) -> float:
        column = RoundColumn(length=length, youngs_modulus=E, end_factor=n)
        return column.smallest_radius(force, safety=safety)

    def link_mass(
        length: float, width: float, h: float, E: float, frequency: float
    ) -> float:
        strip = Cantilever(length=length, width=width, thickness=h, youngs_modulus=E)
        return equivalent_mass(strip.tip_stiffness, frequency=frequency)

    yield (
        "r_tendon_min",
        "eq. 3.5",
        ("n_tendon", "E_tendon", "L_tendon", "safety_tendon", "F_tendon_max"),
        radius,
        "",
    )
    yield (
        "slope_difference",
        "section 3.1.2",
        ("slope_least_squares", "slope_errors_in_variables"),
        lambda squares, variables: 1 - squares / variables,
        "",
    )
    yield (
        "m_eq",
        "eq. 3.19",
        ("L_link", "b_link", "h_link", "E_tendon", "f_1"),
        link_mass,
        "stiffness from the strip's drawn size, with the tendons' Young's modulus",
    )


def _swing_rows(part: str) -> Iterator[_Row]:
    of = {
        "upperleg": ("m_upperleg_total", "L_cm_upperleg_total", "I_upperleg_total"),
        "lowerleg": ("m_lowerleg", "L_cm_lowerleg", "I_lowerleg"),
        "lowerleg_total": (
            *("m_lowerleg_total", "L_cm_lowerleg_total", "I_lowerleg_total"),
        ),
    }
    mass, centre, inertia = of[part]
    friction = {"upperleg": "c_hip", "lowerleg": "c_knee", "lowerleg_total": "c_tot"}[
        part
    ]
    delta, omega, zeta = f"delta_{part}", f"omega_{part}", f"zeta_{part}"
    yield (
        omega,
        "eq. 3.31",
        (f"f_{part}", delta),
        lambda f, d: natural_frequency(f, decrement=d),
        "",
    )
    yield zeta, "eq. 3.32", (delta,), printed_damping_factor, ""
    yield zeta, "eq. 3.32", (delta,), damping_factor, _SQUARE
    yield (
        inertia,
        "eq. 3.28",
        (mass, centre, "g", omega),
        lambda m, x, g, w: m * g * x / w**2,
        "",
    )
    yield (
        friction,
        "eq. 3.29",
        (zeta, omega, inertia),
        lambda z, w, i: 2 * z * w * i,
        "",
    )
    yield (
        friction,
        "eq. 3.29",
        (delta, omega, inertia),
        lambda d, w, i: 2 * damping_factor(d) * w * i,
        _SQUARE,
    )


def _mass_rows() -> Iterator[_Row]:
    def centre(torque: float, mass: float, gravity: float) -> float:
        return centre_of_mass(torque, mass=mass, gravity=gravity)

    def with_rest(mass: float, x: float, total: float) -> float:
        return joint_centre([(mass, x), (total - mass, 0.0)])

    missing = "T/(m g), not I/m or T/m as section 3.3 writes"
    for part in ("upperleg", "lowerleg"):
        own = f"L_cm_{part}"
        yield own, "section 3.3", (f"T_{part}", f"m_{part}", "g"), centre, missing
        masses = (f"m_{part}", own, f"m_{part}_total")
        yield f"{own}_total", "eq. 3.33", masses, with_rest, ""
    yield (
        "I_upperleg",
        "section 3.3.3",
        ("I_upperleg_total", "I_gear"),
        lambda total, gear: total - 2 * gear,
        "",
    )
    yield (
        "c_gear",
        "section 3.3.4",
        ("c_tot", "c_knee"),
        lambda total, knee: total - knee,
        "",
    )


def _encoder_rows() -> Iterator[_Row]:
    def rate(step: float, clock: float, frame: float) -> float:
        return PwmEncoder(step=step, clock=clock, frame=frame).frame_rate

    def damped(cutoff: float, term: float, noise: float) -> float:
        pair = ButterworthPair(cutoff=cutoff, damping_term=term)
        return pair.attenuation(2 * math.pi * noise)

    yield (
        "f_pwm",
        "section 3.4",
        ("encoder_step", "encoder_clock", "encoder_frame"),
        rate,
        "",
    )
    yield "f_noise", "section 3.4", ("f_sampling",), lambda f: f / 3, ""
    term = "filter_damping_term"
    yield (
        "filter_attenuation",
        "eq. 3.34",
        ("omega_filter", term, "f_noise"),
        damped,
        "eq. 3.34 divides by 25 rad/s where the text says 25 Hz",
    )
    yield (
        "filter_attenuation",
        "eq. 3.34",
        ("f_filter", term, "f_noise"),
        lambda f, d, noise: damped(2 * math.pi * f, d, noise),
        "25 Hz as in the text; 60 dB is asked for and needs 23.7 Hz",
    )
