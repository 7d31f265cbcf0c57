"""Two inertias on a shaft that twists: motor and load, a loop on the motor.

In the variant ``flexible`` the load is itself a flexible link of many modes.
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

MODEL = '''"""Two-mass drive: motor, compliant shaft, load; both angles are measured."""

from bondgraph import BondGraph, C, I, R, Se


def drive() -> BondGraph:
    machine = BondGraph("two-mass drive", domain="rotation")
    machine.one("motor", Se("torque"), I("J_motor"), R("b_motor"))
    machine.zero("shaft")
    machine.one("twist", C("c_shaft"), R("d_shaft"))
    machine.one("load", I("J_load"), R("b_load"))
    machine.join("motor", "shaft")
    machine.join("shaft", "twist")
    machine.join("shaft", "load")
    machine.measure("theta_motor", displacement="motor")
    machine.measure("theta_load", displacement="load")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Torques on motor and load; the shaft transmits beyond half the gap only."""
    twist, rate = q[0] - q[1], v[0] - v[1]
    free = min(max(twist, -p[6]), p[6])
    shaft = (twist - free) / p[2] + p[7] * twist**3
    if p[6] == 0.0 or free != twist:
        shaft += p[3] * rate
    F[0] = u[0] - p[1] * v[0] - shaft
    F[1] = shaft - p[5] * v[1]
    load[0] = shaft


@compiled(MASSES)
def masses(q, v, p, M):
    """Diagonal inertias."""
    M[:] = 0.0
    M[0, 0], M[1, 1] = p[0], p[4]


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read both angles."""
    y[0], y[1] = q[0], q[1]


@compiled(FORCES)
def flexible_forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Return the torques where the load is a hub and five lumps on soft joints."""
    forces(q, v, z, u, p, acceleration, F, g, load, stored)
    for i in range(1, 6):
        torque = (q[i] - q[i + 1]) / p[8] + p[9] * (v[i] - v[i + 1])
        F[i] -= torque
        F[i + 1] += torque


@compiled(MASSES)
def flexible_masses(q, v, p, M):
    """Half of the load is its hub, a tenth is each lump."""
    M[:] = 0.0
    M[0, 0], M[1, 1] = p[0], p[4] / 2.0
    for i in range(2, 7):
        M[i, i] = p[4] / 10.0


NOISE, STEP = 2e-4, 2 * math.pi / 2**15

_STIFF = Machine(
    name="two_mass_drive",
    domains=("rotation",),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=2,
    numbers=(
        Number(name="J_motor", value=0.010, unit="kg*m^2", free=True),
        Number(name="b_motor", value=0.02, unit="N*m*s/rad", free=True),
        Number(name="c_shaft", value=1 / 40.0, unit="rad/(N*m)", free=True),
        Number(name="d_shaft", value=0.02, unit="N*m*s/rad", free=True),
        Number(name="J_load", value=0.020, unit="kg*m^2", free=True),
        Number(name="b_load", value=0.03, unit="N*m*s/rad", free=True),
        Number(name="half_gap", value=0.0, hidden=True),
        Number(name="cubic", value=0.0, hidden=True),
        Number(name="joint", value=0.0, hidden=True),
        Number(name="joint_damping", value=2e-4, hidden=True),
    ),
    places=(
        Place(name="motor", row=(1.0, 0.0)),
        Place(name="twist", row=(1.0, -1.0)),
        Place(name="load", row=(0.0, 1.0)),
    ),
    inputs=(("torque", "N*m"),),
    sensors=(
        Sensor(name="theta_motor", unit="rad", noise=NOISE, step=STEP),
        Sensor(name="theta_load", unit="rad", noise=NOISE, step=STEP),
    ),
    drive=Drive(
        size=0.8, band=(0.3, 4.0), limit=12.0, resolution=1e-3,
        loop=Loop(kp=7.0, kd=0.6, derivative_time=0.002),
    ),
    rate=500.0,
    samples=4000,
    fine=20,
    window=500,
    model=MODEL,
    aliases={
        "torque": ("motor",),
        "motor": ("J_motor", "b_motor"),
        "twist": ("shaft", "c_shaft", "d_shaft"),
        "load": ("J_load", "b_load"),
    },
    linear=True,
    sites=(
        Site(word="coulomb_friction", place="load"),
        Site(word="coulomb_friction", place="motor"),
        Site(word="stribeck_friction", place="load"),
        Site(word="load_dependent_friction", place="load"),
        Site(word="quadratic_drag", place="load"),
        Site(word="backlash", place="twist", largest=3.0,
             sets=lambda a, s: {"half_gap": a * s["twist.reach"]}),
        Site(word="hardening_spring", place="twist", largest=20.0,
             sets=lambda a, s: {"cubic": a * 40.0 / s["twist.reach"] ** 2}),
        Site(word="compliance", place="load", variant="flexible", law="link_modes",
             largest=3.0, sets=lambda a, s: {"joint": a * 0.02}),
        Site(word="cogging", place="motor"),
        Site(word="gravity", place="load"),
        Site(word="spring", place="load"),
        Site(word="hysteresis", place="load"),
        Site(word="end_stop", place="load", largest=0.3),
        Site(word="delay", place="torque"),
        Site(word="lag", place="torque"),
        Site(word="saturation", place="torque", largest=0.7),
        Site(word="dead_zone", place="torque"),
        Site(word="constant_bias", place="torque"),
        Site(word="sensor_scale", place="theta_load"),
        Site(word="sensor_nonlinearity", place="theta_load"),
        Site(word="lag", place="theta_load"),
        Site(word="viscous_friction", place="load", silent=True),
        Site(word="tabulated_law", place="load"),
    ),
)  # fmt: skip

FLEXIBLE = replace(
    _STIFF,
    forces=flexible_forces,
    masses=flexible_masses,
    coordinates=7,
    places=tuple(replace(one, row=(*one.row, *[0.0] * 5)) for one in _STIFF.places),
)
TWO_MASS_DRIVE = replace(_STIFF, variants={"flexible": FLEXIBLE})
