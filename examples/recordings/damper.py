"""A banded friction damper driven by a piston: an imposed velocity and a resistance.

    python examples/recordings/prepare.py damper ../shared/recordings prepared
    bondgraph diagnose examples/recordings/damper.py \
        prepared/sine_0p5Hz_tension35lb.csv \
        --held-out prepared/sine_1Hz_tension35lb.csv

The recorded velocity is a derivative with a transient; the preparation makes one from
the displacement. The force builds up over millimetres of travel after each reversal:
hysteresis, and play (ARTS-Lab, Dataset-Friction-Damper-with-Backlash).
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
