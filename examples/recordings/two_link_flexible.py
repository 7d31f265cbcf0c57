"""Two joints with harmonic drives and flexible links, one carried by the other.

    bondgraph diagnose examples/recordings/two_link_flexible.py:arm --split 0.5 \
        --time-limit 30 \
        ../shared/recordings/two_link_flexible/lqr_10deg_currents.csv

The values are the maker's (Quanser, config_2dslf), at the joints. The second stage
rides on the tip of the first: the torque of its drive turns the first load back, and
since its centre of mass lies beside the joint, the two loads share an inertia. What
the linear model leaves out: the dry friction of both drives, and that both gauges read
late. The four hide each other: the search takes a third of an hour on two cores.
"""

import sympy

from bondgraph import GY, BondGraph, C, I, IField, R, Se, Sf, displacement

NOMINAL = {
    "rotor1": (0.06353616, "kg*m^2"),
    "strip1": (1 / 39.957, "rad/(N*m)"),
    "arm1": (0.17043, "kg*m^2"),
    "rotor2": (0.00301955, "kg*m^2"),
    "strip2": (1 / 6.858, "rad/(N*m)"),
    "arm2": (0.0064387, "kg*m^2"),
}
"""Value and unit; the machine is within a factor of two of them."""

LOSSES = {"bearing1": 4.0, "bearing2": 1.5}
TORQUES = {"torque_per_ampere1": 8.925, "torque_per_ampere2": 0.87}


def arm() -> BondGraph:
    """Return both stages; currents in, joint angles and link deflections out."""
    robot = BondGraph("two flexible links", domain="rotation")
    for n in ("1", "2"):
        robot.one(f"winding{n}", Sf(f"motor{n}_current"), domain="electrical")
        offset = Se(f"offset{n}", value=sympy.Symbol(f"bias{n}"))
        robot.one(f"drive{n}", I(f"rotor{n}"), R(f"bearing{n}"), offset)
        robot.zero(f"link{n}", C(f"strip{n}"))
        robot.one(f"load{n}")
        robot.join(f"winding{n}", GY(f"torque_per_ampere{n}"), f"drive{n}")
        robot.join(f"drive{n}", f"link{n}")
        robot.join(f"link{n}", f"load{n}")
        robot.parameter(f"bias{n}", 0.0, "N*m")
        robot.parameter(f"gauge{n}", 0.0, "rad")
        robot.measure(f"joint{n}_angle", displacement=f"drive{n}")
        gauge = -displacement(f"strip{n}") + sympy.Symbol(f"gauge{n}")
        robot.measure(f"link{n}_deflection", gauge)
    robot.join("load1", "link2")
    arm1, arm2, shared = sympy.symbols("arm1 arm2 shared")
    inertia = [[arm1, shared], [shared, arm2]]
    robot.put(IField.from_matrix("arms", inertia), on=("load1", "load2"))
    robot.parameter("shared", 0.005, "kg*m^2", bounds=(0, 0.02))
    for name, (value, unit) in NOMINAL.items():
        robot.parameter(name, value, unit, bounds=(value / 2, 2 * value))
    for name, value in LOSSES.items():
        robot.parameter(name, value, "N*m*s/rad", bounds=(0, 100))
    for name, value in TORQUES.items():
        robot.parameter(name, value, "N*m/A", std=0.0)
    return robot
