"""A capacitor behind a resistance, fed by a recorded voltage."""

from bondgraph import BondGraph, C, R, Se


def rc_circuit() -> BondGraph:
    """Return the circuit without measurements and values, to be finished."""
    g = BondGraph("RC", domain="electrical")
    g.zero("source", Se("voltage"))
    g.one("wire", R("resistance"))
    g.zero("node", C("capacitance"))
    g.join("source", "wire")
    g.join("wire", "node")
    return g
