"""Tables 2.1 to 2.3: the rows of the data sheets that follow from other rows.

A direct-current motor has a torque constant, a resistance and an inertia; the rest of
Table 2.1 follows. A worm gear has a normal module, a lead angle and numbers of teeth.
"""

from collections.abc import Iterator

import sympy

from flegx_models.audit.records import Row, row_of
from flegx_models.parameters_datasheets import DATASHEETS

_RPM = 2 * sympy.pi / 60
_K, _R, _V, _I0 = sympy.symbols(
    "K_m motor_resistance motor_nominal_voltage motor_no_load_current", real=True
)
_STALL, _TORQUE, _INERTIA = sympy.symbols(
    "motor_stall_current motor_nominal_torque I_motor", real=True
)
_TEETH, _THREADS, _MODULE, _LEAD, _WORM = sympy.symbols(
    "gear_teeth worm_threads worm_module worm_lead_angle worm_pitch_diameter",
    real=True,
)
_rpm = ("rpm", float(_RPM))
_mm = ("mm", 1e-3)

_STRAIGHT = "the straight line through no-load and stall point; a rating, not a result"
_MOTOR = (
    ("motor_stall_current", _V / _R, "stall current", ("A", 1.0), ""),
    ("motor_stall_torque", _K * _STALL, "stall torque", ("N·m", 1.0), ""),
    ("motor_speed_constant", 1 / _K, "speed constant", ("rpm/V", float(_RPM)), ""),
    (
        "motor_speed_torque_gradient",
        _R / _K**2,
        "speed/torque gradient",
        ("rpm/mNm", 1e3 * float(_RPM)),
        "",
    ),
    (
        "motor_time_constant",
        _R * _INERTIA / _K**2,
        "mechanical time constant",
        ("ms", 1e-3),
        "",
    ),
    ("motor_no_load_speed", (_V - _R * _I0) / _K, "no load speed", _rpm, ""),
    (
        "motor_nominal_speed",
        (_V - _R * _I0) / _K - _R / _K**2 * _TORQUE,
        "nominal speed",
        _rpm,
        _STRAIGHT,
    ),
    (
        "motor_nominal_current",
        _TORQUE / _K + _I0,
        "nominal current",
        ("A", 1.0),
        _STRAIGHT,
    ),
    (
        "motor_maximum_efficiency",
        (1 - sympy.sqrt(_I0 / _STALL)) ** 2,
        "maximum efficiency",
        ("1", 1.0),
        "",
    ),
)

_GEAR_CAUSE = "module 2.5 taken as the normal one; off by a few hundredths of a mm"
_WORM_GEAR = (
    ("K_worm_gear", _TEETH / _THREADS, "reduction", ("1", 1.0), ""),
    (
        "worm_pitch_diameter",
        _THREADS * _MODULE / sympy.sin(_LEAD),
        "pitch diameter of the worm",
        _mm,
        _GEAR_CAUSE,
    ),
    ("worm_tip_diameter", _WORM + 2 * _MODULE, "tip diameter", _mm, ""),
    (
        "gear_pitch_diameter",
        _TEETH * _MODULE / sympy.cos(_LEAD),
        "pitch diameter of the gear",
        _mm,
        _GEAR_CAUSE,
    ),
)


def rows() -> Iterator[Row]:
    """Yield the rows of chapter 2."""
    for table, entries in (("Table 2.1", _MOTOR), ("Table 2.3", _WORM_GEAR)):
        for name, formula, quantity, unit, cause in entries:
            yield row_of(
                DATASHEETS[name],
                formula,
                DATASHEETS,
                place=(2, table),
                quantity=quantity,
                unit=unit,
                cause=cause,
            )
