"""A cart on a spring: force in, position out."""

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled
from benchmarks.concealed.machine import Drive, Machine, Number, Place, Sensor, Site

MODEL = '''"""Cart with a spring and viscous friction; its position is measured."""

from bondgraph import BondGraph, C, I, R, Se


def cart() -> BondGraph:
    machine = BondGraph("cart", domain="translation")
    machine.one("cart", Se("force"), I("mass"), R("damper"), C("compliance"))
    machine.measure("position", displacement="cart")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Force, spring and damper."""
    F[0] = u[0] - p[1] * v[0] - q[0] / p[2]
    load[0] = q[0] / p[2]


@compiled(MASSES)
def masses(q, v, p, M):
    """One mass."""
    M[0, 0] = p[0]


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read the position."""
    y[0] = q[0]


CART = Machine(
    name="cart",
    domains=("translation",),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=1,
    numbers=(
        Number(name="mass", value=1.3, unit="kg", free=True),
        Number(name="damper", value=4.0, unit="N*s/m", free=True),
        Number(name="compliance", value=1 / 60.0, unit="m/N", free=True),
    ),
    places=(Place(name="cart", row=(1.0,)),),
    inputs=(("force", "N"),),
    sensors=(Sensor(name="position", unit="m", noise=1e-4, step=1e-4),),
    drive=Drive(size=8.0, band=(0.15, 4.0), limit=25.0),
    rate=250.0,
    samples=4000,
    fine=20,
    model=MODEL,
    aliases={"force": ("cart",), "cart": ("mass", "damper", "compliance")},
    linear=True,
    sites=(
        Site(word="coulomb_friction", place="cart"),
        Site(word="stribeck_friction", place="cart"),
        Site(word="direction_dependent_friction", place="cart"),
        Site(word="quadratic_drag", place="cart"),
        Site(word="hardening_spring", place="cart"),
        Site(word="constant_bias", place="cart"),
        Site(word="hysteresis", place="cart"),
        Site(word="hysteresis", place="cart", law="maxwell_slip"),
        Site(word="end_stop", place="cart", largest=0.3),
        Site(word="cogging", place="cart"),
        Site(word="saturation", place="force", largest=0.7),
        Site(word="dead_zone", place="force"),
        Site(word="delay", place="force"),
        Site(word="lag", place="position"),
        Site(word="sensor_nonlinearity", place="position"),
        Site(word="viscous_friction", place="cart", silent=True),
        Site(word="tabulated_law", place="cart"),
        Site(word="speed_dependent_gain", place="force"),
    ),
)
