"""A brushed motor: an armature circuit and a rotor; current and speed are measured."""

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled
from benchmarks.concealed.machine import Drive, Machine, Number, Place, Sensor, Site

MODEL = '''"""DC motor: armature and rotor; current and speed are measured."""

from bondgraph import GY, BondGraph, I, R, Se


def motor() -> BondGraph:
    machine = BondGraph("DC motor", domain="electrical")
    machine.one("armature", Se("voltage"), R("R_armature"), I("L_armature"))
    machine.one("rotor", I("J_rotor"), R("b_rotor"), domain="rotation")
    machine.join("armature", GY("k_motor"), "rotor")
    machine.measure("current", flow="armature")
    machine.measure("speed", flow="rotor")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Voltage and torque balance; the winding warms where it is told to."""
    warm = p[0] * (1.0 + p[5] * z[0])
    F[0] = u[0] - warm * v[0] - p[4] * v[1]
    F[1] = p[4] * v[0] - p[3] * v[1]
    g[0] = warm * v[0] ** 2 / 4.0 - z[0] / 6.0
    stored[0] = z[0]
    load[0] = p[4] * v[0]


@compiled(MASSES)
def masses(q, v, p, M):
    """Inductance, falling with current where it is told to, and inertia."""
    M[:] = 0.0
    M[0, 0] = p[1] / (1.0 + p[6] * v[0] ** 2)
    M[1, 1] = p[2]


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read current and speed."""
    y[0], y[1] = v[0], v[1]


DC_MOTOR = Machine(
    name="dc_motor",
    domains=("electrical", "rotation"),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=2,
    stores=1,
    numbers=(
        Number(name="R_armature", value=1.2, unit="ohm", free=True),
        Number(name="L_armature", value=6e-3, unit="H", free=True),
        Number(name="J_rotor", value=2e-4, unit="kg*m^2", free=True),
        Number(name="b_rotor", value=2e-4, unit="N*m*s/rad", free=True),
        Number(name="k_motor", value=0.05, unit="N*m/A", free=True),
        Number(name="per_kelvin", value=0.0, hidden=True),
        Number(name="saturation", value=0.0, hidden=True),
    ),
    places=(
        Place(name="armature", row=(1.0, 0.0)),
        Place(name="rotor", row=(0.0, 1.0), gain=0.02),
    ),
    inputs=(("voltage", "V"),),
    sensors=(
        Sensor(name="current", unit="A", noise=5e-3, step=5e-3),
        Sensor(name="speed", unit="rad/s", noise=0.1, step=0.1),
    ),
    drive=Drive(size=9.0, band=(0.3, 12.0), limit=24.0),
    rate=1000.0,
    samples=5000,
    fine=10,
    model=MODEL,
    aliases={
        "voltage": ("armature",),
        "armature": ("R_armature", "L_armature"),
        "R_armature": ("armature",),
        "L_armature": ("armature",),
        "rotor": ("J_rotor", "b_rotor"),
    },
    linear=True,
    sites=(
        Site(word="coulomb_friction", place="rotor"),
        Site(word="stribeck_friction", place="rotor"),
        Site(word="quadratic_drag", place="rotor"),
        Site(word="constant_bias", place="rotor"),
        Site(word="hysteresis", place="rotor"),
        Site(word="voltage_drop", place="armature"),
        Site(word="temperature_dependent_resistance", place="R_armature", largest=2.0,
             sets=lambda a, s: {"per_kelvin": 0.05 * a}),
        Site(word="saturating_inertia", place="L_armature", largest=3.0,
             sets=lambda a, s: {"saturation": a / s["armature.flow"] ** 2}),
        Site(word="saturation", place="voltage", largest=0.7),
        Site(word="dead_zone", place="voltage"),
        Site(word="delay", place="voltage"),
        Site(word="lag", place="voltage"),
        Site(word="sensor_nonlinearity", place="speed"),
        Site(word="sensor_bias", place="current"),
        Site(word="lag", place="speed"),
        Site(word="viscous_friction", place="rotor", silent=True),
        Site(word="tabulated_law", place="rotor"),
        Site(word="speed_dependent_gain", place="voltage"),
    ),
)  # fmt: skip
