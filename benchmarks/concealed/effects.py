"""From a word and an amplitude to numbers of a law, at the scale of a machine's motion.

Amplitude 1 is an effect about as large as what drives the machine. Signals have the
scale that they have in the machine without the effect.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.concealed import laws, paths
from benchmarks.concealed.machine import Machine, Place, Site


@dataclass(frozen=True, slots=True)
class Scales:
    """Typical sizes at a place: what opposes, what moves, where it has been.

    At a place that stores, ``effort`` is a flow and ``flow`` an effort: what the law
    takes away, and what it depends on.
    """

    effort: float
    flow: float
    lowest: float
    highest: float
    flow_highest: float

    @property
    def reach(self) -> float:
        """Half the range of displacement."""
        return max((self.highest - self.lowest) / 2.0, 1e-12)


Numbers = tuple[float, ...]

PLACE_LAWS: Mapping[str, tuple[int, Callable[[float, Scales], Numbers]]] = {
    "coulomb_friction": (laws.COULOMB, lambda a, s: (a * s.effort,)),
    "voltage_drop": (laws.COULOMB, lambda a, s: (a * s.effort,)),
    "stribeck_friction": (
        laws.STRIBECK,
        lambda a, s: (a * s.effort, a * s.effort, 0.2 * s.flow),
    ),
    "load_dependent_friction": (laws.LOAD, lambda a, s: (a,)),
    "direction_dependent_friction": (
        laws.DIRECTION,
        lambda a, s: (1.5 * a * s.effort, 0.5 * a * s.effort),
    ),
    "viscous_friction": (laws.VISCOUS, lambda a, s: (a * s.effort / s.flow,)),
    "leak": (laws.VISCOUS, lambda a, s: (a * s.effort / s.flow,)),
    "quadratic_drag": (laws.QUADRATIC, lambda a, s: (a * s.effort / s.flow**2,)),
    "spring": (laws.SPRING, lambda a, s: (a * s.effort / s.reach, s.lowest)),
    "hardening_spring": (laws.CUBIC, lambda a, s: (a * s.effort / s.reach**3,)),
    "gravity": (laws.GRAVITY, lambda a, s: (a * s.effort, 0.4)),
    "cogging": (
        laws.COGGING,
        lambda a, s: (a * s.effort, max(3.0, round(8.0 / s.reach)), 0.7),
    ),
    "constant_bias": (laws.BIAS, lambda a, s: (a * s.effort,)),
    "hysteresis": (laws.BOUC_WEN, lambda a, s: (a * s.effort, 0.15 * s.reach, 1.0)),
    "maxwell_slip": (laws.MAXWELL_SLIP, lambda a, s: (a * s.effort, 0.04 * s.reach)),
    "lugre": (
        laws.LUGRE,
        lambda a, s: (
            a * s.effort,
            0.6 * a * s.effort,
            0.2 * s.flow,
            a * s.effort / (0.004 * s.reach),
        ),
    ),
    "end_stop": (
        laws.STOP,
        lambda a, s: (s.highest - 2.0 * a * s.reach, -1e300),
    ),
    "tabulated_law": (laws.TABULATED, lambda a, s: (a * s.effort, 2.0 * s.flow)),
    "periodic_and_quadratic": (
        laws.PERIODIC_QUADRATIC,
        lambda a, s: (a * s.effort, 5.0 / s.reach, s.reach),
    ),
    "overflow": (
        laws.OVERFLOW,
        lambda a, s: (4.0 * s.effort / s.flow, s.flow_highest * (1.0 - a)),
    ),
    "diode": (
        laws.OVERFLOW,
        lambda a, s: (10.0 * s.effort / s.flow, s.flow_highest * (1.0 - a)),
    ),
    "square_root_orifice": (
        laws.ROOT,
        lambda a, s: (a * s.effort / np.sqrt(max(s.flow, 1e-30)),),
    ),
    "radiation": (
        laws.RADIATION,
        lambda a, s: (a * s.effort / ((s.flow + 293.0) ** 4 - 293.0**4), 293.0),
    ),
}

INPUT_LAWS: Mapping[str, tuple[int, Callable[[float, float, float, float], Numbers]]]
INPUT_LAWS = {
    "constant_bias": (paths.IN_BIAS, lambda a, u, top, T: (a * u,)),
    "input_scale": (paths.IN_SCALE, lambda a, u, top, T: (a,)),
    "saturation": (paths.IN_SATURATION, lambda a, u, top, T: ((1.0 - a) * top,)),
    "dead_zone": (paths.IN_DEAD_ZONE, lambda a, u, top, T: (a * u,)),
    "lag": (paths.IN_LAG, lambda a, u, top, T: (0.3 * a * T,)),
    "delay": (paths.IN_DELAY, lambda a, u, top, T: (0.3 * a * T,)),
    "speed_dependent_gain": (paths.IN_SPEED_GAIN, lambda a, u, top, T: (-a, 0.0)),
}
"""Numbers from amplitude, rms and peak of the input, and the shortest period T."""

OUTPUT_LAWS: Mapping[str, tuple[int, Callable[[float, float, float, float], Numbers]]]
OUTPUT_LAWS = {
    "sensor_scale": (paths.OUT_SCALE, lambda a, y, top, T: (a,)),
    "sensor_bias": (paths.OUT_BIAS, lambda a, y, top, T: (a * y,)),
    "sensor_nonlinearity": (paths.OUT_CUBIC, lambda a, y, top, T: (-a / top**2,)),
    "sensor_clipping": (paths.OUT_CLIP, lambda a, y, top, T: ((1.0 - a) * top,)),
    "sensor_drift": (paths.OUT_DRIFT, lambda a, y, top, T: (a * y / (100.0 * T),)),
    "lag": (paths.OUT_LAG, lambda a, y, top, T: (0.3 * a * T,)),
    "delay": (paths.OUT_DELAY, lambda a, y, top, T: (0.3 * a * T,)),
}


@dataclass(frozen=True, slots=True)
class Effect:
    """A site with an amplitude, and the numbers that it comes to."""

    site: Site
    amplitude: float


def kind_of_place(machine: Machine, place: str) -> str:
    """Return whether `place` is an input, an output or a place of the machine."""
    if any(name == place for name, _ in machine.inputs):
        return "input"
    if any(sensor.name == place for sensor in machine.sensors):
        return "output"
    return "place"


def law_of(site: Site) -> str:
    """Return which law a site's word stands for here."""
    return site.law or site.word


def hung(
    machine: Machine, effect: Effect, scales: Scales
) -> tuple[Place, int, Numbers]:
    """Return place, kind and numbers of a law that hangs on a place."""
    kind, numbers = PLACE_LAWS[law_of(effect.site)]
    return (
        machine.place(effect.site.place),
        kind,
        numbers(effect.amplitude, scales),
    )
