"""The FlegX lower leg drive: motor, gearbox and worm, joint; a loop on the joint angle.

The train is rigid in the base model, so that friction at the motor, the worm and the
joint is one friction with three numbers. In the variant ``elastic`` a tendon with play
lies between the worm and the joint.
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

MODEL = '''"""FlegX lower leg drive in the air: motor, gearbox, worm, joint."""

from bondgraph import TF, BondGraph, I, R, Se


def drive() -> BondGraph:
    machine = BondGraph("lower leg drive", domain="rotation")
    machine.one("motor", Se("T_motor"), I("I_motor"))
    machine.one("worm", I("I_worm"))
    machine.one("joint", Se("T_load"), R("c_joint"), I("I_lowerleg"))
    machine.join("motor", TF("K_gearbox"), "worm")
    machine.join("worm", TF("K_worm_gear"), "joint")
    machine.measure("theta", displacement="joint")
{parameters}
    return machine
'''

GEARBOX, WORM = 26.0, 29.0 / 3.0
RATIO = GEARBOX * WORM


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """All torques at the joint; the worm passes on what the joint needs."""
    F[0] = RATIO * u[0] + u[1] - p[2] * v[0]
    load[0] = (p[3] * acceleration[0] + p[2] * v[0] - u[1]) / WORM


@compiled(MASSES)
def masses(q, v, p, M):
    """One inertia, reflected to the joint."""
    M[0, 0] = RATIO**2 * p[0] + WORM**2 * p[1] + p[3]


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read the joint angle."""
    y[0] = q[0]


@compiled(FORCES)
def elastic_forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Motor side (at the joint's scale) and joint, with a tendon between them."""
    twist, rate = q[0] - q[1], v[0] - v[1]
    free = min(max(twist, -p[7]), p[7])
    tendon = (twist - free) / p[6]
    if p[7] == 0.0 or free != twist:
        tendon += p[8] * rate
    F[0] = RATIO * u[0] - tendon
    F[1] = tendon + u[1] - p[2] * v[1]
    load[0] = tendon / WORM


@compiled(MASSES)
def elastic_masses(q, v, p, M):
    """Motor side and joint side."""
    M[:] = 0.0
    M[0, 0] = RATIO**2 * p[0] + WORM**2 * p[1]
    M[1, 1] = p[3]


@compiled(READINGS)
def elastic_readings(q, v, z, u, p, acceleration, y):
    """Read the joint angle."""
    y[0] = q[1]


NUMBERS = (
    Number(name="I_motor", value=2.2e-5, unit="kg*m^2", free=True),
    Number(name="I_worm", value=1e-6, unit="kg*m^2"),
    Number(name="c_joint", value=0.6, unit="N*m*s/rad", free=True),
    Number(name="I_lowerleg", value=0.0131, unit="kg*m^2"),
    Number(name="K_gearbox", value=GEARBOX),
    Number(name="K_worm_gear", value=WORM),
    Number(name="tendon", value=1 / 500.0, hidden=True),
    Number(name="half_gap", value=0.0, hidden=True),
    Number(name="tendon_damping", value=0.05, hidden=True),
)
PLACES = (
    Place(name="motor", row=(RATIO,)),
    Place(name="worm", row=(WORM,), gain=GEARBOX),
    Place(name="joint", row=(1.0,), gain=RATIO),
)

_RIGID = Machine(
    name="flegx_drive",
    domains=("rotation",),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=1,
    numbers=NUMBERS,
    places=PLACES,
    inputs=(("T_motor", "N*m"), ("T_load", "N*m")),
    sensors=(Sensor(name="theta", unit="rad", noise=3e-4, step=2 * math.pi / 2**14),),
    drive=Drive(
        size=0.35, band=(0.3, 2.5), limit=0.4, resolution=5e-5,
        loop=Loop(kp=0.7, kd=0.09, derivative_time=0.005), others=((4.0, 0.0),),
    ),
    rate=400.0,
    samples=4000,
    fine=20,
    window=400,
    model=MODEL,
    aliases={
        "T_motor": ("motor",),
        "T_load": ("joint",),
        "motor": ("I_motor", "K_gearbox"),
        "worm": ("I_worm", "K_worm_gear", "K_gearbox"),
        "joint": ("c_joint", "I_lowerleg", "K_worm_gear", "worm"),
    },
    linear=True,
    sites=(
        Site(word="load_dependent_friction", place="worm", largest=0.5),
        Site(word="load_dependent_friction", place="worm", largest=0.4),
        Site(word="coulomb_friction", place="motor"),
        Site(word="coulomb_friction", place="joint"),
        Site(word="stribeck_friction", place="worm"),
        Site(word="direction_dependent_friction", place="worm"),
        Site(word="quadratic_drag", place="joint"),
        Site(word="gravity", place="joint"),
        Site(word="spring", place="joint"),
        Site(word="cogging", place="joint"),
        Site(word="hysteresis", place="joint"),
        Site(word="end_stop", place="joint", largest=0.3),
        Site(word="constant_bias", place="joint"),
        Site(word="compliance", place="joint", variant="elastic", largest=3.0,
             sets=lambda a, s: {"tendon": a / 100.0}),
        Site(word="backlash", place="joint", variant="elastic", largest=0.5,
             sets=lambda a, s: {"tendon": 1 / 5000.0, "half_gap": a * 0.2}),
        Site(word="delay", place="T_motor"),
        Site(word="saturation", place="T_motor", largest=0.7),
        Site(word="dead_zone", place="T_motor"),
        Site(word="lag", place="theta"),
        Site(word="sensor_nonlinearity", place="theta"),
        Site(word="viscous_friction", place="motor", silent=True),
        Site(word="periodic_and_quadratic", place="joint"),
    ),
)  # fmt: skip

ELASTIC = replace(
    _RIGID,
    forces=elastic_forces,
    masses=elastic_masses,
    readings=elastic_readings,
    coordinates=2,
    places=(
        replace(PLACES[0], row=(RATIO, 0.0)),
        replace(PLACES[1], row=(WORM, 0.0)),
        replace(PLACES[2], row=(0.0, 1.0)),
    ),
)
FLEGX_DRIVE = replace(_RIGID, variants={"elastic": ELASTIC})
