"""The four rigid FlegX models, drawn as in the thesis's figures 4.2 to 4.5.

Motor, worm and joint are 1-junctions on one rigid train; the gearbox and the worm gear
are transformers between them. In stance the joint also lifts the support: the
transformer of eq. 4.20 and 4.21 leads from the vertical motion of motors and support
to the joint, with the modulus ∓2 L sin θ0 or, in `flegx_models.nonlinear_stance`,
2 L sin θ of the moving angle.

The input is the motor torque ``T_motor``, the output the joint angle ``theta``. No gain
and no number is written here; see `flegx_models.parameters`.
"""

import sympy

from bondgraph import TF, BondGraph, I, ParameterSet, R, Se
from flegx_models.parameters import RECONCILED

_L, _THETA_0 = sympy.symbols("L theta_0")
_LEVER = 2 * _L * sympy.sin(_THETA_0)  # eq. 4.20


def lowerleg_flight(parameters: ParameterSet = RECONCILED) -> BondGraph:
    """Return the lower leg hanging free (figure 4.2, eq. 4.2 to 4.7)."""
    leg = _train("lowerleg, flight phase")
    _lowerleg_joint(leg)
    return _finished(leg, parameters)


def upperleg_flight(parameters: ParameterSet = RECONCILED) -> BondGraph:
    """Return the upper leg hanging free (figure 4.3, eq. 4.8 to 4.12)."""
    leg = _train("upperleg, flight phase")
    _upperleg_joint(leg)
    return _finished(leg, parameters)


def lowerleg_stance(
    parameters: ParameterSet = RECONCILED, lever: sympy.Expr = -_LEVER
) -> BondGraph:
    """Return the lower leg lifting the support (figure 4.4, eq. 4.25 to 4.30).

    ``m_lowerleg`` is the thesis's name for all leg mass that moves with the support.

    Parameters
    ----------
    lever
        Speed of the support per speed of the joint, m/rad; eq. 4.21 linearised.
    """
    leg = _train("lowerleg, stance phase")
    _lowerleg_joint(leg)
    _support(leg, "m_lowerleg", lever)
    return _finished(leg, parameters)


def upperleg_stance(
    parameters: ParameterSet = RECONCILED, lever: sympy.Expr = _LEVER
) -> BondGraph:
    """Return the upper leg lifting the support (figure 4.5, eq. 4.31 to 4.35).

    The friction e9 is missing from the list of equations in section 4.3.2 but present
    in eq. 4.33 to 4.35, and here.

    Parameters
    ----------
    lever
        Speed of the support per speed of the joint, m/rad; eq. 4.20 linearised.
    """
    leg = _train("upperleg, stance phase")
    _upperleg_joint(leg)
    _support(leg, "m_upperleg", lever)
    return _finished(leg, parameters)


def _train(name: str) -> BondGraph:
    """Return the motor and worm shafts, which all four models share."""
    leg = BondGraph(name, domain="rotation")
    leg.one("motor", Se("T_motor"), I("I_motor"), I("I_gearbox"))
    leg.one("worm", I("I_worm"))
    leg.join("motor", TF("K_gearbox"), "worm")
    return leg


def _lowerleg_joint(leg: BondGraph) -> None:
    leg.one("joint", R("c_friction_lowerleg"), I("I_gear_tendons"), I("I_lowerleg"))


def _upperleg_joint(leg: BondGraph) -> None:
    leg.one("joint", R("c_friction_upperleg"), I("I_gear"), I("I_upperleg"))


def _support(leg: BondGraph, links: str, modulus: sympy.Expr) -> None:
    """Add the vertical motion of motors, support and the mass called `links`.

    The half arrow runs from the support to the joint, against the thesis's figure,
    because then the transformer's modulus is the thesis's ratio: f_support =
    modulus · f_joint and e_joint = modulus · e_support (eq. 4.20 to 4.24).
    """
    leg.one("support", I("m_motors_support"), I(links), domain="translation")
    leg.join("support", TF("K_support", modulus), "joint")


def _finished(leg: BondGraph, parameters: ParameterSet) -> BondGraph:
    leg.join("worm", TF("K_worm_gear"), "joint")
    leg.measure("theta", displacement="joint")
    leg.take(parameters)
    return leg
