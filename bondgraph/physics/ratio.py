"""Ratios that are not constant: gears that run out of true."""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Place
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import junction_place
from bondgraph.structure.domains import ROTATION
from bondgraph.structure.elements import Transformer


class Eccentricity(AbstractPhysics):
    """A ratio that varies once per turn: an eccentric wheel, a universal joint."""

    word = "eccentricity"
    reference = "runout of gears and pulleys; the first harmonic of a joint"
    passivity = Passivity.STORING
    signature = "ripple of speed and load once per turn; taken for gravity or cogging"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for a TF beside a shaft whose angle is known."""
        if not isinstance(place, ElementPlace):
            return
        if not isinstance(place.element, Transformer):
            return
        for name in place.junctions:
            shaft = place.graph.domain_at(name) == ROTATION
            if shaft and place.is_one_junction(name):
                side = junction_place(place.graph, name, place.scales)
                angle = side.displacement_signal
                if angle is not None:
                    yield self._once_per_turn(place, name, angle)

    def _once_per_turn(
        self, place: ElementPlace, shaft: str, angle: sympy.Expr
    ) -> Hypothesis:
        a = place.strength(f"runout_sine_{shaft}", "1", (0.0, 0.05))
        b = place.strength(f"runout_cosine_{shaft}", "1", (0.0, 0.05))
        ripple = a.symbol * sympy.sin(angle) + b.symbol * sympy.cos(angle)
        law = place.usual_law * (1 + ripple)
        words = f"{place.name} varies once per turn of {shaft}"
        edit = place.replace(law, a, b)
        return self.hypothesis(place, edit, law, (a, b), words, also=place.junctions)
