"""A DC motor that drives a disc through a shaft, simulated without any library code.

Semi-implicit Euler at a fine step; dry friction is set-valued (a clip that can hold).
What can be concealed: dry friction at load or motor, a weight on the load, drag, play
in the shaft, and a drop of voltage at the brushes.
"""

import numpy as np
from numba import njit

from bondgraph import GY, BondGraph, C, I, R, Recording, Se, bind_to, displacement

STEP, FINE = 0.004, 100
CONCEALED = {
    "none": {},
    "coulomb_load": {"coulomb_load": 0.012},
    "coulomb_motor": {"coulomb_motor": 0.012},
    "gravity": {"weight": 0.02},
    "drag": {"drag": 1e-5},
    "backlash": {"play": 0.012},
    "brush": {"brush": 0.5},
}
PLACES = {
    "none": (),
    "coulomb_load": ("load",),
    "coulomb_motor": ("motor",),
    "gravity": ("load",),
    "drag": ("load",),
    "backlash": ("twist", "shaft"),
    "brush": ("armature", "voltage"),
}
TRUE = {
    "resistance": 1.0,
    "inductance": 8e-3,
    "torque_constant": 0.05,
    "rotor": 1e-4,
    "rotor_friction": 1e-4,
    "stiffness": 1.0,
    "damping": 1e-3,
    "disc": 4e-4,
    "disc_friction": 2e-4,
}
KINDS = ("coulomb_load", "coulomb_motor", "weight", "drag", "play", "brush")


@njit
def _run(u, p, concealed, out):
    resistance, inductance, k, rotor, rub, stiffness, damping, disc, drift = p
    dry_load, dry_motor, weight, drag, play, brush = concealed
    i = motor = load = twist = angle = 0.0
    h = STEP / FINE
    for n in range(len(u)):
        out[n, 0], out[n, 1], out[n, 2] = angle, i, angle - twist
        following = u[min(n + 1, len(u) - 1)]
        for j in range(FINE):
            volt = u[n] + (following - u[n]) * j / FINE
            drop = brush * np.tanh(i / 0.01)
            i += h * (volt - resistance * i - k * motor - drop) / inductance
            bent = twist - min(max(twist, -play), play)
            touching = play == 0.0 or bent != 0.0
            torque = stiffness * bent + (damping * (motor - load) if touching else 0.0)
            free = motor + h * (k * i - torque - rub * motor) / rotor
            motor = np.sign(free) * max(abs(free) - h * dry_motor / rotor, 0.0)
            sum_ = torque - drift * load - drag * load * abs(load)
            sum_ -= weight * np.sin(angle - twist)
            free = load + h * sum_ / disc
            load = np.sign(free) * max(abs(free) - h * dry_load / disc, 0.0)
            twist += h * (motor - load)
            angle += h * motor


def drive(*, load_encoder):
    """Return the naive model at nominal values."""
    graph = BondGraph("drive", domain="rotation")
    graph.one(
        "armature", Se("voltage"), R("resistance"), I("inductance"), domain="electrical"
    )
    graph.one("motor", I("rotor"), R("rotor_friction"))
    graph.zero("shaft")
    graph.one("twist", C("compliance"), R("damping"))
    graph.one("load", I("disc"), R("disc_friction"))
    graph.join("armature", GY("torque_constant"), "motor")
    graph.join("motor", "shaft")
    graph.join("shaft", "twist")
    graph.join("shaft", "load")
    graph.measure("angle", displacement="motor")
    graph.measure("current", flow="armature")
    if load_encoder:
        load = displacement("motor") - displacement("compliance")
        graph.measure("load_angle", load, unit="rad")
    bounds = (1e-9, 1e6)
    for name, unit in (
        ("resistance", "ohm"),
        ("inductance", "H"),
        ("torque_constant", "N*m/A"),
        ("rotor", "kg*m^2"),
        ("rotor_friction", "N*m*s/rad"),
        ("damping", "N*m*s/rad"),
        ("disc", "kg*m^2"),
        ("disc_friction", "N*m*s/rad"),
    ):
        graph.parameter(name, TRUE[name], unit, bounds=bounds)
    graph.parameter("compliance", 1.0, "rad/(N*m)", bounds=bounds)
    return graph.finish()


def recorded(graph, truth, seed, *, samples=2000):
    """Return a recording of a drive that conceals `truth`, 10 % off nominal."""
    random = np.random.default_rng(seed)
    time = np.arange(samples) * STEP
    frequencies, phases = random.uniform(0.1, 4, 10), random.uniform(0, 2 * np.pi, 10)
    waves = np.sin(2 * np.pi * np.outer(time, frequencies) + phases)
    voltage = 3.0 * waves.sum(axis=1) / np.sqrt(5)
    true = np.array([v * random.uniform(0.9, 1.1) for v in TRUE.values()])
    concealed = np.array([CONCEALED[truth].get(kind, 0.0) for kind in KINDS])
    out = np.empty((samples, 3))
    _run(voltage, true, concealed, out)
    out += random.standard_normal(out.shape) * [5e-4, 0.02, 5e-4]
    channels = {
        "voltage": (voltage, "V"),
        "angle": (out[:, 0], "rad"),
        "current": (out[:, 1], "A"),
        "load_angle": (out[:, 2], "rad"),
    }
    if len(graph.measurements) == 2:
        del channels["load_angle"]
    return bind_to(graph, Recording.from_arrays(truth, time, channels))
