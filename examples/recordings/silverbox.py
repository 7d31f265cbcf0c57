"""Silverbox, an electronic Duffing oscillator: a linear mass, spring and damper.

    bondgraph diagnose examples/recordings/silverbox.py \
        ../shared/recordings/silverbox/multisine_1_to_9.csv --split 0.5

Everything is in volts, so the model is an analogue. What it leaves out is the part of
the spring that hardens (Wigren and Schoukens, European Control Conference 2013).
"""

import sympy

from bondgraph import BondGraph, C, I, R, Se, displacement, q


def oscillator() -> BondGraph:
    """Return the oscillator with a linear spring and a small offset."""
    stiffness, offset = sympy.symbols("stiffness offset")
    circuit = BondGraph("Silverbox", domain="analogue")
    circuit.one(
        "mass",
        Se("drive"),
        I("inertia"),
        C("spring", law=stiffness * q + offset),
        R("viscous"),
    )
    circuit.measure("response", displacement("spring"), unit="V")
    circuit.parameter("inertia", 4e-6, bounds=(1e-9, 1))
    circuit.parameter("stiffness", 1.0, bounds=(1e-3, 1e3))
    circuit.parameter("offset", 0.0)
    circuit.parameter("viscous", 2e-4, bounds=(0, 1))
    return circuit
