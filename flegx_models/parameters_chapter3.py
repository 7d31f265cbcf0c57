"""The printed numbers of chapter 3, each with unit, rounding interval and source.

`CHAPTER_3` holds what the thesis prints and nothing inferred, results as well as data,
so that each result can be compared with what `flegx_models.characterisation` makes of
the data. ``rounding`` is half a unit of the last printed digit, the standard deviation
that of a value uniform on it; "around" in the thesis widens neither.
"""

import math

from bondgraph import Assumed, Parameter, ParameterSet, Published

_THESIS = "FlegX thesis"
_UNIFORM = 1 / math.sqrt(3)

_Row = tuple[str, float, str, float, str]

_GIVEN: tuple[_Row, ...] = (
    # Tendons, section 3.1.1.
    ("T_knee_max", 70.0, "N*m", 0.5, "section 3.1.1: around 70 N·m"),
    ("theta_knee_max", math.radians(60), "rad", math.radians(0.5), "section 3.1.1"),
    ("F_tendon_max", 2.5e3, "N", 50.0, "eq. 3.2"),
    ("n_tendon", 1.0, "1", 0.0, "eq. 3.3: pivoted at both ends"),
    ("E_tendon", 200e9, "Pa", 0.5e9, "eq. 3.3"),
    ("L_tendon", 0.300, "m", 0.5e-3, "eq. 3.3: including the terminals"),
    ("safety_tendon", 1.8, "1", 0.0, "section 3.1.1: C_FS, chosen"),
    ("r_tendon_min", 4.0e-3, "m", 0.05e-3, "eq. 3.5"),
    ("r_tendon", 4.0e-3, "m", 0.0, "section 3.1.1: 8 mm bars"),
    # Flexible link and strain gauge, sections 2.1.2, 2.1.3 and 3.1.2.
    ("L_link", 0.250, "m", 0.5e-3, "section 2.1.1"),
    ("b_link", 0.070, "m", 0.5e-3, "section 2.1.1"),
    ("h_link", 0.003, "m", 0.5e-3, "section 2.1.1"),
    ("K_s", 2.080, "1", 0.005 * 2.080, "section 2.1.3: 2.080 ± 0.5 %"),
    ("R_gauge", 120.0, "ohm", 0.003 * 120.0, "section 2.1.3: 120.0 Ω ± 0.3 %"),
    ("x_load", 0.243, "m", 0.5e-3, "section 3.1.2"),
    ("x_laser", 0.2385, "m", 0.05e-3, "section 3.1.2"),
    ("F_bench", 95.16, "N", 0.005, "section 3.1.2"),
    ("rotation_per_force", 1.10e-4, "rad/N", 0.005e-4, "section 3.1.2"),
    ("slope_least_squares", 17.86, "N/V", 0.005, "section 3.1.2, after eq. 3.18"),
    ("offset_least_squares", -0.05, "N", 0.005, "section 3.1.2, after eq. 3.18"),
    ("slope_set_membership", 17.92, "N/V", 0.005, "section 3.1.2, figure 3.10"),
    ("offset_set_membership", -0.07, "N", 0.005, "section 3.1.2, figure 3.10"),
    ("slope_errors_in_variables", 17.92, "N/V", 0.005, "section 3.1.2, figure 3.12"),
    ("offset_errors_in_variables", -0.07, "N", 0.005, "section 3.1.2, figure 3.12"),
    ("slope_difference", 0.0033, "1", 0.5e-4, "section 3.1.2: least squares, 0.33 %"),
    # Link dynamics, section 3.1.3; the measured ones in steps of 5 Hz.
    ("f_1", 35.0, "Hz", 2.5, "table 3.2"),
    ("f_2", 210.0, "Hz", 2.5, "table 3.2"),
    ("f_3", 585.0, "Hz", 2.5, "table 3.2"),
    ("f_1_accelerometer", 30.0, "Hz", 2.5, "table 3.1"),
    ("f_2_accelerometer", 195.0, "Hz", 2.5, "table 3.1"),
    ("f_3_accelerometer", 565.0, "Hz", 2.5, "table 3.1"),
    ("f_1_fem", 39.0, "Hz", 0.5, "table 3.3"),
    ("f_2_fem", 241.0, "Hz", 0.5, "table 3.3"),
    ("f_3_fem", 676.0, "Hz", 0.5, "table 3.3"),
    ("f_1_expected", 37.26, "Hz", 0.005, "eq. 3.20"),
    ("added_mass_share", 0.23, "1", 0.005, "eq. 3.19"),
    ("m_eq", 0.13, "kg", 0.005, "section 3.1.3, before eq. 3.21"),
    ("f_1_corrected", 30.19, "Hz", 0.005, "eq. 3.21"),
    # Torque sensors, sections 3.1.4 and 3.2.1; slopes in N·m per volt.
    ("knee_slope", 47.69, "N*m/V", 0.005, "eq. 3.22"),
    ("knee_offset", -1.56, "N*m", 0.005, "eq. 3.22"),
    ("knee_slope_rising", 48.03, "N*m/V", 0.005, "eq. 3.23"),
    ("knee_offset_rising", -2.46, "N*m", 0.005, "eq. 3.23"),
    ("knee_slope_falling", 47.79, "N*m/V", 0.005, "eq. 3.23"),
    ("knee_offset_falling", -0.60, "N*m", 0.005, "eq. 3.23"),
    ("hip_slope_rising", -44.37, "N*m/V", 0.005, "eq. 3.24"),
    ("hip_offset_rising", -1.74, "N*m", 0.005, "eq. 3.24"),
    ("hip_slope_falling", -42.16, "N*m/V", 0.005, "eq. 3.24"),
    ("hip_offset_falling", 1.96, "N*m", 0.005, "eq. 3.24"),
    ("hip_slope_transition", -54.0, "N*m/V", 0.5, "eq. 3.24"),
    ("V_transition", 0.2, "V", 0.0, "section 3.2.1: chosen"),
    # Physical pendulums, sections 3.3.3 and 3.3.4.
    ("m_upperleg_total", 2.97, "kg", 0.005, "section 3.3.3"),
    ("m_upperleg", 1.93, "kg", 0.005, "section 3.3.3"),
    ("T_upperleg", 2.48, "N*m", 0.005, "section 3.3.3"),
    ("L_cm_upperleg", 0.13, "m", 0.005, "section 3.3.3"),
    ("L_cm_upperleg_total", 8.40e-2, "m", 0.005e-2, "eq. 3.33"),
    ("delta_upperleg", 0.37, "1", 0.005, "section 3.3.3"),
    ("f_upperleg", 1.01, "Hz", 0.005, "section 3.3.3"),
    ("omega_upperleg", 6.38, "rad/s", 0.005, "section 3.3.3"),
    ("zeta_upperleg", 2.18e-2, "1", 0.005e-2, "section 3.3.3"),
    ("I_upperleg_total", 6.02e-2, "kg*m^2", 0.005e-2, "section 3.3.3"),
    ("I_upperleg", 5.93e-2, "kg*m^2", 0.005e-2, "section 3.3.3"),
    ("c_hip", 1.67e-2, "N*m*s", 0.005e-2, "section 3.3.3"),
    ("m_lowerleg", 0.61, "kg", 0.005, "section 3.3.4"),
    ("T_lowerleg", 0.6, "N*m", 0.05, "section 3.3.4"),
    ("L_cm_lowerleg", 0.10, "m", 0.005, "section 3.3.4"),
    ("delta_lowerleg", 0.13, "1", 0.005, "section 3.3.4"),
    ("f_lowerleg", 1.13, "Hz", 0.005, "section 3.3.4"),
    ("omega_lowerleg", 7.08, "rad/s", 0.005, "section 3.3.4"),
    ("zeta_lowerleg", 2.50e-3, "1", 0.005e-3, "section 3.3.4"),
    ("I_lowerleg", 1.20e-2, "kg*m^2", 0.005e-2, "section 3.3.4"),
    ("c_knee", 4.23e-4, "N*m*s", 0.005e-4, "section 3.3.4"),
    ("m_lowerleg_total", 1.38, "kg", 0.005, "section 3.3.4"),
    ("L_cm_lowerleg_total", 4.43e-2, "m", 0.005e-2, "section 3.3.4"),
    ("delta_lowerleg_total", 0.27, "1", 0.005, "section 3.3.4"),
    ("f_lowerleg_total", 1.10, "Hz", 0.005, "section 3.3.4"),
    ("omega_lowerleg_total", 6.91, "rad/s", 0.005, "section 3.3.4"),
    ("zeta_lowerleg_total", 1.20e-2, "1", 0.005e-2, "section 3.3.4"),
    ("I_lowerleg_total", 1.26e-2, "kg*m^2", 0.005e-2, "section 3.3.4"),
    ("c_tot", 2.08e-3, "N*m*s", 0.005e-3, "section 3.3.4"),
    ("c_gear", 1.66e-3, "N*m*s", 0.005e-3, "section 3.3.4"),
    # Encoder, section 3.4.
    ("encoder_step", math.radians(0.088), "rad", math.radians(5e-4), "section 3.4"),
    ("encoder_clock", 444e-9, "s", 0.5e-9, "section 3.4: typical"),
    ("encoder_frame", 4119.0, "1", 0.0, "section 3.4: clock periods per frame"),
    ("f_pwm", 547.0, "Hz", 0.5, "section 3.4"),
    ("encoder_noise", 0.2, "rad", 0.05, "section 3.4: peak to peak"),
    ("f_sampling", 400.0, "Hz", 0.0, "section 3.4: chosen"),
    ("f_noise", 133.0, "Hz", 0.5, "section 3.4: about a third of the sampling"),
    ("filter_attenuation", 60.0, "1", 0.5, "section 3.4: dB wanted at 133 Hz"),
    ("f_filter", 25.0, "Hz", 0.0, "section 3.4 (text)"),
    ("omega_filter", 25.0, "rad/s", 0.0, "eq. 3.34 (formula)"),
    ("filter_damping_term", 1.414, "1", 0.0005, "eq. 3.34: 2ζ of each section"),
)


def _parameter(row: _Row) -> Parameter:
    name, value, unit, rounding, where = row
    return Parameter(
        name=name,
        value=value,
        unit=unit,
        std=rounding * _UNIFORM,
        rounding=rounding,
        source=Published(f"{_THESIS}, {where}"),
    )


CHAPTER_3 = ParameterSet(
    (
        *map(_parameter, _GIVEN),
        Parameter(
            name="g",
            value=9.81,
            unit="m/s^2",
            std=0.0,
            rounding=0.0,
            source=Assumed("the thesis names g and prints no value"),
        ),
    )
)
"""The numbers of chapter 3 as printed."""
