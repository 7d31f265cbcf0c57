"""Printed numbers that only the audit needs: stated in passing, used nowhere else."""

import math

from bondgraph import Assumed, Parameter, ParameterSet, Published

_UNIFORM = 1 / math.sqrt(3)


def _parameter(
    name: str, value: float, unit: str, rounding: float, where: str
) -> Parameter:
    return Parameter(
        name=name,
        value=value,
        unit=unit,
        std=rounding * _UNIFORM,
        rounding=rounding,
        source=Published(f"FlegX thesis, {where}"),
    )


AUDITED = ParameterSet(
    (
        _parameter("share_moving", 0.23, "1", 0.0, "eq. 3.19: of the link's mass"),
        _parameter("height_demanded", 0.05, "m", 0.005, "section 2.1.2: a 5 cm jump"),
        _parameter(
            "speed_demanded",
            40 * 2 * math.pi / 60,
            "rad/s",
            math.pi / 60,
            "section 2.1.2: greater than 40 rpm",
        ),
        _parameter("frequency_test", 1.43, "Hz", 0.005, "section 6.1: around 1.43 Hz"),
    )
)
"""What the audit compares beside the other sets."""

STEEL = Parameter(
    name="density_steel",
    value=7850.0,
    unit="kg/m^3",
    source=Assumed("structural steel; the thesis prints no density"),
)
"""For the mass of the tendons that section 3.3.4 does not print."""


_ONE_SLIP = "a worm inertia ten times as large, all else inside or near its rounding"


def _supposed(name: str, value: float, unit: str) -> Parameter:
    return Parameter(name=name, value=value, unit=unit, source=Assumed(_ONE_SLIP))


WORM_SLIP = ParameterSet(
    (
        _supposed("I_motor", 2.0907e-5, "kg*m^2"),
        _supposed("I_gearbox", 9.109e-7, "kg*m^2"),
        _supposed("I_worm", 3.0008e-4, "kg*m^2"),
        _supposed("I_gear", 4.811e-4, "kg*m^2"),
        _supposed("I_lowerleg", 0.012002, "kg*m^2"),
        _supposed("I_upperleg", 0.14313, "kg*m^2"),
        _supposed("I_gear_tendons", 3.146e-3, "kg*m^2"),
        _supposed("L", 0.30923, "m"),
    )
)
"""Another set that gives the four gains: the worm's inertia as a slip of ten."""
