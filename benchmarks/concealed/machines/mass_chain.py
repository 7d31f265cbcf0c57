"""Three masses and springs in a row from a wall: force on the first mass.

In the variant ``series`` the first link has another spring behind it, which lets its
damper go in no time; the small steps are smaller there.
"""

from dataclasses import replace

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled
from benchmarks.concealed.machine import Drive, Machine, Number, Place, Sensor, Site

MODEL = '''"""Three masses in a row, with springs and dampers between them."""

from bondgraph import BondGraph, C, I, R, Se


def chain() -> BondGraph:
    machine = BondGraph("chain of masses", domain="translation")
    machine.one("mass1", Se("force"), I("m1"), C("c1"), R("d1"))
    machine.one("mass2", I("m2"))
    machine.one("mass3", I("m3"))
    machine.zero("between12")
    machine.zero("between23")
    machine.one("link12", C("c2"), R("d2"))
    machine.one("link23", C("c3"), R("d3"))
    machine.join("mass1", "between12")
    machine.join("between12", "link12")
    machine.join("between12", "mass2")
    machine.join("mass2", "between23")
    machine.join("between23", "link23")
    machine.join("between23", "mass3")
    machine.measure("x1", displacement="mass1")
    machine.measure("x3", displacement="mass3")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Springs and dampers; the last spring may have play.

    The first link may have a spring in series; the store is the stretch of the rest.
    """
    first = q[0] / p[3] + p[6] * v[0]
    second = (q[0] - q[1]) / p[4] + p[7] * (v[0] - v[1])
    g[0] = 0.0
    if p[10] > 0.0:
        second = (q[0] - q[1] - z[0]) / p[10]
        g[0] = (second - z[0] / p[4]) / p[7]
    stretch = q[1] - q[2]
    free = min(max(stretch, -p[9]), p[9])
    third = (stretch - free) / p[5]
    if p[9] == 0.0 or free != stretch:
        third += p[8] * (v[1] - v[2])
    F[0] = u[0] - first - second
    F[1] = second - third
    F[2] = third
    load[0] = third


@compiled(MASSES)
def masses(q, v, p, M):
    """Diagonal."""
    M[:] = 0.0
    for i in range(3):
        M[i, i] = p[i]


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read the first and the last position."""
    y[0], y[1] = q[0], q[2]


STIFFEST = 0.02
"""Of the spring in series, as a share of the link's: its steps would be too long."""

_PLAIN = Machine(
    name="mass_chain",
    domains=("translation",),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=3,
    stores=1,
    numbers=(
        Number(name="m1", value=1.0, unit="kg", free=True),
        Number(name="m2", value=1.5, unit="kg", free=True),
        Number(name="m3", value=1.0, unit="kg", free=True),
        Number(name="c1", value=1 / 300.0, unit="m/N", free=True),
        Number(name="c2", value=1 / 400.0, unit="m/N", free=True),
        Number(name="c3", value=1 / 250.0, unit="m/N", free=True),
        Number(name="d1", value=2.0, unit="N*s/m", free=True),
        Number(name="d2", value=1.0, unit="N*s/m", free=True),
        Number(name="d3", value=1.0, unit="N*s/m", free=True),
        Number(name="half_gap", value=0.0, hidden=True),
        Number(name="series", value=0.0, hidden=True),
    ),
    places=(
        Place(name="mass1", row=(1.0, 0.0, 0.0)),
        Place(name="mass2", row=(0.0, 1.0, 0.0)),
        Place(name="mass3", row=(0.0, 0.0, 1.0)),
        Place(name="link12", row=(1.0, -1.0, 0.0)),
        Place(name="link23", row=(0.0, 1.0, -1.0)),
    ),
    inputs=(("force", "N"),),
    sensors=(
        Sensor(name="x1", unit="m", noise=5e-5, step=5e-5),
        Sensor(name="x3", unit="m", noise=5e-5, step=5e-5),
    ),
    drive=Drive(size=12.0, band=(0.2, 6.0), limit=40.0),
    rate=250.0,
    samples=4000,
    fine=20,
    model=MODEL,
    aliases={
        "force": ("mass1",),
        "mass1": ("m1", "c1", "d1"),
        "mass2": ("m2",),
        "mass3": ("m3",),
        "link12": ("between12", "c2", "d2"),
        "between12": ("link12", "mass1", "mass2"),
        "link23": ("between23", "c3", "d3"),
    },
    linear=True,
    sites=(
        Site(word="coulomb_friction", place="mass1"),
        Site(word="coulomb_friction", place="mass2"),
        Site(word="coulomb_friction", place="mass3"),
        Site(word="stribeck_friction", place="mass3"),
        Site(word="quadratic_drag", place="mass3"),
        Site(word="viscous_friction", place="mass3"),
        Site(word="spring", place="mass3"),
        Site(word="hardening_spring", place="link12"),
        Site(word="hardening_spring", place="mass1"),
        Site(word="backlash", place="link23", largest=0.5,
             sets=lambda a, s: {"half_gap": a * s["link23.reach"]}),
        Site(word="hysteresis", place="link12"),
        Site(word="added_compliance", place="between12", law="compliance",
             variant="series", largest=3.0,
             sets=lambda a, s: {"series": max(a, STIFFEST) / 400.0}),
        Site(word="end_stop", place="mass3", largest=0.3),
        Site(word="constant_bias", place="mass3"),
        Site(word="delay", place="force"),
        Site(word="dead_zone", place="force"),
        Site(word="saturation", place="force", largest=0.7),
        Site(word="sensor_scale", place="x3"),
        Site(word="lag", place="x1"),
        Site(word="viscous_friction", place="mass1", silent=True),
        Site(word="tabulated_law", place="mass2"),
    ),
)  # fmt: skip

MASS_CHAIN = replace(_PLAIN, variants={"series": replace(_PLAIN, fine=80)})
