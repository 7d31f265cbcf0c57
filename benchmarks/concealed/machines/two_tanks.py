"""Two open tanks one after the other: a pump fills the upper, both levels are read.

In the variant ``inert`` what flows in the pipe has inertia.
"""

import math
from dataclasses import replace

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled
from benchmarks.concealed.machine import Drive, Machine, Number, Place, Sensor, Site

MODEL = '''"""Two tanks, a pipe and an outlet; both pressures are measured."""

from bondgraph import BondGraph, C, R, Sf


def tanks() -> BondGraph:
    machine = BondGraph("two tanks", domain="hydraulic")
    machine.zero("upper", Sf("pump"), C("C_upper"))
    machine.one("pipe", R("R_pipe"))
    machine.zero("lower", C("C_lower"), R("R_outlet"))
    machine.join("upper", "pipe")
    machine.join("pipe", "lower")
    machine.measure("p_upper", effort="upper")
    machine.measure("p_lower", effort="lower")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Flows in and out; pipe and outlet turn from linear to a root law with a share."""
    upper, lower = z[0] / p[0], z[1] / p[2]
    drop = upper - lower
    pipe = (1.0 - p[4]) * drop / p[1]
    if p[4] > 0.0:
        pipe += p[4] * math.copysign(math.sqrt(abs(drop) * 2000.0), drop) / p[1]
    outlet = (1.0 - p[5]) * lower / p[3]
    if p[5] > 0.0:
        outlet += p[5] * math.copysign(math.sqrt(abs(lower) * 3000.0), lower) / p[3]
    g[0] = u[0] - pipe
    g[1] = pipe - outlet
    stored[0], stored[1] = upper, lower


@compiled(MASSES)
def masses(q, v, p, M):
    """No inertia."""


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read both pressures."""
    y[0], y[1] = z[0] / p[0], z[1] / p[2]


@compiled(FORCES)
def inert_forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Return the flows where that of the pipe is a coordinate."""
    upper, lower = z[0] / p[0], z[1] / p[2]
    F[0] = upper - lower - p[1] * v[0]
    g[0] = u[0] - v[0]
    g[1] = v[0] - lower / p[3]
    stored[0], stored[1] = upper, lower


@compiled(MASSES)
def inert_masses(q, v, p, M):
    """Return the inertance of the pipe."""
    M[0, 0] = p[6]


_STILL = Machine(
    name="two_tanks",
    domains=("hydraulic",),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=0,
    stores=2,
    start=(1.5e-6 * 5000.0, 2.0e-6 * 3000.0),
    numbers=(
        Number(name="C_upper", value=1.5e-6, unit="m^3/Pa", free=True),
        Number(name="R_pipe", value=4e7, unit="Pa*s/m^3", free=True),
        Number(name="C_lower", value=2.0e-6, unit="m^3/Pa", free=True),
        Number(name="R_outlet", value=6e7, unit="Pa*s/m^3", free=True),
        Number(name="pipe_root", value=0.0, hidden=True),
        Number(name="outlet_root", value=0.0, hidden=True),
        Number(name="inertance", value=1.0, hidden=True),
    ),
    places=(
        Place(name="upper", cell=0),
        Place(name="lower", cell=1),
    ),
    inputs=(("pump", "m^3/s"),),
    sensors=(
        Sensor(name="p_upper", unit="Pa", noise=5.0, step=5.0),
        Sensor(name="p_lower", unit="Pa", noise=5.0, step=5.0),
    ),
    drive=Drive(size=3.5e-5, offset=5e-5, band=(0.0012, 0.02), limit=4.5e-5),
    rate=1.0,
    samples=3000,
    fine=10,
    model=MODEL,
    aliases={
        "pump": ("upper",),
        "upper": ("C_upper",),
        "lower": ("C_lower", "R_outlet"),
        "R_outlet": ("lower",),
        "R_pipe": ("pipe",),
        "pipe": ("R_pipe",),
    },
    linear=True,
    sites=(
        Site(word="leak", place="upper"),
        Site(word="overflow", place="upper", largest=0.5),
        Site(word="overflow", place="lower", largest=0.5),
        Site(word="square_root_orifice", place="R_outlet", largest=1.0,
             sets=lambda a, s: {"outlet_root": a}),
        Site(word="square_root_orifice", place="R_pipe", largest=1.0,
             sets=lambda a, s: {"pipe_root": a}),
        Site(word="square_root_orifice", place="upper"),
        Site(word="added_inertia", place="pipe", variant="inert", largest=20.0,
             sets=lambda a, s: {"inertance": a * 4e8}),
        Site(word="constant_bias", place="upper"),
        Site(word="delay", place="pump", largest=2.0),
        Site(word="lag", place="pump", largest=2.0),
        Site(word="saturation", place="pump", largest=0.5),
        Site(word="dead_zone", place="pump"),
        Site(word="sensor_bias", place="p_lower"),
        Site(word="sensor_scale", place="p_upper"),
        Site(word="sensor_nonlinearity", place="p_upper"),
        Site(word="lag", place="p_lower", largest=2.0),
        Site(word="leak", place="lower", silent=True),
        Site(word="tabulated_law", place="lower"),
    ),
)  # fmt: skip

INERT = replace(
    _STILL,
    forces=inert_forces,
    masses=inert_masses,
    coordinates=1,
)
TWO_TANKS = replace(_STILL, variants={"inert": INERT})
