"""What laws of dry friction are made of: the sign of a flow, and what is slow.

The sign is written smooth, ``tanh(f / f_s)`` with a flow f_s 300 times below the
typical one, and ten times below the least row of a steady table; that flow is a
parameter of the inserted element, marked exact. A fit that has ended goes on with a
sharper edge where that tells (`diagnosis.search.sharper`).
"""

from dataclasses import dataclass

import sympy

from bondgraph.physics.places.base import Coefficient, F
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.signals import f

REGULARISATION, OF_THE_LEAST = 1 / 300, 0.1


def direction(place: OneJunctionPlace) -> tuple[sympy.Expr, Coefficient]:
    """Return the smooth sign of the flow and the coefficient that smooths it."""
    narrow = min(REGULARISATION * place.flow, OF_THE_LEAST * place.least_flow)
    width = place.edge("slip_flow", place.unit(F), narrow)
    return sympy.tanh(f / width.symbol), width


@dataclass(frozen=True, slots=True)
class Slow:
    """What multiplies a friction where it is slow, a share for each direction.

    Stribeck's effect, as slow worm gears show it: it may take from the friction the one
    way and add to it the other. The shares are bounded so that what is left still takes
    power.
    """

    factor: sympy.Expr
    coefficients: tuple[Coefficient, ...]
    words: str = "and changes in each by a share of its own where it is slow"


def changing_when_slow(place: OneJunctionPlace, sign: sympy.Expr) -> Slow:
    """Return the factor, its coefficients, and how it is told."""
    ahead = place.strength("slow_rise_ahead", "1", low=-1.0, high=5.0)
    back = place.strength("slow_rise_back", "1", low=-1.0, high=5.0)
    speeds = (0.1 * place.flow, 0.4 * place.flow)
    low = 0.02 * place.flow
    at = place.shape("slow_flow", place.unit(F), speeds * 2, low=low)
    mean = (ahead.symbol + back.symbol) / 2
    lean = (ahead.symbol - back.symbol) / 2
    fading = sympy.exp(-((f / at.symbol) ** 2))
    return Slow(1 + fading * (mean + lean * sign), (ahead, back, at))
