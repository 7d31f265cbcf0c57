"""EMPS positioning system: the naive model, carriage mass and viscous friction.

    bondgraph diagnose examples/recordings/emps.py ../shared/recordings/emps/train.csv

The physics it leaves out is dry friction of the carriage (Janot, Gautier and Brunot,
"Data Set and Reference Models of EMPS", 2019).
"""

import sympy

from bondgraph import BondGraph, I, R, Se


def carriage() -> BondGraph:
    """Return the carriage driven by a force, its position measured."""
    axis = BondGraph("EMPS carriage", domain="translation")
    bias = sympy.Symbol("bias")
    axis.one(
        "carriage",
        Se("motor_force"),
        I("mass"),
        R("viscous"),
        Se("amplifier_offset", value=bias),
    )
    axis.measure("position", displacement="carriage")
    axis.parameter("mass", 100, "kg", bounds=(1, 1e4))
    axis.parameter("viscous", 200, "N*s/m", bounds=(0, 1e5))
    axis.parameter("bias", 0, "N")
    return axis
