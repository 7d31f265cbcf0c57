"""The leg between its worm gears and the ground, drawn as a bond graph.

What the worm wheels and the ground see: two links, a support that slides vertically,
and forces from outside. The inputs are the torques that the wheels pass on to the
joints (``T_hip``, ``T_knee``) and the forces on the foot (``F_x``, ``F_y``). Motors,
gearboxes and worms lie on the other side of the wheels; they are one reflected inertia
each (`flegx_models.jump.worm`). The counterweight hangs on a rope that can only pull,
so the rope is no bond but a constraint, like the ground, and its weight is not here.

Both angles are absolute, zero where a link hangs straight down: ``hip`` is θ1, ``knee``
θ1 + θ2 (section 4.1). Links are rigid, as in chapter 4; the tendons' 0.25 kg are left
out, as in eq. 5.3 and 5.6.
"""

import sympy

from bondgraph import MTF, BondGraph, I, ParameterSet, Se, displacement, p
from flegx_models.parameters import PRINTED
from flegx_models.parameters_control import CONTROL

_L, _A, _B, _G = sympy.symbols("L l_cm_upperleg l_cm_lowerleg g")
_M1, _M2, _M = sympy.symbols("m_upperleg m_lowerleg_link m_motors_support")
_I1, _I2 = sympy.symbols("I_upperleg_link I_lowerleg")
_HIP, _KNEE = displacement("hip"), displacement("knee")

_USED = (
    "g",
    "l_cm_upperleg",
    "l_cm_lowerleg",
    "m_upperleg",
    "m_lowerleg_link",
    "I_upperleg_link",
    "I_lowerleg",
    "I_gear",
    "I_gear_tendons",
)


def leg_parameters() -> ParameterSet:
    """Return the printed masses and inertias with chapter 5's L and support mass.

    Eq. 5.4 and 5.7 need L = 0.30 m and a support of 7.6 kg, so that the printed
    feed-forward carries exactly this leg. Section 3.3.1 weighs 6.6 kg; the two worm
    wheels, which turn about the hip axis and are carried by the support, are
    2.97 - 1.93 = 1.04 kg (section 3.3.3) and make it 7.6.
    """
    own = CONTROL.restricted(("L_gravity", "m_support_gravity")).values_by_name()
    base = PRINTED.restricted((*_USED, "L", "m_motors_support"))
    return base.with_values(
        {"L": own["L_gravity"], "m_motors_support": own["m_support_gravity"]}
    )


def leg_graph(parameters: ParameterSet | None = None) -> BondGraph:
    """Return the leg with joint torques and foot forces as inputs.

    Outputs are the angles ``theta_hip`` and ``theta_knee`` (rad), the ``height`` of
    the support (m) against its start, and the foot's velocity ``foot_x``, ``foot_y``.
    """
    leg = BondGraph("leg between worm wheels and ground", domain="rotation")
    weight = Se("weight_support", value=-_M * _G)
    leg.one("support", I("m_motors_support"), weight, domain="translation")
    upper = I("J_upperleg", law=p / (_I1 - _M1 * _A**2))
    lower = I("J_lowerleg", law=p / (_I2 - _M2 * _B**2))
    leg.one("hip", Se("T_hip"), I("I_gear"), upper)
    leg.one("knee", Se("T_knee"), I("I_gear_tendons"), lower)
    _mass(leg, "upperleg", _M1, {"hip": _A})
    _mass(leg, "lowerleg", _M2, {"hip": _L, "knee": _B})
    for axis in ("x", "y"):
        leg.one(f"foot_{axis}", Se(f"F_{axis}"), domain="translation")
        _moved(leg, f"foot_{axis}", axis, {"hip": _L, "knee": _L})
    return _finished(leg, leg_parameters() if parameters is None else parameters)


def _mass(
    leg: BondGraph, link: str, mass: sympy.Symbol, arms: dict[str, sympy.Symbol]
) -> None:
    """Add the velocities of a link's centre of mass, its inertia and its weight."""
    for axis in ("x", "y"):
        place = f"{link}_{axis}"
        weight = [Se(f"weight_{link}", value=-mass * _G)] if axis == "y" else []
        inertia = I(f"m_{place}", law=p / mass)
        leg.one(place, inertia, *weight, domain="translation")
        _moved(leg, place, axis, arms)


def _moved(
    leg: BondGraph, place: str, axis: str, arms: dict[str, sympy.Symbol]
) -> None:
    """Let `place` move with the joints by their arms, and along y with the support."""
    way = {"x": sympy.cos, "y": sympy.sin}[axis]
    total = f"sum_{place}"
    leg.zero(total, domain="translation")
    leg.join(place, total)
    if axis == "y":
        leg.join(total, "support")
    for joint, arm in arms.items():
        lever = arm * way({"hip": _HIP, "knee": _KNEE}[joint])
        leg.join(total, MTF(f"{joint}_{place}", lever), joint)


def _finished(leg: BondGraph, parameters: ParameterSet) -> BondGraph:
    # These three momenta tell all speeds in any posture.
    for carrier in ("I_gear", "I_gear_tendons", "m_motors_support"):
        leg.prefer(carrier, "integral")
    leg.measure("height", displacement="support")
    leg.measure("theta_hip", displacement="hip")
    leg.measure("theta_knee", displacement="knee")
    leg.measure("foot_x", flow="foot_x")
    leg.measure("foot_y", flow="foot_y")
    leg.take(parameters)
    return leg
