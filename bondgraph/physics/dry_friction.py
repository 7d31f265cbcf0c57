"""What laws of dry friction are made of: the sign of a flow, and what is slow.

The sign is written smooth, ``tanh(f / f_s)`` with a flow f_s 300 times below the
typical one, and ten times below the least row of a steady table; that flow is a
parameter of the inserted element, marked exact. A fit that has ended goes on with a
sharper edge where that tells (`diagnosis.search.sharper`).
"""

from collections.abc import Callable
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
    """What multiplies a friction where it is slow, and what is said of it.

    Parameters
    ----------
    factor
        1 where it is fast.
    words
        To be added to the law's own; empty where it is the same at all speeds.
    """

    factor: sympy.Expr
    coefficients: tuple[Coefficient, ...] = ()
    words: str = ""

    def extending(self, word: str, *narrower: str) -> tuple[str, ...]:
        """Return the words that a law called `word` contains with it, of narrower laws.

        One that changes contains the law that does not, and Stribeck's.
        """
        return (*narrower, "stribeck_friction", word) if self.coefficients else narrower


WhenSlow = Callable[[OneJunctionPlace, sympy.Expr], Slow]
"""What a friction is where it is slow, from the place and the sign of its flow."""


def the_same(place: OneJunctionPlace, sign: sympy.Expr) -> Slow:
    """Return that it is the same at all speeds."""
    return Slow(sympy.S.One)


def changing(place: OneJunctionPlace, sign: sympy.Expr) -> Slow:
    """Return that it changes, in each direction by a share of its own.

    Stribeck's effect, as slow worm gears show it: it may take from the friction the one
    way and add to it the other. Bounds on the shares leave a friction that takes power.
    """
    ahead = place.strength("slow_rise_ahead", "1", low=-1.0, high=5.0)
    back = place.strength("slow_rise_back", "1", low=-1.0, high=5.0)
    speeds = (0.1 * place.flow, 0.4 * place.flow)
    low = 0.02 * place.flow
    at = place.shape("slow_flow", place.unit(F), speeds * 2, low=low)
    mean = (ahead.symbol + back.symbol) / 2
    lean = (ahead.symbol - back.symbol) / 2
    fading = sympy.exp(-((f / at.symbol) ** 2))
    return Slow(
        1 + fading * (mean + lean * sign),
        (ahead, back, at),
        ", and changes in each direction by a share of its own where it is slow",
    )
