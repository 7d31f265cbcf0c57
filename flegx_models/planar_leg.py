"""The whole leg in its plane: both joints, gravity, slider and ground (eq. 4.1).

Two bodies hang on a support that slides vertically. The angles are absolute and zero
where a link hangs straight down: ``hip`` is θ1, ``knee`` is θ1 + θ2, because through
the tendons the knee motor, which sits on the support, turns the lower leg against the
*support* (section 4.1). x points forward, y up; eq. 4.13 and 4.15 follow.

Each mass has a 1-junction per axis. Its velocity is a sum of joint speeds times levers
L cos θ or L sin θ: a 0-junction per axis, a modulated transformer per lever. Half
arrows run from the masses to the joints, as in the stance models. Weights are effort
sources on the y-junctions; the ground holds the foot by sources of zero flow, whose
efforts are its reactions. Nothing here is linearised, decoupled or compensated.

The bearings of knee and floating worm wheel turn with θ2 (section 2.1.2), so their
friction hangs on the relative speed of the two links.
"""

from collections.abc import Mapping

import sympy

from bondgraph import (
    MTF,
    TF,
    BondGraph,
    C,
    FinishedGraph,
    I,
    InsertElement,
    ParameterSet,
    R,
    Se,
    Sf,
    displacement,
    p,
    q,
)
from flegx_models.parameters import RECONCILED
from flegx_models.parameters_chapter3 import CHAPTER_3

JOINTS = ("hip", "knee")
"""The two joints, by the names of their junctions."""

CARRIERS = {"hip": "I_gear", "knee": "I_gear_tendons"}
"""The inertance on each joint whose momentum is the state that tells its speed."""

_HIP, _KNEE = map(displacement, JOINTS)
_L, _G, _THETA_KNEE, _K_WORM = sympy.symbols("L g theta_knee K_worm_gear")
_L_UPPER, _L_LOWER = sympy.symbols("l_cm_upperleg l_cm_lowerleg")
_M_UPPER, _M_LOWER = sympy.symbols("m_upperleg m_lowerleg_link")
_M_SUPPORT = sympy.Symbol("m_motors_support")
_M_EQ, _F_1 = sympy.symbols("m_eq f_1")
_I_UPPER, _I_LOWER = sympy.symbols("I_upperleg_link I_lowerleg")

# A lever: a length and the angle at which it stands, for each joint that turns it.
_Levers = Mapping[str, tuple[tuple[sympy.Expr, sympy.Expr], ...]]
_FOOT: _Levers = {"hip": ((_L, _HIP),), "knee": ((_L, _KNEE),)}


def flying_leg(parameters: ParameterSet = RECONCILED) -> BondGraph:
    """Return the leg in the air: the support slides freely, three degrees of freedom.

    Inputs are the motor torques ``T_hip`` and ``T_knee`` (N·m), outputs the absolute
    angles ``theta_hip`` and ``theta_knee`` (rad) and the ``height`` of the support (m)
    against where it started.
    """
    leg = _leg("leg in flight", JOINTS)
    leg.measure("height", displacement="support")
    return _finished(leg, parameters)


def hanging_leg(parameters: ParameterSet = RECONCILED) -> BondGraph:
    """Return the leg whose support is held: the flight tests of section 6.1.1.

    The output ``force_holder`` (N) is what holds the support, upwards.
    """
    leg = _leg("leg hanging from a held support", JOINTS)
    leg.put(Sf("holder", value=sympy.S.Zero), on="support")
    leg.measure("force_holder", effort="holder")
    return _finished(leg, parameters)


def rigid_leg(parameters: ParameterSet = RECONCILED) -> BondGraph:
    """Return the upper leg with the lower one as a point mass fixed at θ_knee.

    The reading of section 4.2.2: a held support, no knee drive, and a relative knee
    angle that does not move, ``theta_knee`` = π/4.
    """
    leg = BondGraph("upperleg with the lowerleg fixed to it", domain="rotation")
    leg.one("support", Sf("holder", value=sympy.S.Zero), domain="translation")
    _upper(leg, ("hip",))
    fixed = ((_L, _HIP), (_L_LOWER, _HIP + _THETA_KNEE))
    _mass(leg, "lowerleg", _M_LOWER, {"hip": fixed})
    leg.measure("theta_hip", displacement="hip")
    leg.take(parameters)
    return leg


def standing_leg(
    parameters: ParameterSet = RECONCILED, drives: tuple[str, ...] = JOINTS
) -> BondGraph:
    """Return the leg whose foot neither sinks nor slips (eq. 4.15 to 4.18).

    One degree of freedom is left: with the foot below the hip, θ2 = -2 θ1. The outputs
    ``ground_x`` and ``ground_y`` (N) are the forces of the ground on the foot. The two
    angles must start where the foot is where it is meant to be.

    Parameters
    ----------
    drives
        The joints whose motor and gears are there. The stance models of the thesis
        have one each; the leg has both.
    """
    leg = _standing("leg on the ground", drives)
    _foot(leg, "x")
    leg.measure("ground_x", effort="soil_x")
    return _finished(leg, parameters)


