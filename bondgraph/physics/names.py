"""How a sentence calls a piece of physics, in the words of the domain it is in."""

from collections.abc import Mapping

from bondgraph.structure.domains import ELECTRICAL, HYDRAULIC, THERMAL

NAMES = {
    "coulomb_friction": "Coulomb (dry) friction",
    "stribeck_friction": "Stribeck friction",
    "load_dependent_friction": "load-dependent friction",
    "direction_dependent_friction": "direction-dependent friction",
    "viscous_friction": "viscous friction",
    "quadratic_drag": "quadratic drag",
    "constant_bias": "a constant bias",
    "gravity": "gravity",
    "spring": "a spring",
    "hardening_spring": "a hardening spring",
    "added_inertia": "added inertia",
    "leak": "a leak",
    "square_root_orifice": "a square-root orifice",
    "one_way_passage": "a one-way passage (check valve)",
    "unknown_relation": "a relation without a name",
}

ELSEWHERE = {
    HYDRAULIC.name: {
        "coulomb_friction": "a pressure that has to be overcome",
        "viscous_friction": "laminar resistance",
        "quadratic_drag": "turbulent flow (quadratic drag)",
        "spring": "a stock on the way",
        "hardening_spring": "a stock that stiffens",
        "added_inertia": "inertia of the fluid",
    },
    ELECTRICAL.name: {
        "viscous_friction": "a resistance",
        "quadratic_drag": "a resistance that grows with the current (quadratic drag)",
        "spring": "a capacitance on the way",
        "hardening_spring": "a capacitance that falls with its charge",
        "added_inertia": "added inductance",
        "saturating_inertia": "saturation of the iron",
        "one_way_passage": "a one-way passage (diode)",
    },
    THERMAL.name: {
        "viscous_friction": "a thermal resistance",
        "spring": "a heat capacity on the way",
        "hardening_spring": "a heat capacity that falls as it warms",
        "leak": "a path for heat (leak)",
        "one_way_passage": "a one-way passage (thermal diode)",
    },
}
"""What a mechanical name would not say."""

SOFTER = {
    "a hardening spring": "a spring that softens",
    "a stock that stiffens": "a stock that softens",
    "a capacitance that falls with its charge": "a capacitance that grows with charge",
    "a heat capacity that falls as it warms": "a heat capacity that grows as it warms",
}
"""What a law is called whose cubic number is negative."""


def name_of(physics: str, domain: str = "") -> str:
    """Return how a sentence calls `physics` in the domain of that name."""
    usual = NAMES.get(physics, physics.replace("_", " "))
    return ELSEWHERE.get(domain, {}).get(physics, usual)


def name_with(numbers: Mapping[str, float], physics: str, domain: str = "") -> str:
    """Return the same where the sign of one of its numbers makes it another thing."""
    name = name_of(physics, domain)
    softens = any(n.startswith("cubic") and x < 0.0 for n, x in numbers.items())
    return SOFTER.get(name, name) if softens else name
