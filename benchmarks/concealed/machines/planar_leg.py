"""The planar FlegX leg hanging from a held support: two joints, two worm drives.

Both angles are absolute: through its tendons the knee's motor turns the lower leg
against the support. Motors and links are known from data sheets and the scale, friction
and centres of mass are not. In the variant ``elastic`` the tendons give way.
"""

import math
from dataclasses import replace

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled
from benchmarks.concealed.machine import (
    Drive,
    Loop,
    Machine,
    Number,
    Place,
    Sensor,
    Site,
)

MODEL = '''"""Planar leg with two worm drives; both absolute angles are measured."""

import sympy

from bondgraph import MTF, TF, BondGraph, I, R, Se, displacement, p


def leg() -> BondGraph:
    machine = BondGraph("hanging leg", domain="rotation")
    hip, knee = displacement("hip"), displacement("knee")
    L, l, mass = sympy.symbols("L l_lower m_lower")
    for joint in ("hip", "knee"):
        machine.one(f"{joint}_motor", Se(f"T_{joint}"), I(f"I_{joint}_motor"))
        machine.one(f"{joint}_worm")
        machine.join(f"{joint}_motor", TF(f"K_{joint}_gearbox"), f"{joint}_worm")
    upper = Se("weight_upper", value=-9.81 * sympy.Symbol("ml_upper") * sympy.sin(hip))
    machine.one("hip", I("J_upper"), R("c_hip"), upper)
    machine.join("hip_worm", TF("K_hip_worm"), "hip")
    machine.zero("tendons")
    machine.one("knee", I("J_lower"))
    machine.join("knee_worm", TF("K_knee_worm"), "tendons")
    machine.join("tendons", "knee")
    machine.one("bearings", R("c_knee"))
    machine.zero("bend")
    machine.join("knee", "bend")
    machine.join("bend", "hip")
    machine.join("bend", "bearings")
    machine.one("lower_x", I("m_x", law=p / mass), domain="translation")
    weight = Se("weight_lower", value=-9.81 * mass)
    machine.one("lower_y", I("m_y", law=p / mass), weight, domain="translation")
    for axis, way in (("x", sympy.cos), ("y", sympy.sin)):
        machine.zero(f"sum_{axis}", domain="translation")
        machine.join(f"lower_{axis}", f"sum_{axis}")
        machine.join(f"sum_{axis}", MTF(f"hip_{axis}", L * way(hip)), "hip")
        machine.join(f"sum_{axis}", MTF(f"knee_{axis}", l * way(knee)), "knee")
    machine.prefer("J_upper", "integral")
    machine.prefer("J_lower", "integral")
    machine.measure("theta_hip", displacement="hip")
    machine.measure("theta_knee", displacement="knee")
{parameters}
    return machine
'''

GEARBOX, WORM = 26.0, 29.0 / 3.0
RATIO = GEARBOX * WORM
HIP_MOTOR, KNEE_MOTOR, J_UPPER, J_LOWER, C_HIP, C_KNEE, ML_UPPER, M, L, LOWER = range(
    10
)
TENDON, TENDON_DAMPING, CARRIED = 14, 15, 16


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Motors, friction and weights; the worms pass on what their motors do not take."""
    coupling = p[M] * p[L] * p[LOWER] * math.sin(q[0] - q[1])
    hip = p[C_HIP] * v[0] - p[C_KNEE] * (v[1] - v[0]) + coupling * v[1] ** 2
    hip += 9.81 * (p[ML_UPPER] + p[M] * p[L]) * math.sin(q[0])
    knee = p[C_KNEE] * (v[1] - v[0]) - coupling * v[0] ** 2
    knee += 9.81 * p[M] * p[LOWER] * math.sin(q[1])
    F[0], F[1] = RATIO * u[0] - hip, RATIO * u[1] - knee
    mixed = p[M] * p[L] * p[LOWER] * math.cos(q[0] - q[1])
    load[0] = hip + (p[J_UPPER] + p[M] * p[L] ** 2) * acceleration[0]
    load[0] = (load[0] + mixed * acceleration[1]) / WORM
    own = p[J_LOWER] + p[CARRIED] + p[M] * p[LOWER] ** 2
    load[1] = (knee + own * acceleration[1] + mixed * acceleration[0]) / WORM


@compiled(MASSES)
def masses(q, v, p, matrix):
    """Links that move each other, and motors on both."""
    matrix[0, 0] = RATIO**2 * p[HIP_MOTOR] + p[J_UPPER] + p[M] * p[L] ** 2
    own = p[J_LOWER] + p[CARRIED] + p[M] * p[LOWER] ** 2
    matrix[1, 1] = RATIO**2 * p[KNEE_MOTOR] + own
    mixed = p[M] * p[L] * p[LOWER] * math.cos(q[0] - q[1])
    matrix[0, 1] = matrix[1, 0] = mixed


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read both angles."""
    y[0], y[1] = q[0], q[1]


@compiled(FORCES)
def elastic_forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Return the torques with the knee's motor on its own, behind the tendons."""
    forces(q, v, z, u, p, acceleration, F, g, load, stored)
    tendon = (q[2] - q[1]) / p[TENDON] + p[TENDON_DAMPING] * (v[2] - v[1])
    F[1] += tendon - RATIO * u[1]
    F[2] = RATIO * u[1] - tendon
    load[1] = tendon / WORM


