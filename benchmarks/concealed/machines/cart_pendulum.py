"""A cart with a hanging pendulum, like a crane: a loop on the cart's position.

What the cart and the rod weigh is known, and the length of the rod; friction and the
rod's own inertia are not.
"""

import math

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

MODEL = '''"""Cart with a hanging pendulum: its position and the angle are measured."""

import sympy

from bondgraph import MTF, BondGraph, I, R, Se, displacement, p


def crane() -> BondGraph:
    machine = BondGraph("cart with a pendulum", domain="translation")
    theta, l = displacement("pivot"), sympy.Symbol("l")
    mass = sympy.Symbol("m_bob")
    weight = Se("weight", value=-9.81 * mass)
    machine.one("cart", Se("force"), I("m_cart"), R("b_cart"))
    machine.one("pivot", I("J_rod"), R("b_pivot"), domain="rotation")
    machine.one("bob_x", I("m_x", law=p / mass))
    machine.one("bob_y", I("m_y", law=p / mass), weight)
    machine.zero("sum_x")
    machine.join("bob_x", "sum_x")
    machine.join("sum_x", "cart")
    machine.join("sum_x", MTF("lever_x", l * sympy.cos(theta)), "pivot")
    machine.join("bob_y", MTF("lever_y", l * sympy.sin(theta)), "pivot")
    machine.prefer("m_cart", "integral")
    machine.prefer("J_rod", "integral")
    machine.measure("position", displacement="cart")
    machine.measure("angle", displacement="pivot")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Force on the cart, weight of the bob, friction of both."""
    pull = p[4] * p[5]
    F[0] = u[0] - p[1] * v[0] + pull * math.sin(q[1]) * v[1] ** 2
    F[1] = -p[3] * v[1] - pull * 9.81 * math.sin(q[1])
    load[0] = pull * 9.81


@compiled(MASSES)
def masses(q, v, p, M):
    """Masses and inertias; the bob moves with cart and rod."""
    M[0, 0] = p[0] + p[4] + p[6]
    M[1, 1] = p[2] + p[4] * p[5] ** 2
    M[0, 1] = M[1, 0] = p[4] * p[5] * math.cos(q[1])


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read position and angle."""
    y[0], y[1] = q[0], q[1]


CART_PENDULUM = Machine(
    name="cart_pendulum",
    domains=("translation", "rotation"),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=2,
    numbers=(
        Number(name="m_cart", value=1.2, unit="kg"),
        Number(name="b_cart", value=3.0, unit="N*s/m", free=True),
        Number(name="J_rod", value=0.006, unit="kg*m^2", free=True),
        Number(name="b_pivot", value=0.01, unit="N*m*s/rad", free=True),
        Number(name="m_bob", value=0.4, unit="kg"),
        Number(name="l", value=0.35, unit="m", free=True),
        Number(name="rider", value=0.0, hidden=True),
    ),
    places=(
        Place(name="cart", row=(1.0, 0.0)),
        Place(name="pivot", row=(0.0, 1.0), gain=0.05),
    ),
    inputs=(("force", "N"),),
    sensors=(
        Sensor(name="position", unit="m", noise=1e-4, step=1e-4),
        Sensor(name="angle", unit="rad", noise=4e-4, step=2 * math.pi / 2**13),
    ),
    drive=Drive(
        size=0.25, band=(0.15, 1.5), limit=25.0, resolution=1e-3,
        loop=Loop(kp=60.0, kd=15.0, derivative_time=0.01),
    ),
    rate=250.0,
    samples=4000,
    fine=20,
    window=500,
    model=MODEL,
    aliases={
        "force": ("cart",),
        "cart": ("m_cart", "b_cart", "sum_x"),
        "pivot": ("J_rod", "b_pivot"),
    },
    sites=(
        Site(word="coulomb_friction", place="cart"),
        Site(word="coulomb_friction", place="pivot"),
        Site(word="stribeck_friction", place="cart"),
        Site(word="stribeck_friction", place="cart", law="lugre"),
        Site(word="quadratic_drag", place="cart"),
        Site(word="spring", place="cart"),
        Site(word="hysteresis", place="cart"),
        Site(word="hysteresis", place="cart", law="maxwell_slip"),
        Site(word="end_stop", place="cart", largest=0.3),
        Site(word="constant_bias", place="cart"),
        Site(word="cogging", place="cart"),
        Site(word="added_inertia", place="cart", largest=2.0,
             sets=lambda a, s: {"rider": a}),
        Site(word="delay", place="force"),
        Site(word="dead_zone", place="force"),
        Site(word="saturation", place="force", largest=0.7),
        Site(word="sensor_bias", place="angle"),
        Site(word="sensor_scale", place="position"),
        Site(word="lag", place="angle"),
        Site(word="viscous_friction", place="cart", silent=True),
        Site(word="tabulated_law", place="cart"),
        Site(word="speed_dependent_gain", place="force"),
        Site(word="periodic_and_quadratic", place="pivot"),
        Site(word="unknown_relation", place="position", law="sensor_drift",
             largest=6.0),
    ),
)  # fmt: skip
