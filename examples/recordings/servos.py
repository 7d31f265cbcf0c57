"""A position servo on a pendulum: firmware, winding, gears as one inertia, arm.

    python examples/recordings/prepare.py servos ../shared/recordings prepared
    bondgraph diagnose examples/recordings/servos.py:xl330 \
        prepared/xl330_kp100_*.csv prepared/xl330_kp800_*.csv \
        $(printf -- '--held-out %s ' prepared/xl330_kp200_*.csv)
    bondgraph diagnose examples/recordings/servos.py:sts3215 prepared/sts_m0p535_*.csv \
        $(printf -- '--held-out %s ' prepared/sts_m0p969_*.csv)

The position loop of the firmware is known and stands in the model; its gain, the
supply, mass and arm are channels, since they differ between recordings. The motor is
released where `torque_enable` is zero: no current flows then. What the models leave
out: dry friction that grows with the torque through the gears, and a limit of speed
(Duclusaud et al., ICRA 2025; K-Scale Labs).
"""

import math

import sympy

from bondgraph import GY, BondGraph, I, R, Se, Sf, displacement, e, flow, p

GRAVITY = 9.81
CHANNELS = (
    *("goal_position", "kp", "voltage", "torque_enable"),
    *("mass", "arm_length", "arm_mass"),
)


def xl330() -> BondGraph:
    """Return a Dynamixel XL330: 12 bit encoder, duty in 885 steps, gain over 256."""
    servo = _servo("XL330 servo", 4096 / (2 * math.pi) / (256 * 885), limit=1.0)
    servo.parameter("resistance", 4.0, "ohm", bounds=(0.1, 100))
    servo.parameter("torque_constant", 0.35, "N*m/A", bounds=(0.01, 10))
    servo.parameter("armature", 2e-3, "kg*m^2", bounds=(1e-6, 1))
    return servo


def sts3215() -> BondGraph:
    """Return a Feetech STS3215; its duty stops at 0.97."""
    servo = _servo("STS3215 servo", 0.164891, limit=0.97)
    servo.parameter("resistance", 2.0, "ohm", bounds=(0.1, 100))
    servo.parameter("torque_constant", 1.0, "N*m/A", bounds=(0.01, 10))
    servo.parameter("armature", 0.03, "kg*m^2", bounds=(1e-6, 1))
    return servo


def _servo(name: str, duty_per_radian: float, limit: float) -> BondGraph:
    servo = BondGraph(name, domain="rotation")
    for channel in CHANNELS:
        servo.one(f"signal_{channel}", Sf(channel), domain="analogue")
    error = flow("goal_position") - displacement("gear")
    duty = sympy.Max(sympy.Min(duty_per_radian * flow("kp") * error, limit), -limit)
    servo.one(
        "winding",
        Se("bridge", value=duty * flow("voltage")),
        R("copper", law=flow("torque_enable") * e / sympy.Symbol("resistance")),
        domain="electrical",
    )
    length, mass, rod = flow("arm_length"), flow("mass"), flow("arm_mass")
    inertia = sympy.Symbol("armature") + (mass + rod / 3) * length**2
    hanging = displacement("gear") + sympy.Symbol("q_offset")
    weight = -GRAVITY * (mass + rod / 2) * length * sympy.sin(hanging)
    servo.one(
        "gear", I("inertia", law=p / inertia), R("viscous"), Se("weight", value=weight)
    )
    servo.join("winding", GY("torque_constant"), "gear")
    servo.measure("position", displacement="gear")
    servo.parameter("viscous", 0.02, "N*m*s/rad", bounds=(0, 10))
    servo.parameter("q_offset", 0.0, "rad", bounds=(-0.3, 0.3))
    return servo
