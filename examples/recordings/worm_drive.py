"""A worm drive that holds a payload: speed in, motor torque out, in steady state.

    bondgraph diagnose examples/recordings/worm_drive.py --steady \
        ../shared/recordings/worm_drive/steady_map.csv \
        --map motor_speed=mean_speed --map motor_torque=mean_torque

Gear ratio and payload are the authors' (Mablekos-Alexiou, da Cruz and Bergeles, IEEE
Transactions on Robotics 37, 2021). Speed is positive when lowering.
"""

import sympy

from bondgraph import TF, BondGraph, R, Se, Sf


def drive() -> BondGraph:
    """Return motor shaft and output pulley with payload; no friction but viscous."""
    gear = BondGraph("worm drive", domain="rotation")
    load = sympy.Symbol("payload_torque")
    gear.one("motor", Sf("motor_speed"), R("viscous"))
    gear.one("output", Se("payload", value=load))
    gear.join("motor", TF("ratio"), "output")
    gear.measure("motor_torque", effort="motor_speed")
    gear.parameter("ratio", 60, std=0.0)
    gear.parameter("payload_torque", 18.8e-3, "N*m", std=0.0)
    gear.parameter("viscous", 1e-5, "N*m*s/rad", bounds=(0, 1))
    return gear