def springy_leg(parameters: ParameterSet = RECONCILED) -> BondGraph:
    """Return the standing leg whose lower link bends (figure 2.2).

    The foot yields across the link, against a spring of the stiffness that the first
    natural frequency gives the link's equivalent mass: k = m_eq (2π f_1)² (section
    3.1.3). The bending is small against L: levers are those of the straight link, whose
    mass between its ends it does not move. The output ``bending`` (m) is how far the
    foot has yielded.
    """
    leg = _leg("leg on the ground with a flexible link", JOINTS)
    stiffness = _M_EQ * (2 * sympy.pi * _F_1) ** 2
    leg.one("link", C("bend", law=stiffness * q), domain="translation")
    across: _Levers = {**_FOOT, "link": ((sympy.S.One, _KNEE),)}
    for axis in ("x", "y"):
        _foot(leg, axis, across)
    leg.measure("bending", displacement="link")
    leg.measure("height", displacement="support")
    leg.take(CHAPTER_3.restricted((_M_EQ.name, _F_1.name)))
    return _finished(leg, parameters)


def sliding_leg(parameters: ParameterSet = RECONCILED) -> BondGraph:
    """Return the leg whose foot slides on the ground without friction."""
    return _finished(_standing("leg on slippery ground", JOINTS), parameters)


def locked(leg: BondGraph, joint: str) -> FinishedGraph:
    """Return `leg` with a joint, or the knee's ``bearings``, held by a rigid lock."""
    lock = InsertElement(joint, Sf(f"lock_{joint}", value=sympy.S.Zero))
    return lock.apply(leg.finish())


def _standing(name: str, drives: tuple[str, ...]) -> BondGraph:
    leg = _leg(name, drives)
    _foot(leg, "y")
    leg.measure("height", displacement="support")
    leg.measure("ground_y", effort="soil_y")
    return leg


def _leg(name: str, drives: tuple[str, ...]) -> BondGraph:
    """Return support, two joints with their drives, and two links with weight."""
    leg = BondGraph(name, domain="rotation")
    weight = Se("weight_support", value=-_M_SUPPORT * _G)
    leg.one("support", I("m_motors_support"), weight, domain="translation")
    _upper(leg, drives)
    about_centre = p / (_I_LOWER - _M_LOWER * _L_LOWER**2)
    leg.one("knee", I("I_gear_tendons"), I("J_lowerleg", law=about_centre))
    _drive(leg, "knee", drives)
    # θ2' = knee - hip turns in the bearings.
    leg.one("bearings", R("c_friction_lowerleg"))
    leg.zero("theta2")
    leg.join("knee", "theta2")
    leg.join("theta2", "hip")
    leg.join("theta2", "bearings")
    levers = {"hip": ((_L, _HIP),), "knee": ((_L_LOWER, _KNEE),)}
    _mass(leg, "lowerleg", _M_LOWER, levers)
    return leg


def _upper(leg: BondGraph, drives: tuple[str, ...]) -> None:
    """Add the hip with its drive, and the upper leg."""
    about_centre = p / (_I_UPPER - _M_UPPER * _L_UPPER**2)
    upper = I("J_upperleg", law=about_centre)
    leg.one("hip", R("c_friction_upperleg"), I("I_gear"), upper)
    _drive(leg, "hip", drives)
    _mass(leg, "upperleg", _M_UPPER, {"hip": ((_L_UPPER, _HIP),)})


def _drive(leg: BondGraph, joint: str, drives: tuple[str, ...]) -> None:
    """Add motor, gearbox and worm of a joint; both drives have the same parameters."""
    if joint not in drives:
        return
    train = BondGraph("drive", domain="rotation")
    train.one("motor", I("I_motor"), I("I_gearbox"))
    train.one("worm", I("I_worm"))
    train.join("motor", TF("K_gearbox"), "worm")
    same = ("I_motor", "I_gearbox", "I_worm", "K_gearbox")
    part = leg.include(train, joint, shared=same)
    leg.put(Se(f"T_{joint}"), on=part["motor"])
    leg.join(part["worm"], TF(f"{joint}_worm_gear", _K_WORM), joint)


def _mass(leg: BondGraph, link: str, mass: sympy.Symbol, levers: _Levers) -> None:
    """Add a link's two velocities of its centre of mass, its inertia and its weight."""
    for axis in ("x", "y"):
        place = f"{link}_{axis}"
        weight = [Se(f"weight_{link}", value=-mass * _G)] if axis == "y" else []
        inertia = I(f"m_{place}", law=p / mass)
        leg.one(place, inertia, *weight, domain="translation")
        _moved(leg, place, axis, levers)


def _foot(leg: BondGraph, axis: str, levers: _Levers = _FOOT) -> None:
    """Hold the foot along one axis."""
    place = f"foot_{axis}"
    soil = Sf(f"soil_{axis}", value=sympy.S.Zero)
    leg.one(place, soil, domain="translation")
    _moved(leg, place, axis, levers)


def _moved(leg: BondGraph, place: str, axis: str, levers: _Levers) -> None:
    """Let `place` move with the joints by `levers`, and along y with the support."""
    way = {"x": sympy.cos, "y": sympy.sin}[axis]
    total = place
    if axis == "y" or len(levers) > 1:
        total = f"sum_{place}"
        leg.zero(total, domain="translation")
        leg.join(place, total)
    if axis == "y":
        leg.join(total, "support")
    for joint, parts in levers.items():
        lever = sympy.Add(*(length * way(angle) for length, angle in parts))
        leg.join(total, MTF(f"{joint}_{place}", lever), joint)


def _finished(leg: BondGraph, parameters: ParameterSet) -> BondGraph:
    # The joints' speeds tell everything at any posture; the support's height does not
    # tell the angles of a straight leg.
    for carrier in CARRIERS.values():
        leg.prefer(carrier, "integral")
    for joint in JOINTS:
        leg.measure(f"theta_{joint}", displacement=joint)
    leg.take(parameters)
    return leg
