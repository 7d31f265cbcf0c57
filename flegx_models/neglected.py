"""What chapter 4 leaves out: h(q, q̇), G(q) and the bending of the lower link.

h is small because the drives' reflected inertia is large and the leg slow; gravity is
not small and is compensated by feed-forward. `neglected` gives both over the range in
which the leg works, beside what a motor can do; `weighted_poles` shows how the leg
moves by itself where nothing compensates its weight. `bending` shows where a rigid
link stops being one: on the ground the link bends against the drives' inertia, far
below the 35 Hz at which it rings by itself.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from bondgraph import FinishedGraph, ParameterSet, state_space
from flegx_models.equation_of_motion import Leg
from flegx_models.parameters import RECONCILED
from flegx_models.parameters_control import CONTROL
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.parameters_motion import MOTION
from flegx_models.planar_leg import (
    JOINTS,
    flying_leg,
    hanging_leg,
    springy_leg,
    standing_leg,
)
from flegx_models.working_range import (
    Posture,
    flight_postures,
    printed_posture,
    stance_postures,
    value_of,
)

_LEGS = {"hanging": hanging_leg, "flying": flying_leg, "standing": standing_leg}
_ROUNDING = 1e-6  # relative, of eigenvalues
_FRICTIONLESS = {"c_friction_upperleg": 0.0, "c_friction_lowerleg": 0.0}


@dataclass(frozen=True, slots=True, kw_only=True)
class Neglected:
    """The greatest acceleration over the working range that one term makes.

    Parameters
    ----------
    leg, joint, term
        ``hanging``, ``flying`` or ``standing``; ``h`` (centrifugal, at the squat's
        speed) or ``G`` (gravity, not compensated).
    acceleration
        rad/s², magnitude.
    share
        Of what the motor's nominal torque makes of this joint.
    """

    leg: str
    joint: str
    term: str
    acceleration: float
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Bending:
    """What the bending of the lower link does to the standing leg at θ0.

    Parameters
    ----------
    joint, crossover
        The joint that is controlled, and its printed crossover frequency in rad/s.
    resonance
        rad/s, of the leg bending against both drives.
    alone, opposed
        Relative change of the magnitude of angle per motor torque at the crossover,
        against rigid links: this motor alone, and the other opposing it.
    """

    joint: str
    crossover: float
    resonance: float
    alone: float
    opposed: float


def neglected(parameters: ParameterSet = RECONCILED) -> tuple[Neglected, ...]:
    """Return what h and G of eq. 4.1 do over the working range; friction is no part."""
    return tuple(
        row
        for name, factory in _LEGS.items()
        for row in _neglected_of(
            name,
            Leg(factory(parameters).finish().with_parameters(_FRICTIONLESS)),
            stance_postures() if name == "standing" else flight_postures(),
        )
    )


def _neglected_of(
    name: str, leg: Leg, postures: tuple[Posture, ...]
) -> Iterator[Neglected]:
    speed, torque = (
        value_of(MOTION, "speed"),
        value_of(DATASHEETS, "motor_nominal_torque"),
    )
    speeds = [
        dict(zip(leg.joints, signs, strict=True))
        for signs in product((speed, -speed), repeat=len(leg.joints))
    ]
    largest: dict[tuple[str, str], tuple[float, float]] = {}
    for posture, moving in product(postures, speeds):
        motion = leg.equation_of_motion(posture, moving)
        driven = leg.ratio * torque * np.diag(np.linalg.inv(motion.mass))
        for term, force in (("h", motion.velocity), ("G", motion.gravity)):
            found = np.abs(np.linalg.solve(motion.mass, force))
            for joint, value, own in zip(leg.joints, found, driven, strict=True):
                old = largest.get((joint, term), (0.0, 0.0))
                largest[joint, term] = max(old, (float(value), float(value / own)))
    for (joint, term), (acceleration, share) in largest.items():
        yield Neglected(
            leg=name, joint=joint, term=term, acceleration=acceleration, share=share
        )


def weighted_poles(parameters: ParameterSet = RECONCILED) -> dict[str, complex]:
    """Return the fastest pole (1/s) of each leg at θ0 under its weight alone.

    Imaginary where the leg swings, positive where it falls, zero where it floats.
    Without friction, and without the feed-forward that balances the weight.
    """
    fastest = {}
    for name, factory in _LEGS.items():
        graph = factory(parameters).finish().with_parameters(_FRICTIONLESS)
        poles = state_space(graph, at=_at_theta_0()).poles()
        # Poles come as pairs ±: of two as fast the one that grows, whatever rounding.
        fast = poles[np.abs(poles) > (1 - _ROUNDING) * np.abs(poles).max()]
        fastest[name] = complex(max(fast, key=lambda pole: pole.real))
    return fastest


def bending(parameters: ParameterSet = RECONCILED) -> tuple[Bending, ...]:
    """Return what the bending of the link changes for the knee's and the hip's loop."""
    weightless = {"g": 0.0}
    springy = springy_leg(parameters).finish().with_parameters(weightless)
    rigid = standing_leg(parameters).finish().with_parameters(weightless)
    free = state_space(springy.with_parameters(_FRICTIONLESS), at=_at_theta_0())
    resonance = float(np.abs(free.poles()).max())
    rows = []
    for joint, loop in (("knee", "lowerleg"), ("hip", "upperleg")):
        crossover = value_of(CONTROL, f"crossover_{loop}_stance")
        bent, stiff = (_responses(g, joint, crossover) for g in (springy, rigid))
        alone, opposed = (b / s - 1 for b, s in zip(bent, stiff, strict=True))
        rows.append(
            Bending(
                joint=joint,
                crossover=crossover,
                resonance=resonance,
                alone=alone,
                opposed=opposed,
            )
        )
    return tuple(rows)


def _responses(
    graph: FinishedGraph, joint: str, frequency: float
) -> tuple[float, float]:
    """Return |angle / torque| of a joint: its motor alone, and opposed by the other."""
    (other,) = set(JOINTS) - {joint}
    system = state_space(graph, at=_at_theta_0())
    row = system.response(np.array([frequency]))[0][
        system.outputs.index(f"theta_{joint}")
    ]
    own = row[system.inputs.index(f"T_{joint}")]
    return abs(own), abs(own - row[system.inputs.index(f"T_{other}")])


def _at_theta_0() -> dict[str, float]:
    return {f"q_{joint}": printed_posture()[joint] for joint in JOINTS}
