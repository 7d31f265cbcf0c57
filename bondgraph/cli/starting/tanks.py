"""Two tanks in a row, filled by a pump: what is known before they are measured.

Junctions have names, because names are how a diagnosis says where. One-ports (sources,
storages, losses) hang on a junction, two-ports join junctions. A parameter has a start
value, a unit, and bounds that its estimate keeps.
"""

from bondgraph import BondGraph, C, R, Sf


def tanks() -> BondGraph:
    """Return the tanks: flow of the pump in, pressures at their bottoms out."""
    plant = BondGraph("two tanks", domain="hydraulic")
    plant.zero("upper", Sf("pump"), C("upper_area"))
    plant.one("pipe", R("capillary"))
    plant.zero("lower", C("lower_area"), R("outlet"))
    plant.bond("upper", "pipe")
    plant.bond("pipe", "lower")
    plant.measure("upper_level", effort="upper")
    plant.measure("lower_level", effort="lower")
    plant.parameter("upper_area", 1e-6, "m^3/Pa", bounds=(1e-9, 1e-3))
    plant.parameter("lower_area", 1e-6, "m^3/Pa", bounds=(1e-9, 1e-3))
    plant.parameter("capillary", 1e7, "Pa*s/m^3", bounds=(1e4, 1e10))
    plant.parameter("outlet", 1e7, "Pa*s/m^3", bounds=(1e4, 1e10))
    return plant