@compiled(MASSES)
def elastic_masses(q, v, p, matrix):
    """Return the inertias with the knee's motor on its own."""
    matrix[:] = 0.0
    masses(q, v, p, matrix)
    matrix[1, 1] -= RATIO**2 * p[KNEE_MOTOR]
    matrix[2, 2] = RATIO**2 * p[KNEE_MOTOR]


_ENCODER = {"unit": "rad", "noise": 3e-4, "step": 2 * math.pi / 2**14}
_RIGID = Machine(
    name="planar_leg",
    domains=("rotation", "translation"),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=2,
    numbers=(
        Number(name="I_hip_motor", value=2.2e-5, unit="kg*m^2"),
        Number(name="I_knee_motor", value=2.2e-5, unit="kg*m^2"),
        Number(name="J_upper", value=0.05, unit="kg*m^2"),
        Number(name="J_lower", value=0.012, unit="kg*m^2"),
        Number(name="c_hip", value=4.0, unit="N*m*s/rad", free=True),
        Number(name="c_knee", value=2.5, unit="N*m*s/rad", free=True),
        Number(name="ml_upper", value=0.35, unit="kg*m", free=True),
        Number(name="m_lower", value=1.0, unit="kg"),
        Number(name="L", value=0.3, unit="m"),
        Number(name="l_lower", value=0.12, unit="m", free=True),
        Number(name="K_hip_gearbox", value=GEARBOX),
        Number(name="K_knee_gearbox", value=GEARBOX),
        Number(name="K_hip_worm", value=WORM),
        Number(name="K_knee_worm", value=WORM),
        Number(name="tendon", value=1 / 500.0, hidden=True),
        Number(name="tendon_damping", value=0.3, hidden=True),
        Number(name="carried", value=0.0, hidden=True),
    ),
    places=(
        Place(name="hip", row=(1.0, 0.0), gain=RATIO),
        Place(name="knee", row=(0.0, 1.0), gain=RATIO),
        Place(name="bearings", row=(-1.0, 1.0), gain=RATIO),
        Place(name="hip_worm", row=(WORM, 0.0), gain=GEARBOX),
        Place(name="knee_worm", row=(0.0, WORM), gain=GEARBOX, load=1),
    ),
    inputs=(("T_hip", "N*m"), ("T_knee", "N*m")),
    sensors=(
        Sensor(name="theta_hip", **_ENCODER),
        Sensor(name="theta_knee", **_ENCODER),
    ),
    drive=Drive(
        size=0.5, band=(0.2, 2.0), limit=0.4, resolution=5e-5,
        loop=Loop(kp=0.7, kd=0.09, derivative_time=0.005),
        others=((0.5, 0.0),),
        other_loops=(Loop(kp=0.7, kd=0.09, channel=1, derivative_time=0.005),),
    ),
    rate=400.0,
    samples=4000,
    fine=20,
    window=400,
    model=MODEL,
    aliases={
        "T_hip": ("hip_motor",),
        "T_knee": ("knee_motor",),
        "hip": ("J_upper", "c_hip", "K_hip_worm", "hip_worm"),
        "knee": ("J_lower", "K_knee_worm", "knee_worm", "tendons"),
        "bearings": ("c_knee", "bend"),
        "hip_worm": ("K_hip_worm", "K_hip_gearbox"),
        "knee_worm": ("K_knee_worm", "K_knee_gearbox"),
        "tendons": ("K_knee_worm", "knee", "knee_worm"),
    },
    sites=(
        Site(word="load_dependent_friction", place="hip_worm", largest=0.5),
        Site(word="load_dependent_friction", place="knee_worm", largest=0.5),
        Site(word="coulomb_friction", place="hip"),
        Site(word="coulomb_friction", place="bearings"),
        Site(word="stribeck_friction", place="hip_worm"),
        Site(word="direction_dependent_friction", place="knee_worm"),
        Site(word="quadratic_drag", place="bearings"),
        Site(word="viscous_friction", place="knee"),
        Site(word="spring", place="bearings"),
        Site(word="spring", place="knee"),
        Site(word="cogging", place="hip"),
        Site(word="hysteresis", place="bearings"),
        Site(word="end_stop", place="knee", largest=0.3),
        Site(word="constant_bias", place="hip"),
        Site(word="added_inertia", place="knee", largest=1.0,
             sets=lambda a, s: {"carried": a}),
        Site(word="added_compliance", place="tendons", variant="elastic", largest=3.0,
             law="compliance", sets=lambda a, s: {"tendon": a / 100.0}),
        Site(word="delay", place="T_hip"),
        Site(word="dead_zone", place="T_knee"),
        Site(word="saturation", place="T_hip", largest=0.7),
        Site(word="sensor_scale", place="theta_knee"),
        Site(word="sensor_nonlinearity", place="theta_hip"),
        Site(word="lag", place="theta_knee"),
        Site(word="viscous_friction", place="hip", silent=True),
        Site(word="tabulated_law", place="bearings"),
        Site(word="periodic_and_quadratic", place="hip"),
        Site(word="speed_dependent_gain", place="T_hip"),
    ),
)  # fmt: skip

ELASTIC = replace(
    _RIGID,
    forces=elastic_forces,
    masses=elastic_masses,
    coordinates=3,
    places=(
        *(replace(one, row=(*one.row, 0.0)) for one in _RIGID.places[:-1]),
        replace(_RIGID.places[-1], row=(0.0, 0.0, WORM)),
    ),
)
PLANAR_LEG = replace(_RIGID, variants={"elastic": ELASTIC})
