"""A hydraulic cylinder against a spring: flow in, rod position and pressure out."""

import math

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled
from benchmarks.concealed.machine import Drive, Machine, Number, Place, Sensor, Site

MODEL = '''"""Hydraulic cylinder: leaking chamber, piston, rod with mass and spring."""

from bondgraph import TF, BondGraph, C, I, R, Sf


def cylinder() -> BondGraph:
    machine = BondGraph("hydraulic cylinder", domain="hydraulic")
    machine.zero("chamber", Sf("supply"), C("C_oil"), R("R_leak"))
    machine.one("rod", I("mass"), R("b_rod"), C("c_spring"), domain="translation")
    machine.join("chamber", TF("area"), "rod")
    machine.measure("position", displacement="rod")
    machine.measure("pressure", effort="chamber")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Pressure on the piston against rod and spring; flows of the chamber.

    The leak turns from a linear to a root law with a share.
    """
    pressure = z[0] / p[0]
    F[0] = p[5] * pressure - p[3] * v[0] - q[0] / p[4]
    leak = (1.0 - p[6]) * pressure / p[1]
    if p[6] > 0.0:
        leak += p[6] * math.copysign(math.sqrt(abs(pressure) * 4e5), pressure) / p[1]
    g[0] = u[0] - leak - p[5] * v[0]
    stored[0] = pressure
    load[0] = p[5] * pressure


@compiled(MASSES)
def masses(q, v, p, M):
    """Return the mass of rod and load."""
    M[0, 0] = p[2]


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read position and pressure."""
    y[0], y[1] = q[0], z[0] / p[0]


CYLINDER = Machine(
    name="cylinder",
    domains=("hydraulic", "translation"),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=1,
    stores=1,
    numbers=(
        Number(name="C_oil", value=4e-12, unit="m^3/Pa", free=True),
        Number(name="R_leak", value=1e10, unit="Pa*s/m^3", free=True),
        Number(name="mass", value=20.0, unit="kg", free=True),
        Number(name="b_rod", value=400.0, unit="N*s/m", free=True),
        Number(name="c_spring", value=5e-5, unit="m/N", free=True),
        Number(name="area", value=1e-3, unit="m^2"),
        Number(name="leak_root", value=0.0, hidden=True),
    ),
    places=(
        Place(name="rod", row=(1.0,), gain=3e6),
        Place(name="chamber", cell=0),
    ),
    inputs=(("supply", "m^3/s"),),
    sensors=(
        Sensor(name="position", unit="m", noise=2e-5, step=2e-5),
        Sensor(name="pressure", unit="Pa", noise=2e3, step=1e3),
    ),
    drive=Drive(size=1.2e-4, band=(0.3, 8.0), limit=3e-4),
    rate=500.0,
    samples=4000,
    fine=20,
    model=MODEL,
    aliases={
        "supply": ("chamber",),
        "chamber": ("C_oil", "R_leak"),
        "R_leak": ("chamber",),
        "rod": ("mass", "b_rod", "c_spring", "area"),
    },
    linear=True,
    sites=(
        Site(word="coulomb_friction", place="rod"),
        Site(word="stribeck_friction", place="rod"),
        Site(word="stribeck_friction", place="rod", law="lugre"),
        Site(word="hysteresis", place="rod"),
        Site(word="hardening_spring", place="rod"),
        Site(word="quadratic_drag", place="rod"),
        Site(word="constant_bias", place="rod"),
        Site(word="end_stop", place="rod", largest=0.3),
        Site(word="square_root_orifice", place="R_leak", largest=1.0,
             sets=lambda a, s: {"leak_root": a}),
        Site(word="dead_zone", place="supply"),
        Site(word="saturation", place="supply", largest=0.7),
        Site(word="delay", place="supply"),
        Site(word="constant_bias", place="supply"),
        Site(word="overflow", place="chamber", largest=0.5),
        Site(word="sensor_bias", place="pressure"),
        Site(word="sensor_nonlinearity", place="position"),
        Site(word="lag", place="pressure"),
        Site(word="leak", place="chamber", silent=True),
        Site(word="tabulated_law", place="rod"),
        Site(word="speed_dependent_gain", place="supply"),
    ),
)  # fmt: skip
