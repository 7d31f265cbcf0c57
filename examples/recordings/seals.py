"""An O-ring that seals a pneumatic piston: constant friction beside the pressure.

    python examples/recordings/prepare.py seals ../shared/recordings prepared
    bondgraph diagnose examples/recordings/seals.py:seal prepared/o_ring_1bar.csv \
        prepared/o_ring_5bar.csv --held-out prepared/o_ring_7bar.csv

The rod is pushed slowly into a chamber at constant pressure; the laser gives its
position, from which the preparation makes a velocity. What it leaves out: the friction
of the seal grows with the pressure (E. Zillen, thesis, Delft).
"""

import sympy

from bondgraph import TF, BondGraph, R, Se, Sf, f

SLOW = 2e-4
"""Speed in m/s below which the laser does not tell the direction."""


def seal() -> BondGraph:
    """Return rod and chamber: imposed velocity, constant friction, pressure."""
    cylinder = BondGraph("O-ring seal", domain="translation")
    friction, bias = sympy.symbols("friction bias")
    cylinder.one(
        "rod",
        Sf("velocity"),
        R("seal", law=friction * sympy.tanh(f / SLOW)),
        Se("load_cell_offset", value=bias),
    )
    cylinder.zero("chamber", Se("pressure"), domain="hydraulic")
    cylinder.join("chamber", TF("area"), "rod")
    cylinder.measure("force", effort="velocity")
    cylinder.parameter("friction", 5.0, "N", bounds=(0, 100))
    cylinder.parameter("bias", 0.0, "N")
    cylinder.parameter("area", 4.9e-4, "m^2", bounds=(-1e-2, 1e-2))
    return cylinder
