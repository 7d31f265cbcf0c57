"""A banded friction damper driven by a piston: an imposed velocity and a resistance.

    bondgraph diagnose examples/recordings/damper.py \
        ../shared/recordings/damper/sine_0p5Hz_tension35lb.csv \
        --held-out ../shared/recordings/damper/sine_1Hz_tension35lb.csv

Its force builds up over millimetres of travel after each reversal: hysteresis with
memory, for which the library has no law yet, so the honest answer is "unexplained"
(ARTS-Lab, Dataset-Friction-Damper-with-Backlash).
"""

import sympy

from bondgraph import BondGraph, R, Se, Sf


def damper() -> BondGraph:
    """Return the rod with viscous friction and a constant force."""
    rod = BondGraph("friction damper", domain="translation")
    rod.one(
        "rod", Sf("velocity"), R("viscous"), Se("offset", value=sympy.Symbol("bias"))
    )
    rod.measure("friction_force", effort="velocity")
    rod.parameter("viscous", 1e5, "N*s/m", bounds=(0, 1e8))
    rod.parameter("bias", 0.0, "N")
    return rod
