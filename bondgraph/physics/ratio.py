"""Ratios that are not constant: gears that run out of true, pumps that pulsate."""

import math
from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Coefficient, Place, Q
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.domains import ROTATION
from bondgraph.structure.elements import Transformer

TIMES = tuple(map(float, range(2, 31)))
"""How often a ratio may vary in a turn: joints, plungers, teeth."""


class Eccentricity(AbstractPhysics):
    """A ratio that varies once or several times per turn.

    An eccentric wheel, a universal joint, a pump with a few plungers, a chain's links.
    """

    word = "eccentricity"
    reference = "runout of gears and pulleys; the harmonics of a joint or a pump"
    passivity = Passivity.STORING
    signature = "ripple of speed and load with the angle; taken for gravity or cogging"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for a TF beside a shaft whose angle is known.

        Several times per turn where the shaft turns round.
        """
        if not isinstance(place, ElementPlace):
            return
        if not isinstance(place.element, Transformer):
            return
        shafts = tuple(_shafts(place))
        for side, angle in shafts:
            yield self._once_per_turn(place, side.name, angle)
        for side, angle in shafts:
            low, high = side.displacement_range
            if high - low > 2.0 * math.pi:
                yield self._often_per_turn(place, side, angle)

    def _once_per_turn(
        self, place: ElementPlace, shaft: str, angle: sympy.Expr
    ) -> Hypothesis:
        a = place.strength(f"runout_sine_{shaft}", "1", (0.0, 0.05))
        b = place.strength(f"runout_cosine_{shaft}", "1", (0.0, 0.05))
        words = f"{place.name} varies once per turn of {shaft}"
        return self._varying(place, angle, (a, b), words)

    def _often_per_turn(
        self, place: ElementPlace, side: OneJunctionPlace, angle: sympy.Expr
    ) -> Hypothesis:
        shaft = side.name
        a = place.strength(f"ripple_sine_{shaft}", "1")
        b = place.strength(f"ripple_cosine_{shaft}", "1")
        unit = side.per("1", Q)
        wave = place.shape(f"ripple_wave_{shaft}", unit, TIMES, low=1.5)
        words = f"{place.name} varies several times per turn of {shaft}"
        return self._varying(place, wave.symbol * angle, (a, b, wave), words)

    def _varying(
        self,
        place: ElementPlace,
        phase: sympy.Expr,
        own: tuple[Coefficient, ...],
        words: str,
    ) -> Hypothesis:
        a, b, *_ = own
        ripple = a.symbol * sympy.sin(phase) + b.symbol * sympy.cos(phase)
        law = place.usual_law * (1 + ripple)
        edit = place.replace(law, *own)
        return self.hypothesis(place, edit, law, own, words, also=place.junctions)


def _shafts(place: ElementPlace) -> Iterator[tuple[OneJunctionPlace, sympy.Expr]]:
    """Yield the shafts beside a transformer whose angle is known, with that angle."""
    for name in place.junctions:
        shaft = place.graph.domain_at(name) == ROTATION
        if shaft and place.is_one_junction(name):
            side = OneJunctionPlace(place.graph, name, place.scales)
            if side.displacement_signal is not None:
                yield side, side.displacement_signal
