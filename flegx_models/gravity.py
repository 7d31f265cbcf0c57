"""Gravity compensation: the torques that carry the leg, from the graph's own weights.

In flight the support is held and the links hang from it (eq. 5.3 to 5.5); in stance the
foot is held and everything above it is carried (eq. 5.6 to 5.8); the counterweight
pulls the support up (eq. 6.5). The torques are the motors', on absolute angles, which
is what eq. 5.1 and 5.2 make of the relative ones. Here they are the derivatives of one
potential: the weights are effort sources of `flegx_models.jump.leg_graph`, and the
torque that holds a joint is what they leave on it at rest.

Three degrees of freedom carry three forces. In stance the ground's push is the third:
it balances the support. The thesis's virtual work, and this, leave the foot free to
slide: no force along the ground. With a foot that holds, only one combination of the
two torques is fixed by gravity; the thesis's choice is the one that asks no grip.
"""

from dataclasses import dataclass

import numpy as np
import sympy

from bondgraph import BondGraphError, ParameterSet
from flegx_models.jump.mechanics import symbolic_mechanics
from flegx_models.parameters_control import CONTROL

CASES = ("flight", "stance", "counterweight")
"""The three compensations that the thesis prints."""

_ANGLES = sympy.symbols("q_hip q_knee")


@dataclass(frozen=True, slots=True)
class FeedForward:
    """T_hip = hip · sin θ1, T_knee = knee · sin(θ1 + θ2), factors in N·m."""

    hip: float
    knee: float

    def torques(self, hip: float, knee: float) -> tuple[float, float]:
        """Return the joint torques in N·m at these absolute angles."""
        return self.hip * float(np.sin(hip)), self.knee * float(np.sin(knee))


def printed_feed_forward(case: str) -> FeedForward:
    """Return eq. 5.5 (``flight``), 5.8 (``stance``) or 6.5 (``counterweight``)."""
    _known(case)
    values = CONTROL.values_by_name()
    return FeedForward(values[f"gravity_hip_{case}"], values[f"gravity_knee_{case}"])


def derived_feed_forward(case: str) -> tuple[sympy.Expr, sympy.Expr]:
    """Return the torques of hip and knee that hold the leg, in symbols.

    Angles are ``q_hip`` and ``q_knee``, the counterweight ``m_counterweight``.
    """
    _known(case)
    _, bias, foot = symbolic_mechanics()
    speeds = sympy.symbols("v_support v_hip v_knee")
    weights = bias.xreplace(dict.fromkeys(speeds, sympy.S.Zero))
    up = foot.row(1)
    lift = sympy.S.Zero
    if case == "counterweight":
        g = next(s for s in bias.free_symbols if s.name == "g")
        lift = g * sympy.Symbol("m_counterweight", positive=True)
    # The support's row: held in flight, balanced by the ground's push otherwise.
    push = sympy.S.Zero if case == "flight" else -(weights[0] + lift)
    hip, knee = (sympy.factor(sympy.expand(-weights[k] - up[k] * push)) for k in (1, 2))
    return hip, knee


def feed_forward(case: str, parameters: ParameterSet) -> FeedForward:
    """Return the derived compensation as numbers.

    Parameters
    ----------
    parameters
        See `flegx_models.jump.leg_graph.leg_parameters`.
    """
    values = parameters.values_by_name()
    values |= CONTROL.restricted(("m_counterweight",)).values_by_name()
    factors = []
    for torque, angle in zip(derived_feed_forward(case), _ANGLES, strict=True):
        factor = torque / sympy.sin(angle)
        used = (s for s in factor.free_symbols if s.name in values)
        number = sympy.simplify(factor.xreplace({s: values[s.name] for s in used}))
        factors.append(float(number))
    return FeedForward(*factors)


def _known(case: str) -> None:
    if case not in CASES:
        raise BondGraphError(
            f"There is no gravity compensation for {case!r}.",
            (case,),
            f"Choose one of {', '.join(CASES)}.",
        )
