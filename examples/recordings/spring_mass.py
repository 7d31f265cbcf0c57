"""One cart and one spring on an air track: a control where nothing is missing.

    bondgraph diagnose examples/recordings/spring_mass.py \
        ../shared/recordings/spring_mass_control/spring_mass.csv

Position is in camera pixels, so the model is an analogue without units; only ratios of
mass, stiffness and damping can be known from free motion, so the mass is fixed at 1.
"""

import sympy

from bondgraph import BondGraph, C, I, R, q
from bondgraph import displacement as displacement_at


def cart() -> BondGraph:
    """Return the cart, its spring with a rest position, and viscous damping."""
    track = BondGraph("cart on an air track", domain="analogue")
    stiffness, rest = sympy.symbols("stiffness rest")
    track.one("cart", I("mass"), C("spring", law=stiffness * (q - rest)), R("viscous"))
    track.measure("position", displacement_at("spring"), unit="px")
    track.parameter("mass", 1.0, std=0.0)
    track.parameter("stiffness", 10.0, bounds=(0, 1e6))
    track.parameter("rest", 0.0)
    track.parameter("viscous", 0.1, bounds=(0, 1e6))
    return track
