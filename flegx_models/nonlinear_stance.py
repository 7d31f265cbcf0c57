"""The two stance models before they are linearised: the lever 2 L sin θ moves.

With the foot below the hip and θ2 = -2 θ1 (eq. 4.16) the support's height is 2 L cos θ,
the same for θ1 and for the absolute knee angle θ1 + θ2 = -θ1. So both joints move the
support by the modulus -2 L sin θ of their own angle. Around θ0 of the lower leg that is
-2 L sin θ0 (eq. 4.21), around -θ0 of the upper leg +2 L sin θ0 (eq. 4.20): the sign of
the upper leg's printed transformer comes from its negative angle.

The thesis goes by the places and speeds of support and tip (eq. 4.13 to 4.15, 4.17 to
4.19) and finds the lever a second time from forces (eq. 4.22 to 4.24); a transformer
carries both.

`printed_point` is where the printed models were linearised. Like those models, these
leave out gravity, which the control compensates, and everything that
`flegx_models.planar_leg` keeps.
"""

from collections.abc import Mapping

import sympy

from bondgraph import BondGraph, ParameterSet, displacement
from flegx_models import models
from flegx_models.parameters import RECONCILED

_L, _THETA_0 = sympy.symbols("L theta_0", real=True)


def lowerleg_stance(parameters: ParameterSet = RECONCILED) -> BondGraph:
    """Return the lower leg lifting the support at any angle (figure 4.4, eq. 4.21)."""
    return models.lowerleg_stance(parameters, _lever())


def upperleg_stance(parameters: ParameterSet = RECONCILED) -> BondGraph:
    """Return the upper leg lifting the support at any angle (figure 4.5, eq. 4.20)."""
    return models.upperleg_stance(parameters, _lever())


def printed_point(model: str) -> Mapping[str, sympy.Expr]:
    """Return where a printed stance model was linearised, for ``linearise(…, at=…)``.

    Parameters
    ----------
    model
        ``lowerleg_stance`` (θ = θ0) or ``upperleg_stance`` (θ = -θ0).
    """
    sign = 1 if model == lowerleg_stance.__name__ else -1
    return {"q_joint": sign * _THETA_0}


def _lever() -> sympy.Expr:
    return -2 * _L * sympy.sin(displacement("joint"))
