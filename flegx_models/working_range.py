"""Where the leg works: the postures in which assumptions and terms are compared."""

from collections.abc import Mapping
from itertools import product

import numpy as np

from bondgraph import ParameterSet
from flegx_models.parameters import RECONCILED
from flegx_models.parameters_motion import MOTION

Posture = Mapping[str, float]
"""The absolute angles ``hip`` and ``knee`` in rad."""

_POINTS = 5  # angles over the working range of the standing leg


def printed_posture() -> Posture:
    """Return θ1 = -θ0 and θ1 + θ2 = θ0, where the stance models are linearised."""
    angle = value_of(RECONCILED, "theta_0")
    return {"hip": -angle, "knee": angle}


def flight_postures() -> tuple[Posture, ...]:
    """Return the corners of the working range of both joints."""
    hips = [value_of(MOTION, f"hip_{end}") for end in ("steepest", "straightest")]
    knees = [value_of(MOTION, f"knee_{end}") for end in ("straightest", "steepest")]
    return tuple({"hip": hip, "knee": knee} for hip, knee in product(hips, knees))


def stance_postures() -> tuple[Posture, ...]:
    """Return the working range with the foot below the hip (eq. 4.16)."""
    first, last = value_of(MOTION, "hip_straightest"), value_of(MOTION, "hip_steepest")
    angles = map(float, np.linspace(first, last, _POINTS))
    return tuple({"hip": angle, "knee": -angle} for angle in angles)


def value_of(parameters: ParameterSet, name: str) -> float:
    """Return the value of one parameter."""
    return parameters.values_by_name()[name]
