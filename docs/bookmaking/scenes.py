"""For every law a machine, a drive and numbers with which its signature is seen.

A scene says at which place of which machine the law is left out, what drives the
machine, which output tells it, and which two signals draw the law. ``*`` stands for the
element that the law adds; ``law`` for the law itself. The numbers are chosen so that
the eye sees the law; they mean nothing else.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph import FinishedGraph
from bookmaking import machines

Array = NDArray[np.float64]
Drive = Callable[[float], float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Where and how one law is looked at.

    Parameters
    ----------
    machine, place
        Who leaves it out, and where it belongs.
    values
        Of its fitted parameters, without the name of the place.
    drive
        Every input as a function of time.
    output
        The measurement that shows it.
    across, up
        The signals that draw the law.
    seconds, step
        How long, and how finely.
    labels
        What the axes of the law are called, where that is not the quantity's own word.
    left
        The letter of what the law gives, where it is not what is drawn upwards.
    written
        The law as LaTeX, where its expression is not to be read.
    cloud
        Whether the law is drawn as samples, because its curve would jump.
    """

    machine: Callable[[], FinishedGraph]
    place: str
    values: Mapping[str, float]
    drive: Mapping[str, Drive]
    output: str
    across: str
    up: str = "effort(*)"
    seconds: float = 10.0
    step: float = 0.01
    labels: tuple[str, str] = ("", "")
    left: str = ""
    written: str = ""
    cloud: bool = False


def _wave(size: float, slow: float = 1.0, fast: float = 2.7) -> Drive:
    """Return a sum of two sines."""
    return lambda t: size * (0.7 * np.sin(slow * t) + 0.5 * np.sin(fast * t))


def _pulse(height: float, until: float, begin: float = 0.0) -> Drive:
    """Return `height` between two instants, and 0 else."""
    return lambda t: height if begin <= t < until else 0.0


def _steps(*heights: float, every: float) -> Drive:
    """Return one height after the other."""
    return lambda t: heights[min(int(t / every), len(heights) - 1)]


def _swept(size: float, low: float, high: float, seconds: float) -> Drive:
    """Return a sine whose rate grows from `low` to `high` rad/s."""
    return lambda t: size * np.sin((low + (high - low) * t / (2 * seconds)) * t)


def _slow(size: float, rate: float = 0.8) -> Drive:
    """Return a slow sine."""
    return lambda t: size * np.sin(rate * t)


_CART = {"machine": machines.cart, "place": "carriage", "output": "speed"}
_PUSHED = {**_CART, "drive": {"force": _wave(10.0)}, "across": "flow(carriage)"}
_RINGING = {
    "machine": machines.oscillator,
    "place": "carriage",
    "output": "position",
    "drive": {"force": _pulse(8.0, 0.7)},
}
_COMMANDED = {
    **_CART,
    "place": "force",
    "drive": {"force": _wave(10.0)},
    "across": "effort(force)",
    "up": "effort(*)",
    "labels": ("force commanded [N]", "force that acts [N]"),
    "left": r"u_{\mathrm{acts}}",
}
_READ = {
    **_CART,
    "place": "speed",
    "drive": {"force": _wave(10.0)},
    "across": "flow(carriage)",
    "up": "law",
    "labels": ("speed there is [m/s]", "speed read [m/s]"),
    "left": "y",
}
_TURNED = {
    "machine": machines.shaft,
    "place": "shaft",
    "output": "speed",
    "across": "displacement(shaft)",
    "up": "-effort(*)",
}
_FILLED = {
    "machine": machines.closed_tank,
    "place": "tank",
    "output": "pressure",
    "drive": {"inflow": _pulse(2.0, 3.0)},
    "across": "effort(tank)",
    "up": "flow(*)",
}

_BESIDE = {
    "machine": machines.two_axes,
    "place": "pan",
    "output": "tilt_angle",
    "drive": {"pan_torque": _pulse(1.0, 0.5), "tilt_torque": _pulse(0.0, 0.0)},
}

