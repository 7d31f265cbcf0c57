"""A pendulum on a motor: torque in, angle out, gravity known to be there."""

import math

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled
from benchmarks.concealed.machine import Drive, Machine, Number, Place, Sensor, Site

MODEL = '''"""Pendulum with weight, bearing and torque; its angle is measured."""

import sympy

from bondgraph import BondGraph, I, R, Se, displacement


def pendulum() -> BondGraph:
    machine = BondGraph("pendulum", domain="rotation")
    weight = -sympy.Symbol("mgl") * sympy.sin(displacement("pivot"))
    machine.one("pivot", Se("torque"), I("J"), R("b"), Se("weight", value=weight))
    machine.measure("angle", displacement="pivot")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Torque, weight and bearing."""
    F[0] = u[0] - p[1] * v[0] - p[2] * math.sin(q[0])
    load[0] = p[2] * math.sin(q[0])


@compiled(MASSES)
def masses(q, v, p, M):
    """One inertia."""
    M[0, 0] = p[0]


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read the angle."""
    y[0] = q[0]


PENDULUM = Machine(
    name="pendulum",
    domains=("rotation",),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=1,
    numbers=(
        Number(name="J", value=0.12, unit="kg*m^2", free=True),
        Number(name="b", value=0.4, unit="N*m*s/rad", free=True),
        Number(name="mgl", value=6.0, unit="N*m", free=True),
    ),
    places=(Place(name="pivot", row=(1.0,)),),
    inputs=(("torque", "N*m"),),
    sensors=(Sensor(name="angle", unit="rad", noise=4e-4, step=2 * math.pi / 2**14),),
    drive=Drive(size=1.8, band=(0.1, 3.0), limit=4.5),
    rate=200.0,
    samples=4000,
    fine=25,
    model=MODEL,
    aliases={"torque": ("pivot",), "pivot": ("J", "b", "weight")},
    sites=(
        Site(word="coulomb_friction", place="pivot"),
        Site(word="stribeck_friction", place="pivot"),
        Site(word="stribeck_friction", place="pivot", law="lugre"),
        Site(word="quadratic_drag", place="pivot"),
        Site(word="spring", place="pivot"),
        Site(word="hardening_spring", place="pivot"),
        Site(word="constant_bias", place="pivot"),
        Site(word="cogging", place="pivot"),
        Site(word="hysteresis", place="pivot"),
        Site(word="hysteresis", place="pivot", law="maxwell_slip"),
        Site(word="end_stop", place="pivot", largest=0.3),
        Site(word="saturation", place="torque", largest=0.7),
        Site(word="dead_zone", place="torque"),
        Site(word="delay", place="torque"),
        Site(word="lag", place="torque"),
        Site(word="sensor_bias", place="angle"),
        Site(word="sensor_nonlinearity", place="angle"),
        Site(
            word="sensor_nonlinearity",
            place="angle",
            law="sensor_clipping",
            largest=0.5,
        ),
        Site(word="lag", place="angle"),
        Site(word="viscous_friction", place="pivot", silent=True),
        Site(word="tabulated_law", place="pivot"),
        Site(word="periodic_and_quadratic", place="pivot"),
        Site(word="speed_dependent_gain", place="torque"),
    ),
)
