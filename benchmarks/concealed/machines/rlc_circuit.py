"""A resistor, a coil and a capacitor: voltage in, current and voltage out."""

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled
from benchmarks.concealed.machine import Drive, Machine, Number, Place, Sensor, Site

MODEL = '''"""RLC circuit: a source feeds a coil and a capacitor through a resistor."""

from bondgraph import BondGraph, C, I, R, Se


def circuit() -> BondGraph:
    machine = BondGraph("RLC circuit", domain="electrical")
    machine.one("loop", Se("source"), R("resistor"), I("coil"))
    machine.zero("node", C("capacitor"))
    machine.join("loop", "node")
    machine.measure("current", flow="loop")
    machine.measure("voltage", effort="node")
{parameters}
    return machine
'''


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Voltages of the loop, currents of the node; the resistor may warm."""
    charge = z[0]
    voltage = charge / p[2] + p[5] * charge**3
    F[0] = u[0] - p[0] * (1.0 + p[3] * z[1]) * v[0] - voltage
    g[0] = v[0]
    g[1] = (p[0] * v[0] ** 2 / 0.02 - z[1]) / 0.03
    stored[0] = voltage
    load[0] = voltage


@compiled(MASSES)
def masses(q, v, p, M):
    """Inductance, falling with current where it is told to."""
    M[0, 0] = p[1] / (1.0 + p[4] * v[0] ** 2)


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read current and voltage."""
    y[0], y[1] = v[0], z[0] / p[2] + p[5] * z[0] ** 3


RLC_CIRCUIT = Machine(
    name="rlc_circuit",
    domains=("electrical",),
    forces=forces,
    masses=masses,
    readings=readings,
    coordinates=1,
    stores=2,
    numbers=(
        Number(name="resistor", value=12.0, unit="ohm", free=True),
        Number(name="coil", value=1e-2, unit="H", free=True),
        Number(name="capacitor", value=1e-5, unit="F", free=True),
        Number(name="per_kelvin", value=0.0, hidden=True),
        Number(name="saturation", value=0.0, hidden=True),
        Number(name="cubic", value=0.0, hidden=True),
    ),
    places=(
        Place(name="loop", row=(1.0,)),
        Place(name="node", cell=0, gain=0.02),
    ),
    inputs=(("source", "V"),),
    sensors=(
        Sensor(name="current", unit="A", noise=2e-4, step=2e-4),
        Sensor(name="voltage", unit="V", noise=4e-3, step=5e-3),
    ),
    drive=Drive(size=4.0, band=(20.0, 900.0), limit=12.0),
    rate=20e3,
    samples=5000,
    fine=40,
    model=MODEL,
    aliases={
        "source": ("loop",),
        "loop": ("resistor", "coil"),
        "node": ("capacitor",),
        "resistor": ("loop",),
        "coil": ("loop",),
        "capacitor": ("node",),
    },
    linear=True,
    sites=(
        Site(word="voltage_drop", place="loop"),
        Site(word="voltage_drop", place="loop", largest=0.4),
        Site(word="overflow", place="node", law="diode", largest=0.8),
        Site(word="saturating_inertia", place="coil", largest=3.0,
             sets=lambda a, s: {"saturation": a / s["loop.flow"] ** 2}),
        Site(word="temperature_dependent_resistance", place="resistor", largest=3.0,
             sets=lambda a, s: {"per_kelvin": 0.3 * a}),
        Site(word="hardening_spring", place="capacitor", largest=3.0,
             sets=lambda a, s: {"cubic": a * 1e15 / s["node.flow_highest"] ** 2}),
        Site(word="leak", place="node"),
        Site(word="constant_bias", place="source"),
        Site(word="dead_zone", place="source"),
        Site(word="saturation", place="source", largest=0.7),
        Site(word="delay", place="source"),
        Site(word="sensor_scale", place="current"),
        Site(word="sensor_bias", place="current"),
        Site(word="sensor_nonlinearity", place="voltage"),
        Site(word="lag", place="current"),
        Site(word="quadratic_drag", place="loop"),
        Site(word="viscous_friction", place="loop", silent=True),
        Site(word="tabulated_law", place="loop"),
    ),
)  # fmt: skip
