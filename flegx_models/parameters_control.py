"""The printed numbers of sections 4.4 and 4.5 and of chapters 5 and 6, with sources.

`CONTROL` holds what the thesis prints about motor driver, loop, controllers, gravity
feed-forward and jump, results as well as data, and two numbers inferred from printed
results, whose sources say so. `CHOSEN` holds the
few numbers that a simulation of the jump needs and the thesis does not print: each is
an assumption with its reason, and none was adjusted to make a result appear.
"""

import math

from bondgraph import Assumed, Parameter, ParameterSet, Published, Reconciled

_THESIS = "FlegX thesis"
_UNIFORM = 1 / math.sqrt(3)

_Row = tuple[str, float, str, float, str]

_MOTOR: tuple[_Row, ...] = (
    ("k_driver", 0.20, "A", 0.005, "eq. 4.36: per % of duty cycle"),
    ("zero_driver", 4403.0, "rad/s", 0.5, "eq. 4.36"),
    ("fast_pole_driver", 1.61e6, "rad/s", 0.005e6, "eq. 4.36"),
    ("slow_pole_driver", 4201.0, "rad/s", 0.5, "eq. 4.36"),
    ("mean_duty", 50.0, "1", 0.5, "section 4.4: % removed from the input"),
    ("fast_pole_loop", 1.16e6, "rad/s", 0.005e6, "eq. 5.10, 5.14, 5.18, 5.22"),
)

_GRAVITY: tuple[_Row, ...] = (
    ("gravity_hip_flight", 4.26, "N*m", 0.005, "eq. 5.5"),
    ("gravity_knee_flight", 0.60, "N*m", 0.005, "eq. 5.5"),
    ("gravity_hip_stance", -25.59, "N*m", 0.005, "eq. 5.8"),
    ("gravity_knee_stance", -29.24, "N*m", 0.005, "eq. 5.8"),
    ("gravity_hip_counterweight", -10.87, "N*m", 0.005, "eq. 6.5"),
    ("gravity_knee_counterweight", -14.53, "N*m", 0.005, "eq. 6.5"),
    ("m_counterweight", 5.0, "kg", 0.5, "section 6.2"),
)

# Loops: numerator in rad²/s³ per unit, friction pole, printed figures.
_LOOPS: tuple[_Row, ...] = (
    ("numerator_lowerleg_flight", 1.14e7, "1/s^3", 0.005e7, "eq. 5.10"),
    ("numerator_upperleg_flight", 1.05e7, "1/s^3", 0.005e7, "eq. 5.14"),
    ("numerator_lowerleg_stance", 6.99e6, "1/s^3", 0.005e6, "eq. 5.18"),
    ("numerator_upperleg_stance", 6.85e6, "1/s^3", 0.005e6, "eq. 5.22"),
    ("crossover_lowerleg_flight", 10.17, "rad/s", 0.005, "section 5.2.1, figure 5.4"),
    ("crossover_upperleg_flight", 9.28, "rad/s", 0.005, "section 5.2.1, figure 5.6"),
    ("crossover_lowerleg_stance", 10.67, "rad/s", 0.005, "section 5.2.2, figure 5.8"),
    ("crossover_upperleg_stance", 9.58, "rad/s", 0.005, "section 5.2.2, figure 5.10"),
    ("turnover_lowerleg_flight", 45.45, "rad/s", 0.005, "section 5.2.1, figure 5.4"),
    ("turnover_upperleg_flight", 67.25, "rad/s", 0.005, "section 5.2.1, figure 5.6"),
    ("turnover_lowerleg_stance", 45.45, "rad/s", 0.005, "section 5.2.2, figure 5.8"),
    ("turnover_upperleg_stance", 65.75, "rad/s", 0.005, "section 5.2.2, figure 5.10"),
    ("margin_lowerleg_flight", math.radians(68.06), "rad", math.radians(0.005), "§5.2"),
    ("margin_upperleg_flight", math.radians(70.48), "rad", math.radians(0.005), "§5.2"),
    ("margin_lowerleg_stance", math.radians(67.00), "rad", math.radians(0.005), "§5.2"),
    ("margin_upperleg_stance", math.radians(69.54), "rad", math.radians(0.005), "§5.2"),
    ("friction_growth", 10.0, "1", 0.0, "section 5.2: the example of figure 5.5"),
    ("damping_prototype", 0.6, "1", 0.05, "section 5.2.1"),
)

# Controllers K (s + z) / (1 + s/p): gain in A·s/rad, zero (its digits as
# printed) and pole in rad/s.
_ControllerRow = tuple[str, float, str, float, str]

