"""A carriage on a spring, shaken by a force: what is known before it is measured.

Junctions have names, because names are how a diagnosis says where. One-ports (sources,
storages, losses) hang on a junction, two-ports join junctions. A parameter has a start
value, a unit, and bounds that its estimate keeps.
"""

from bondgraph import BondGraph, C, I, R, Se


def spring() -> BondGraph:
    """Return the carriage: force in, position out."""
    bench = BondGraph("carriage on a spring", domain="translation")
    bench.one("carriage", Se("force"), I("mass"), C("spring"), R("damper"))
    bench.measure("position", displacement="carriage")
    bench.parameter("mass", 1.0, "kg", bounds=(0.01, 100))
    bench.parameter("spring", 0.01, "m/N", bounds=(1e-5, 1))  # compliance, 1 / k
    bench.parameter("damper", 1.0, "N*s/m", bounds=(0, 1e3))
    return bench
