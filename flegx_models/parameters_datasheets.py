"""Tables 2.1 to 2.3: the data sheets of motor, gearhead and worm gear, row by row.

`DATASHEETS` holds them in SI units with half a unit of the last printed digit as
rounding interval; counts and ratios of teeth are exact. The four inertias and two
ratios that the models use stand in `flegx_models.parameters.PRINTED` as well.
"""

import math

from bondgraph import Parameter, ParameterSet, Published

_UNIFORM = 1 / math.sqrt(3)
_RPM = 2 * math.pi / 60

_Row = tuple[str, float, str, float]

_MOTOR: tuple[_Row, ...] = (
    ("motor_nominal_voltage", 48.0, "V", 0.5),
    ("motor_no_load_speed", 10700 * _RPM, "rad/s", 50 * _RPM),
    ("motor_no_load_current", 0.656, "A", 0.5e-3),
    ("motor_nominal_speed", 10000 * _RPM, "rad/s", 50 * _RPM),
    ("motor_nominal_torque", 0.316, "N*m", 0.5e-3),
    ("motor_nominal_current", 7.94, "A", 0.005),
    ("motor_stall_torque", 6.110, "N*m", 5e-3),
    ("motor_stall_current", 143.0, "A", 0.5),
    ("motor_maximum_efficiency", 0.87, "1", 0.005),
    ("motor_resistance", 0.336, "ohm", 0.5e-3),
    ("motor_inductance", 0.149e-3, "H", 0.5e-6),
    ("K_m", 42.7e-3, "N*m/A", 0.05e-3),
    ("motor_speed_constant", 224 * _RPM, "rad/s/V", 0.5 * _RPM),
    ("motor_speed_torque_gradient", 1.76e3 * _RPM, "rad/s/N/m", 5 * _RPM),
    ("motor_time_constant", 3.85e-3, "s", 0.005e-3),
    ("I_motor", 209e-7, "kg*m^2", 0.5e-7),
)

_GEARHEAD: tuple[_Row, ...] = (
    ("K_gearbox", 26.0, "1", 0.0),
    ("gearhead_stages", 2.0, "1", 0.0),
    ("gearhead_continuous_torque", 7.5, "N*m", 0.05),
    ("gearhead_intermittent_torque", 11.3, "N*m", 0.05),
    ("gearhead_continuous_speed", 8000 * _RPM, "rad/s", 50 * _RPM),
    ("gearhead_intermittent_speed", 8000 * _RPM, "rad/s", 50 * _RPM),
    ("gearhead_maximum_efficiency", 0.81, "1", 0.005),
    ("I_gearbox", 9.1e-7, "kg*m^2", 0.05e-7),
)

_WORM: tuple[_Row, ...] = (
    ("K_worm_gear", 9.67, "1", 0.005),
    ("worm_lead_angle", math.radians(13 + 51 / 60), "rad", math.radians(0.5 / 60)),
    ("worm_module", 2.5e-3, "m", 0.0),
    ("worm_threads", 3.0, "1", 0.0),
    ("worm_pitch_diameter", 31.29e-3, "m", 0.005e-3),
    ("worm_tip_diameter", 36.29e-3, "m", 0.005e-3),
    ("gear_teeth", 29.0, "1", 0.0),
    ("gear_pitch_diameter", 74.71e-3, "m", 0.005e-3),
    ("gear_maximum_diameter", 82e-3, "m", 0.5e-3),
    ("I_worm", 3.00e-5, "kg*m^2", 0.005e-5),
    ("I_gear", 4.81e-4, "kg*m^2", 0.005e-4),
)


def _parameter(row: _Row, table: str) -> Parameter:
    name, value, unit, rounding = row
    return Parameter(
        name=name,
        value=value,
        unit=unit,
        std=rounding * _UNIFORM,
        rounding=rounding,
        source=Published(f"FlegX thesis, {table}"),
    )


DATASHEETS = ParameterSet(
    (
        *(_parameter(row, "Table 2.1") for row in _MOTOR),
        *(_parameter(row, "Table 2.2") for row in _GEARHEAD),
        *(_parameter(row, "Table 2.3") for row in _WORM),
    )
)
"""The data sheets as printed."""
