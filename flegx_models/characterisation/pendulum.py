"""Mass, centre, inertia and friction of a swinging part.

Hung horizontally, a part's weight gives a torque m g L_cm; let free, it swings with
I θ'' + c θ' + m g L_cm sin θ = 0 (eq. 3.25, 3.26). Frequency and decay of the
swing then give the inertia and the friction.

What the thesis prints and what is right
----------------------------------------
- Eq. 3.27 is headed T/θ; what it shows is θ/T.
- Eq. 3.32 prints ζ = δ²/√(4π² + δ²). A swing of damping ζ shrinks by exp(-ζ ω T_d) per
  period with ω T_d = 2π/√(1 - ζ²), so δ = 2π ζ/√(1 - ζ²) and ζ = δ/√(4π² + δ²). Eq.
  3.31 has the same root and is right. With eq. 3.29 every friction of section 3.3 is
  too small by the factor δ: hip 1.67e-2 → 4.5e-2, knee 4.23e-4 → 3.5e-3, lower leg with
  gear 2.08e-3 → 7.5e-3 N·m·s. The inertias stay as they are.
- "L_cm = I/m" of section 3.3.3 is T/(m g).
- ΔI = I_gear + 2 m r of section 3.3.4 lacks the square of r.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import sympy

from bondgraph import BondGraph, C, I, R, Se, q
from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.free_decay import Decay


@dataclass(frozen=True, slots=True, kw_only=True)
class SwingingPart:
    """What free oscillation and weight torque say about a part.

    Parameters
    ----------
    inertia, inertia_std
        About the axis, kg·m².
    friction, friction_std
        Viscous coefficient c, N·m·s.
    """

    inertia: float
    inertia_std: float
    friction: float
    friction_std: float


def swinging_part(
    decay: Decay, *, weight_torque: float, weight_torque_std: float = 0.0
) -> SwingingPart:
    """Return I = m g L_cm/ω_n² and c = 2 ζ ω_n I (eq. 3.28 and 3.29).

    Parameters
    ----------
    decay
        Of the free oscillation; its damping factor is the correct one.
    weight_torque, weight_torque_std
        m g L_cm, measured with the part horizontal, N·m.
    """
    omega = decay.natural_frequency
    inertia = weight_torque / omega**2
    friction = 2 * decay.damping_factor * omega * inertia
    weight = weight_torque_std / weight_torque
    turning = decay.frequency_std / decay.frequency
    losing = decay.decrement_std / decay.decrement
    # c is as δ m g L / f; how ω_n and the root depend on δ is of second order.
    return SwingingPart(
        inertia=inertia,
        inertia_std=inertia * math.hypot(weight, 2 * turning),
        friction=friction,
        friction_std=abs(friction) * math.hypot(weight, turning, losing),
    )


def centre_of_mass(weight_torque: float, *, mass: float, gravity: float) -> float:
    """Return L_cm = T/(m g), m, from the torque of the horizontal part (3.3.3)."""
    return weight_torque / (mass * gravity)


def joint_centre(parts: Iterable[tuple[float, float]]) -> float:
    """Return Σ m L / Σ m, m, of parts (mass, centre) on one line (eq. 3.33)."""
    pairs = tuple(parts)
    return sum(m * x for m, x in pairs) / sum(m for m, _ in pairs)


def inertia_of_point(mass: float, *, radius: float) -> float:
    """Return m r², kg·m². Section 3.3.4 prints 2 m r for two tendons."""
    return mass * radius**2


def tendon_radius(
    inertia_difference: float, *, gear_inertia: float, tendon_mass: float
) -> float:
    """Return r of ΔI = I_gear + 2 m r², m: where the tendons' ends would move.

    Parameters
    ----------
    inertia_difference
        ΔI of the lower leg with and without gear and tendons, kg·m².
    gear_inertia
        kg·m².
    tendon_mass
        Of one tendon, kg.

    Raises
    ------
    CharacterisationError
        If the gear alone has more inertia than the difference.
    """
    rest = inertia_difference - gear_inertia
    if rest < 0:
        raise CharacterisationError(
            f"The gear has {gear_inertia:g} kg·m², more than the difference "
            f"{inertia_difference:g}.",
            ("inertia_difference",),
            "Check the two inertias; their rounding may exceed the difference.",
        )
    return math.sqrt(rest / (2 * tendon_mass))


def pendulum(
    *, inertia: float, friction: float, weight_torque: float, free: bool = True
) -> BondGraph:
    """Return eq. 3.25 as a bond graph, sin θ kept, to fit a recorded swing with.

    Input ``T_joint`` in N·m (zero in a free swing), output ``theta`` from the lowest
    position. Linearised at rest, theta over T_joint is eq. 3.27. A swing determines
    inertia and friction over the weight torque; so that is exact here.

    Parameters
    ----------
    inertia, friction, weight_torque
        I in kg·m², c in N·m·s, m g L_cm in N·m.
    free
        Whether inertia and friction are starting guesses that a fit may change.
    """
    std = None if free else 0.0
    graph = BondGraph("physical pendulum", domain="rotation")
    law = sympy.Symbol("T_weight") * sympy.sin(q)
    graph.one("joint", Se("T_joint"), I("I_part"), R("c_bearing"), C("weight", law=law))
    graph.measure("theta", displacement="joint")
    positive = (0.0, math.inf)
    graph.parameter("I_part", inertia, "kg*m^2", bounds=positive, std=std)
    graph.parameter("c_bearing", friction, "N*m*s", bounds=positive, std=std)
    graph.parameter("T_weight", weight_torque, "N*m", std=0.0)
    return graph
