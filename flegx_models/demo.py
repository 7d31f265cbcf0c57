"""The machine of ``bondgraph demo``: the lower leg drive as an engineer would draw it.

The graph is `flegx_models.models.lowerleg_flight` with a load torque on the joint and
the numbers of the data sheets. It has no friction in the worm, which the thesis could
not measure and names as the one uncertain thing (chapter 4). What the machine really
does comes from `flegx_models.concealed_drive`.
"""

from dataclasses import replace

from bondgraph import TF, BondGraph, I, ParameterSet, R, Se
from flegx_models.parameters import PRINTED


def drive() -> BondGraph:
    """Return the lower leg drive: motor torque and load torque in, joint angle out."""
    leg = BondGraph("lowerleg drive", domain="rotation")
    leg.one("motor", Se("T_motor"), I("I_motor"), I("I_gearbox"))
    leg.one("worm", I("I_worm"))
    leg.one(
        "joint",
        *(Se("T_load"), R("c_friction_lowerleg")),
        *(I("I_gear_tendons"), I("I_lowerleg")),
    )
    leg.join("motor", TF("K_gearbox"), "worm")
    leg.join("worm", TF("K_worm_gear"), "joint")
    leg.measure("theta", displacement="joint")
    leg.take(nominal())
    return leg


def nominal() -> ParameterSet:
    """Return the printed parameters with only the identifiable ones free.

    An angle alone shows the total inertia reflected to the joint, 99 % of it the
    motor's, and the total viscous friction. So the motor's inertia and the friction are
    starting guesses (``std=None``); all else is held at its printed value.
    """
    free = {"I_motor", "c_friction_lowerleg"}
    return ParameterSet(
        tuple(
            replace(parameter, std=None if parameter.name in free else 0.0)
            for parameter in PRINTED.members
        )
    )
