"""A DC motor that turns a flywheel: what is known of it before it is measured.

Junctions have names, because names are how a diagnosis says where. One-ports (sources,
storages, losses) hang on a junction, two-ports join junctions. A parameter has a start
value, a unit, and bounds that its estimate keeps.
"""

from bondgraph import GY, BondGraph, I, R, Se


def motor() -> BondGraph:
    """Return the motor: voltage in, current and speed out."""
    drive = BondGraph("motor", domain="rotation")
    drive.one("winding", Se("voltage"), R("resistance"), domain="electrical")
    drive.one("shaft", I("inertia"), R("bearing"))
    drive.join("winding", GY("torque_constant"), "shaft")
    drive.measure("current", flow="winding")
    drive.measure("speed", flow="shaft")
    drive.parameter("resistance", 2.0, "ohm", bounds=(0.1, 100))
    drive.parameter("torque_constant", 0.05, "N*m/A", bounds=(1e-3, 10))
    drive.parameter("inertia", 1e-4, "kg*m^2", bounds=(1e-7, 1))
    drive.parameter("bearing", 1e-5, "N*m*s/rad", bounds=(0, 1))
    return drive