_CONTROLLERS: tuple[_ControllerRow, ...] = (
    ("lowerleg_flight", 1.4, "0.18", 50.0, "eq. 5.12"),
    ("upperleg_flight", 1.4, "0.12", 40.0, "eq. 5.16"),
    ("lowerleg_stance", 2.4, "0.18", 50.0, "eq. 5.20"),
    ("upperleg_stance", 2.2, "0.3", 40.0, "eq. 5.24"),
    ("lowerleg_flight_modified", 1.4, "1.8", 50.0, "section 5.2.1"),
    ("upperleg_flight_modified", 1.4, "1.2", 40.0, "section 5.2.1"),
    ("lowerleg_stance_modified", 2.4, "1.8", 50.0, "section 5.2.2"),
    ("upperleg_stance_modified", 2.2, "3.0", 40.0, "section 5.2.2"),
    ("lowerleg_flight_tuned", 1.5, "2.5", 50.0, "eq. 6.1"),
    ("upperleg_flight_tuned", 1.6, "2.5", 40.0, "eq. 6.2"),
    ("lowerleg_stance_tuned", 2.5, "3", 50.0, "eq. 6.3"),
    ("upperleg_stance_tuned", 2.6, "6", 40.0, "eq. 6.4"),
)

_JUMP: tuple[_Row, ...] = (
    ("period_test", 0.7, "s", 0.05, "section 6.1: T_r"),
    ("swing_lowerleg", math.radians(20), "rad", math.radians(0.5), "section 6.1"),
    ("swing_upperleg", math.radians(10), "rad", math.radians(0.5), "section 6.1"),
    ("hip_test", -math.radians(45), "rad", math.radians(0.5), "section 6.1.1, middle"),
    ("knee_test", math.radians(80), "rad", math.radians(0.5), "section 6.1.1, middle"),
    ("hip_landing", -math.pi / 6, "rad", 0.0, "section 6.2"),
    ("knee_landing", math.pi / 3, "rad", 0.0, "section 6.2"),
    ("hip_speed", 0.75, "rad/s", 0.005, "section 6.2: opposite at start and end"),
    ("knee_speed", 1.5, "rad/s", 0.05, "section 6.2: double that of the hip"),
    ("squat_time", 0.4, "s", 0.05, "section 6.2"),
    ("flight_time", 0.2, "s", 0.05, "section 6.2: half the squat period"),
    ("driver_current", 10.0, "A", 0.0, "section 2.1.4: ESCON 70/10, 10 A"),
    ("sampling", 400.0, "Hz", 0.0, "section 3.4"),
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


def _inferred(name: str, value: float, unit: str, half: float, why: str) -> Parameter:
    return Parameter(
        name=name,
        value=value,
        unit=unit,
        std=half * _UNIFORM,
        rounding=half,
        source=Reconciled(why),
    )


def _controller(row: _ControllerRow) -> tuple[Parameter, ...]:
    name, gain, zero, pole, where = row
    half = 10.0 ** -len(zero.partition(".")[2]) / 2
    return tuple(
        map(
            _parameter,
            (
                (f"K_{name}", gain, "A*s/rad", 0.05, where),
                (f"z_{name}", float(zero), "rad/s", half, where),
                (f"p_{name}", pole, "rad/s", 0.5, where),
            ),
        )
    )


CONTROL = ParameterSet(
    (
        *map(_parameter, (*_MOTOR, *_GRAVITY, *_LOOPS, *_JUMP)),
        *(parameter for row in _CONTROLLERS for parameter in _controller(row)),
        _inferred("L_gravity", 0.30, "m", 0.005, "eq. 5.4 prints 4.26, which needs it"),
        _inferred(
            "m_support_gravity",
            7.6,
            "kg",
            0.05,
            "eq. 5.7 prints 25.59 and 29.24, which need it; section 3.3.1 weighs 6.6.",
        ),
    )
)
"""The numbers of sections 4.4 and 4.5 and of chapters 5 and 6."""


def _chosen(name: str, value: float, unit: str, reason: str) -> Parameter:
    return Parameter(name=name, value=value, unit=unit, source=Assumed(reason))


CHOSEN = ParameterSet(
    (
        _chosen("mu_ground", 0.8, "1", "rubber on a floor; a smaller one lets it slip"),
        _chosen("creep", 2e5, "N*s/m", "grip of the foot before it slips, smoothed"),
        _chosen("rope_stiffness", 1e5, "N/m", "2 m of a steel cable of 2 mm"),
        _chosen("rope_damping", 100.0, "N*s/m", "a tenth of critical, with 5 kg on it"),
        _chosen("torque_noise", 0.05, "N*m", "noise of the knee torque sensor, rms"),
        _chosen("torque_band", 2.0, "N*m", "change that the phase detection trusts"),
        _chosen("substeps", 10.0, "1", "integration steps per sampling period"),
        _chosen("sampling_bench", 2e4, "Hz", "rate of a current recording, made up"),
        _chosen("sampling_fast", 1e7, "Hz", "a rate that shows the driver's fast pole"),
        _chosen("current_noise", 2e-3, "A", "noise of a current recording, rms"),
    )
)
"""What the simulations need and the thesis does not print."""
