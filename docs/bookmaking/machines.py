"""The small machines that the cookbook leaves physics out of.

Their numbers are exact, so that what is missing is not taken for a wrong number; only
the outlet that a square law replaces is free.
"""

from bondgraph import GY, TF, BondGraph, C, FinishedGraph, I, R, Se, Sf


def cart() -> FinishedGraph:
    """Return a cart that is pushed, on a viscous track."""
    graph = BondGraph("cart", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("track"))
    graph.parameter("mass", 2.0, "kg", std=0.0)
    graph.parameter("track", 3.0, "N*s/m", std=0.0)
    graph.measure("speed", flow="carriage")
    graph.measure("position", displacement="carriage")
    return graph.finish()


def oscillator() -> FinishedGraph:
    """Return a mass on a spring without any loss."""
    graph = BondGraph("oscillator", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), C("spring"))
    graph.parameter("mass", 2.0, "kg", std=0.0)
    graph.parameter("spring", 0.02, "m/N", std=0.0)
    graph.measure("position", displacement="carriage")
    return graph.finish()


def shaft() -> FinishedGraph:
    """Return a shaft that turns all around, with a bearing."""
    graph = BondGraph("shaft", domain="rotation")
    graph.one("shaft", Se("torque"), I("wheel"), R("bearing"))
    graph.parameter("wheel", 0.1, "kg*m^2", std=0.0)
    graph.parameter("bearing", 0.15, "N*m*s/rad", std=0.0)
    graph.measure("speed", flow="shaft")
    graph.measure("angle", displacement="shaft")
    return graph.finish()


def worm_drive() -> FinishedGraph:
    """Return a motor that carries a varying load through a gear."""
    graph = BondGraph("worm drive", domain="rotation")
    graph.one("motor", Se("torque"), I("rotor"), R("bearing"))
    graph.one("joint", Se("load"), I("arm"))
    graph.join("motor", TF("gear"), "joint")
    graph.parameter("rotor", 0.02, "kg*m^2", std=0.0)
    graph.parameter("bearing", 0.05, "N*m*s/rad", std=0.0)
    graph.parameter("arm", 0.5, "kg*m^2", std=0.0)
    graph.parameter("gear", 4.0, "1", std=0.0)
    graph.measure("speed", flow="motor")
    graph.measure("angle", displacement="motor")
    return graph.finish()


def belt() -> FinishedGraph:
    """Two masses with an elastic belt between them."""
    graph = BondGraph("belt", domain="translation")
    graph.one("near", Se("force"), I("pulley"))
    graph.zero("coupling", C("spring"))
    graph.one("far", I("load"), R("brake"))
    graph.join("near", "coupling")
    graph.join("coupling", "far")
    graph.parameter("pulley", 1.0, "kg", std=0.0)
    graph.parameter("load", 1.5, "kg", std=0.0)
    graph.parameter("spring", 0.02, "m/N", std=0.0)
    graph.parameter("brake", 3.0, "N*s/m", std=0.0)
    graph.measure("far_position", displacement="far")
    return graph.finish()


def two_axes() -> FinishedGraph:
    """Return two axes of a head, each held by its cables, that nothing joins."""
    graph = BondGraph("two axes", domain="rotation")
    for axis in ("pan", "tilt"):
        parts = (I(f"{axis}_mass"), C(f"{axis}_cable"), R(f"{axis}_bearing"))
        graph.one(axis, Se(f"{axis}_torque"), *parts)
        graph.parameter(f"{axis}_mass", 0.1, "kg*m^2", std=0.0)
        graph.parameter(f"{axis}_cable", 0.2, "rad/(N*m)", std=0.0)
        graph.parameter(f"{axis}_bearing", 0.03, "N*m*s/rad", std=0.0)
        graph.measure(f"{axis}_angle", displacement=axis)
        graph.measure(f"{axis}_speed", flow=axis)
    return graph.finish()


def winding() -> FinishedGraph:
    """Return the winding of a motor that turns a flywheel."""
    graph = BondGraph("motor", domain="electrical")
    graph.one("winding", Se("voltage"), I("inductance"), R("resistance"))
    graph.one("shaft", I("rotor"), R("bearing"), domain="rotation")
    graph.join("winding", GY("k_m"), "shaft")
    graph.parameter("inductance", 0.05, "H", std=0.0)
    graph.parameter("resistance", 1.0, "ohm", std=0.0)
    graph.parameter("k_m", 0.3, "V*s/rad", std=0.0)
    graph.parameter("rotor", 0.05, "kg*m^2", std=0.0)
    graph.parameter("bearing", 0.05, "N*m*s/rad", std=0.0)
    graph.measure("current", flow="winding")
    return graph.finish()


def rail() -> FinishedGraph:
    """Return a capacitor that is charged and loaded."""
    graph = BondGraph("supply rail", domain="electrical")
    graph.zero("rail", Sf("charger"), C("capacitor"), R("load"))
    graph.parameter("capacitor", 0.3, "F", std=0.0)
    graph.parameter("load", 4.0, "ohm", std=0.0)
    graph.measure("voltage", effort="rail")
    return graph.finish()


def pipe() -> FinishedGraph:
    """Return a rigid line that a pump feeds against a resistance."""
    graph = BondGraph("line", domain="hydraulic")
    graph.zero("line", Sf("pump"), R("outlet"))
    graph.parameter("outlet", 2.0, "Pa*s/m^3", std=0.0)
    graph.measure("pressure", effort="line")
    return graph.finish()


def closed_tank() -> FinishedGraph:
    """Return a tank that is filled, and that nothing leaves."""
    graph = BondGraph("closed tank", domain="hydraulic")
    graph.zero("tank", Sf("inflow"), C("area"))
    graph.parameter("area", 0.5, "m^3/Pa", std=0.0)
    graph.measure("pressure", effort="tank")
    return graph.finish()


def draining_tank() -> FinishedGraph:
    """Return a tank that is filled, with an outlet taken to be linear."""
    graph = BondGraph("draining tank", domain="hydraulic")
    graph.zero("tank", Sf("inflow"), C("area"), R("outlet"))
    graph.parameter("area", 0.5, "m^3/Pa", std=0.0)
    graph.parameter("outlet", 4.0, "Pa*s/m^3")
    graph.measure("pressure", effort="tank")
    return graph.finish()


def two_tanks() -> FinishedGraph:
    """Return a tank that is filled, and another that it drains into."""
    graph = BondGraph("two tanks", domain="hydraulic")
    graph.zero("upper", Sf("inflow"), C("upper_area"))
    graph.one("pipe", R("friction"))
    graph.zero("lower", C("lower_area"), R("outlet"))
    graph.join("upper", "pipe")
    graph.join("pipe", "lower")
    graph.parameter("upper_area", 0.5, "m^3/Pa", std=0.0)
    graph.parameter("friction", 2.0, "Pa*s/m^3", std=0.0)
    graph.parameter("lower_area", 0.5, "m^3/Pa", std=0.0)
    graph.parameter("outlet", 2.0, "Pa*s/m^3", std=0.0)
    graph.measure("upper_pressure", effort="upper")
    graph.measure("lower_pressure", effort="lower")
    return graph.finish()


def heated_block() -> FinishedGraph:
    """Return a heated block that loses heat, its temperature counted from the room."""
    graph = BondGraph("heated block", domain="thermal")
    graph.zero("block", Sf("heater"), C("capacity"), R("loss"))
    graph.parameter("capacity", 20.0, "J/K", std=0.0)
    graph.parameter("loss", 8.0, "K/W", std=0.0)
    graph.measure("temperature", effort="block")
    return graph.finish()