SCENES: Mapping[str, Scene] = {
    "ViscousFriction": Scene(
        **_RINGING, across="flow(carriage)", values={"viscous": 2.0}
    ),
    "CoulombFriction": Scene(
        **_RINGING, across="flow(carriage)", values={"coulomb": 1.0}
    ),
    "VoltageDrop": Scene(
        machine=machines.winding,
        place="winding",
        values={"drop": 0.8},
        drive={"voltage": _slow(3.0, 1.2)},
        output="current",
        across="flow(winding)",
    ),
    "LoadDependentFriction": Scene(
        machine=machines.worm_drive,
        place="motor",
        values={"mu": 0.25},
        drive={
            "torque": lambda t: 1.5 * np.sin(2.3 * t),
            "load": lambda t: 4.0 * np.sin(0.5 * t),
        },
        output="speed",
        across="effort(motor>gear)",
        cloud=True,
        seconds=14.0,
    ),
    "DirectionDependentFriction": Scene(
        **_PUSHED, values={"coulomb": 2.75, "asymmetry": 0.455}
    ),
    "DirectionDependentDamping": Scene(**_PUSHED, values={"damping_ahead": 4.0}),
    "StribeckFriction": Scene(
        **_CART,
        drive={"force": _wave(6.0)},
        across="flow(carriage)",
        values={"coulomb": 1.5, "stribeck_rise": 2.0, "stribeck_flow": 0.15},
    ),
    "QuadraticDrag": Scene(**_PUSHED, values={"quadratic": 2.0}),
    "ConstantBias": Scene(**_PUSHED, up="-effort(*)", values={"bias": -3.0}),
    "Gravity": Scene(
        **_TURNED,
        drive={"torque": lambda t: 0.35 * t},
        seconds=7.0,
        values={"gravity_sine": 1.2, "gravity_cosine": 0.0},
    ),
    "Spring": Scene(
        **{**_PUSHED, "across": "displacement(carriage)", "output": "position"},
        up="-effort(*)",
        values={"stiffness": 6.0, "bias": 0.0},
    ),
    "HardeningSpring": Scene(
        **{**_RINGING, "drive": {"force": _swept(4.0, 3.0, 9.0, 16.0)}},
        across="displacement(carriage)",
        up="-effort(*)",
        seconds=16.0,
        values={"cubic_stiffness": 60.0},
    ),
    "AddedInertia": Scene(**_PUSHED, up="momentum(*)", values={"added_inertia": 2.0}),
    "AddedCompliance": Scene(
        machine=machines.pipe,
        place="line",
        values={"added_compliance": 0.3},
        drive={"pump": _steps(0.0, 2.0, 1.0, 2.5, every=2.0)},
        output="pressure",
        across="effort(line)",
        up="displacement(*)",
        seconds=8.0,
    ),
    "StoreBehind": Scene(
        **{**_FILLED, "up": "effort(*)"},
        values={"second_capacity": 0.8, "fill_time": 2.0},
    ),
    "StoreAmid": Scene(
        machine=machines.two_tanks,
        place="pipe",
        values={"capacity_amid": 0.6},
        drive={"inflow": _pulse(2.0, 3.0)},
        output="lower_pressure",
        across="effort(*)",
        up="displacement(*)",
    ),
    "RelaxingSpring": Scene(
        **{**_RINGING, "drive": {"force": _steps(2.0, 0.0, -2.0, 0.0, every=3.0)}},
        across="displacement(carriage)",
        values={"relaxing_stiffness": 50.0, "relaxation_time": 0.3},
        seconds=12.0,
    ),
    "InducedCurrent": Scene(
        machine=machines.winding,
        place="winding",
        values={"induced_inductance": 0.2, "induced_time": 0.3},
        drive={"voltage": _steps(6.0, -6.0, 6.0, -6.0, every=1.0)},
        output="current",
        across="flow(*)",
        up="effort(*)",
        seconds=4.0,
    ),
    "Leak": Scene(**_FILLED, values={"leak": 0.15}),
    "Bypass": Scene(
        machine=machines.winding,
        place="inductance",
        values={"bypass_resistance": 4.0},
        drive={"voltage": _steps(6.0, -6.0, 6.0, -6.0, every=0.15)},
        output="current",
        across="flow(*)",
        up="effort(*)",
        left="e",
        seconds=0.6,
        step=0.0005,
    ),
    "SquareLaw": Scene(
        **{**_FILLED, "machine": machines.draining_tank},
        values={"outlet_flow": 1.3},
    ),
    "SquareRootOrifice": Scene(**_FILLED, values={"orifice": 1.0}),
    "Overflow": Scene(
        **{
            **_FILLED,
            "machine": machines.draining_tank,
            "drive": {"inflow": _pulse(2.0, 5.0)},
        },
        values={"overflow_level": 5.0, "overflow": 8.0},
    ),
    "Clamp": Scene(
        machine=machines.rail,
        place="rail",
        values={"overflow_level": 5.0, "overflow": 20.0},
        drive={"charger": _steps(2.0, 0.5, 1.8, 0.0, every=2.5)},
        output="voltage",
        across="effort(rail)",
        up="flow(*)",
    ),
    "OneWayPassage": Scene(
        machine=machines.two_tanks,
        place="friction",
        values={"one_way": 1.0, "opening": 0.3},
        drive={"inflow": _steps(1.5, -1.0, 1.5, -1.0, every=2.0)},
        output="lower_pressure",
        across="effort(friction)",
        up="flow(friction)",
    ),
    "Radiation": Scene(
        machine=machines.heated_block,
        place="block",
        written=(
            r"\mathrm{radiation} \left(\left(\frac{e + \mathrm{radiation}_"
            r"{\mathrm{zero}}}{293.15\,\mathrm{K}}\right)^4 - \left(\frac{"
            r"\mathrm{radiation}_{\mathrm{room}}}{293.15\,\mathrm{K}}\right)^4\right)"
        ),
        values={"radiation": 6.0, "radiation_room": 293.15},
        drive={"heater": _pulse(60.0, 400.0)},
        output="temperature",
        across="effort(block)",
        up="flow(*)",
        seconds=800.0,
        step=1.0,
    ),
    "EndStop": Scene(
        **_RINGING,
        across="displacement(carriage)",
        up="-effort(*)",
        values={
            "upper_stop": 0.12,
            "upper_stop_stiffness": 2000.0,
            "upper_stop_damping": 2000.0,
        },
        seconds=5.0,
        step=0.002,
    ),
    "SeriesCompliance": Scene(
        machine=machines.worm_drive,
        place="gear",
        values={"compliance": 0.15, "compliance_damping": 0.06},
        drive={"torque": _steps(1.0, -1.0, 1.0, every=2.0), "load": lambda t: 0.0},
        output="speed",
        across="displacement(*)",
        up="effort(*)",
        seconds=6.0,
        step=0.005,
    ),
    "FlexibleMode": Scene(
        **_CART,
        drive={"force": _steps(6.0, -6.0, 6.0, every=2.5)},
        across="displacement(mode_carriage_spring)",
        up="effort(mode_carriage_spring)",
        seconds=7.0,
        values={"mode_inertia": 0.6, "mode_frequency": 12.0, "mode_damping": 0.05},
    ),
    "Drag": Scene(**_BESIDE, across="flow(*)", values={"drag": 0.05}),
    "Tie": Scene(
        **_BESIDE,
        across="displacement(*)",
        up="-effort(*)",
        values={"stiffness": 1.0},
    ),
    "SharedInertia": Scene(
        **_BESIDE,
        across="flow(*)",
        up="momentum(*)",
        values={"inertia_of_sum": 0.03},
    ),
    "GyroscopicCoupling": Scene(
        **_BESIDE,
        across="flow(pan)",
        up="effort(gyroscopic_coupling_pan>tilt)",
        values={"gyration": 0.1},
        labels=("angular velocity of pan [rad/s]", "torque on tilt [N m]"),
    ),
    "Backlash": Scene(
        machine=machines.belt,
        place="spring",
        values={"half_gap": 0.15},
        drive={"force": _slow(6.0, 1.6)},
        output="far_position",
        across="displacement(spring)",
        up="effort(spring)",
    ),
    "DahlHysteresis": Scene(
        **{**_PUSHED, "across": "displacement(carriage)"},
        up="-effort(*)",
        values={"hysteresis": 4.0, "presliding": 0.15},
    ),
    "BoucWenHysteresis": Scene(
        **{**_PUSHED, "across": "displacement(carriage)"},
        up="-effort(*)",
        values={"hysteresis": 4.0, "presliding": 0.3, "hysteresis_skew": 0.8},
    ),
    "Cogging": Scene(
        **_TURNED,
        drive={"torque": lambda t: 0.12 * t},
        seconds=8.0,
        values={"cogging_sine": 0.25, "cogging_cosine": 0.0, "cogging_wave": 6.0},
    ),
    "Eccentricity": Scene(
        machine=machines.worm_drive,
        place="gear",
        values={"runout_sine_motor": 0.3, "runout_cosine_motor": 0.0},
        drive={"torque": lambda t: 0.05 * t, "load": lambda t: 1.0},
        output="speed",
        across="displacement(motor)",
        up="law",
        labels=("angle of the motor [rad]", "ratio"),
        left="K",
    ),
    "SaturatingInertia": Scene(
        machine=machines.winding,
        place="inductance",
        values={"saturation": 2000.0},
        drive={"voltage": lambda t: 6.0 * np.sin(40.0 * t)},
        output="current",
        across="flow(inductance)",
        up="momentum(inductance)",
        left="f",
        seconds=0.6,
        step=0.0005,
    ),
    "TemperatureDependentResistance": Scene(
        machine=machines.winding,
        place="resistance",
        values={"warming": 0.5, "warming_time": 15.0},
        drive={"voltage": lambda t: 3.0 * np.sin(1.5 * t)},
        output="current",
        across="flow(resistance)",
        up="effort(resistance)",
        seconds=60.0,
        step=0.02,
    ),
    "TemperatureDependentGyrator": Scene(
        machine=machines.winding,
        place="k_m",
        values={"warming": -0.1, "warming_time": 15.0},
        drive={"voltage": lambda t: 3.0 * np.sin(1.5 * t)},
        output="current",
        across="flow(winding)",
        up="effort(k_m>shaft)",
        left="r",
        seconds=60.0,
        step=0.02,
    ),
    "ParameterDrift": Scene(
        machine=machines.oscillator,
        place="mass",
        values={"drift": -0.04},
        drive={"force": lambda t: 10.0 * np.sin(3.0 * t) + 12.0 * np.sin(8.0 * t)},
        output="position",
        across="flow(mass)",
        up="momentum(mass)",
        left="f",
        seconds=20.0,
    ),
    "ParameterStep": Scene(
        machine=machines.cart,
        place="track",
        output="speed",
        drive={"force": _wave(10.0)},
        across="flow(track)",
        up="effort(track)",
        values={"step": -0.6, "moment": 4.0},
    ),
    "DisturbanceStep": Scene(
        **_PUSHED, up="effort(*)", values={"step": -4.0, "moment": 4.0}, cloud=True
    ),
    "SpeedLimit": Scene(
        **_PUSHED, values={"flow_limit": 1.2, "flow_limit_steepness": 60.0}
    ),
    "SensorBias": Scene(**_READ, values={"sensor_bias": 0.4}),
    "SensorScale": Scene(**_READ, values={"sensor_scale": 0.75}),
    "SensorSwap": Scene(
        machine=machines.two_tanks,
        place="upper_pressure",
        values={},
        drive={"inflow": _steps(0.0, 2.0, 0.5, 1.5, every=2.5)},
        output="upper_pressure",
        across="effort(upper)",
        up="law",
        labels=("upper pressure there is [Pa]", "upper pressure read [Pa]"),
        left="y",
        written=r"x_{\mathrm{lower}}",
    ),
    "InputScale": Scene(**_COMMANDED, values={"input_scale": 0.7}),
    "InputSwap": Scene(
        machine=machines.worm_drive,
        place="torque",
        values={},
        drive={"torque": _wave(1.0), "load": _slow(0.6, 1.9)},
        output="speed",
        across="effort(torque)",
        up="law",
        labels=("torque commanded [N m]", "torque that acts [N m]"),
        left=r"u_{\mathrm{acts}}",
        written=r"u_{\mathrm{load}}",
    ),
    "Lag": Scene(**_COMMANDED, values={"lag": 0.4}),
    "Delay": Scene(**_COMMANDED, values={"delay": 0.4}),
    "Slip": Scene(
        machine=machines.belt,
        place="coupling",
        values={"leak": 0.5},
        drive={"force": _steps(6.0, -6.0, 6.0, -6.0, every=2.5)},
        output="far_position",
        across="effort(coupling)",
        up="flow(*)",
    ),
    "Saturation": Scene(**_COMMANDED, values={"limit": 6.0}),
    "DeadZone": Scene(**_COMMANDED, values={"dead_zone": 3.0}),
    "LostMotion": Scene(
        machine=machines.two_tanks,
        place="inflow",
        values={"half_gap": 0.5},
        drive={"inflow": _wave(2.0)},
        output="upper_pressure",
        across="flow(inflow)",
        up="flow(*)",
        labels=("flow commanded [m³/s]", "flow that acts [m³/s]"),
        left=r"u_{\mathrm{acts}}",
    ),
    "InputNonlinearity": Scene(**_COMMANDED, values={"input_power": 1.0}),
    "SensorNonlinearity": Scene(
        **_READ, values={"sensor_square": 0.0, "sensor_cube": -0.35}
    ),
    "UnknownRelation": Scene(
        **_PUSHED,
        written=(
            r"h_i + (h_{i+1} - h_i) \frac{f / s - k_i}{k_{i+1} - k_i}, \quad "
            r"k_i \le f / s \le k_{i+1}, \quad h_i = \mathrm{curve}_i, \quad "
            r"s = \mathrm{curve}_{\mathrm{flow}}"
        ),
        values={
            f"curve_{i}": height
            for i, height in enumerate((-2.0, -4.5, -2.0, -0.3, 0.3, 2.0, 4.5, 2.0))
        },
    ),
}
