"""Two heated masses that warm each other: heater power in, two temperatures out.

Temperatures are rises above the surroundings.
"""

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled
from benchmarks.concealed.machine import Drive, Machine, Number, Place, Sensor, Site

MODEL = '''"""Two thermal zones: a heater warms one, the other loses to the outside."""

from bondgraph import BondGraph, C, R, Sf


def zones() -> BondGraph:
    machine = BondGraph("two thermal zones", domain="thermal")
    machine.zero("zone1", Sf("heater"), C("C_1"))
    machine.one("wall", R("R_wall"))
    machine.zero("zone2", C("C_2"), R("R_outside"))
    machine.join("zone1", "wall")
    machine.join("wall", "zone2")
    machine.measure("T_1", effort="zone1")
    machine.measure("T_2", effort="zone2")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Heat flows; the wall may conduct better where it is warm."""
    first, second = z[0] / p[0], z[1] / p[2]
    wall = (first - second) / p[1] * (1.0 + p[4] * (first + second) / 2.0)
    g[0] = u[0] - wall
    g[1] = wall - second / p[3]
    stored[0], stored[1] = first, second


@compiled(MASSES)
def masses(q, v, p, M):
    """No inertia."""


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read both temperatures."""
    y[0], y[1] = z[0] / p[0], z[1] / p[2]


THERMAL_ZONES = Machine(
    name="thermal_zones",
    domains=("thermal",),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=0,
    stores=2,
    start=(200.0 * 45.0, 800.0 * 20.0),
    numbers=(
        Number(name="C_1", value=200.0, unit="J/K", free=True),
        Number(name="R_wall", value=0.5, unit="K/W", free=True),
        Number(name="C_2", value=800.0, unit="J/K", free=True),
        Number(name="R_outside", value=0.4, unit="K/W", free=True),
        Number(name="per_kelvin", value=0.0, hidden=True),
    ),
    places=(Place(name="zone1", cell=0), Place(name="zone2", cell=1)),
    inputs=(("heater", "W"),),
    sensors=(
        Sensor(name="T_1", unit="K", noise=0.01, step=0.01),
        Sensor(name="T_2", unit="K", noise=0.01, step=0.01),
    ),
    drive=Drive(size=35.0, offset=50.0, band=(0.0006, 0.01), limit=48.0),
    rate=0.5,
    samples=3000,
    fine=10,
    model=MODEL,
    aliases={
        "heater": ("zone1",),
        "zone1": ("C_1",),
        "zone2": ("C_2", "R_outside"),
        "R_wall": ("wall",),
        "R_outside": ("zone2",),
    },
    linear=True,
    sites=(
        Site(word="leak", place="zone1"),
        Site(word="radiation", place="zone1"),
        Site(word="radiation", place="zone2"),
        Site(word="temperature_dependent_resistance", place="R_wall", largest=3.0,
             sets=lambda a, s: {"per_kelvin": 0.02 * a}),
        Site(word="constant_bias", place="zone1"),
        Site(word="constant_bias", place="zone2"),
        Site(word="delay", place="heater", largest=2.0),
        Site(word="lag", place="T_2", largest=3.0),
        Site(word="lag", place="T_1", largest=3.0),
        Site(word="saturation", place="heater", largest=0.5),
        Site(word="sensor_bias", place="T_2"),
        Site(word="sensor_scale", place="T_1"),
        Site(word="sensor_nonlinearity", place="T_1"),
        Site(word="leak", place="zone2", silent=True),
        Site(word="tabulated_law", place="zone1"),
        Site(word="unknown_relation", place="T_2", law="sensor_drift"),
    ),
)  # fmt: skip
