"""How a sentence calls a piece of physics."""

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
    "unknown_relation": "a relation without a name",
}


def name_of(physics: str) -> str:
    """Return how a sentence calls `physics`."""
    return NAMES.get(physics, physics.replace("_", " "))
