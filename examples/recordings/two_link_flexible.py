"""Two joints with harmonic drives and flexible links, one carried by the other.

    bondgraph diagnose examples/recordings/two_link_flexible.py:arm --split 0.5 \
        ../shared/recordings/two_link_flexible/lqr_10deg_currents.csv

The values are the maker's (Quanser, config_2dslf), at the joints; those of the links,
which are steel strips, are known to a few per cent. The second drive acts between the
tip of the first link and its own link, so that its reaction turns the first load back.
What the linear model leaves out: the dry friction of both drives.
"""

import sympy

from bondgraph import GY, BondGraph, C, I, R, Se, Sf, displacement

NOMINAL = {
    "torque_per_ampere1": (8.925, "N*m/A", 0.0),
    "rotor1": (0.06353616, "kg*m^2", None),
    "bearing1": (4.0, "N*m*s/rad", None),
    "strip1": (1 / 39.957, "rad/(N*m)", 0.1 / 39.957),
    "arm1": (0.17043, "kg*m^2", None),
    "torque_per_ampere2": (0.87, "N*m/A", 0.0),
    "rotor2": (0.00301955, "kg*m^2", None),
    "bearing2": (1.5, "N*m*s/rad", None),
    "strip2": (1 / 6.858, "rad/(N*m)", 0.1 / 6.858),
    "arm2": (0.0064387, "kg*m^2", None),
}
"""Value, unit and standard deviation; None where it is to be fitted."""


def arm() -> BondGraph:
    """Return both stages; currents in, joint angles and link deflections out."""
    robot = BondGraph("two flexible links", domain="rotation")
    for n in ("1", "2"):
        robot.one(f"winding{n}", Sf(f"motor{n}_current"), domain="electrical")
        offset = Se(f"offset{n}", value=sympy.Symbol(f"bias{n}"))
        robot.one(f"drive{n}", I(f"rotor{n}"), R(f"bearing{n}"), offset)
        robot.zero(f"link{n}", C(f"strip{n}"))
        robot.one(f"load{n}", I(f"arm{n}"))
        robot.join(f"winding{n}", GY(f"torque_per_ampere{n}"), f"drive{n}")
        robot.join(f"drive{n}", f"link{n}")
        robot.join(f"link{n}", f"load{n}")
        robot.parameter(f"bias{n}", 0.0, "N*m")
        robot.parameter(f"gauge{n}", 0.0, "rad")
        robot.measure(f"joint{n}_angle", displacement=f"drive{n}")
        gauge = -displacement(f"strip{n}") + sympy.Symbol(f"gauge{n}")
        robot.measure(f"link{n}_deflection", gauge)
    robot.join("load1", "link2")
    for name, (value, unit, std) in NOMINAL.items():
        robot.parameter(name, value, unit, bounds=(0, 1e3), std=std)
    return robot
