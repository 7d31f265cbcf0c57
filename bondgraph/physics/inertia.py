"""Inertia that is not in the model, or that is not constant."""

from collections.abc import Iterator

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import (
    ELECTRIC,
    FLUID,
    MECHANICAL,
    F,
    P,
    Place,
)
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.elements import Inertance
from bondgraph.structure.signals import f, p

WHAT = {
    "electrical": "an inductance that is not in the model",
    "hydraulic": "inertia of the fluid that is not in the model",
}


class AddedInertia(AbstractPhysics):
    """Inertia that the model does not have, or has with a value it cannot leave."""

    word = "added_inertia"
    reference = "added mass; reflected inertia; leakage inductance"
    passivity = Passivity.STORING
    signature = "slower and lower in frequency; taken for a smaller drive or compliance"
    domains = MECHANICAL | FLUID | ELECTRIC

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 1-junctions without a freely fitted linear I."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if place.has_free_linear(Inertance):
            return
        some = 0.1 * place.momentum / place.flow
        inertia = place.shape(
            "added_inertia", place.unit(P, F), (1e-3 * some, some), low=0.0
        )
        element = Inertance(place.name_of(self.word))
        words = "inertia that moves along and is not in the model"
        words = WHAT.get(place.domain.name, words)
        law = inertia.symbol * f
        edit = place.insert(element, inertia)
        yield self.hypothesis(place, edit, law, (inertia,), words)


SMOOTH = 1e-3
"""Of what an inductance usually carries: below that its power is no power."""


class SaturatingInertia(AbstractPhysics):
    """An inductance that falls with its current: the iron saturates."""

    word = "saturating_inertia"
    reference = "first odd term of a saturation curve, i = psi / L + s psi^3; a knee"
    passivity = Passivity.STORING
    signature = "currents that rise ever faster under a voltage; odd harmonics"
    domains = ELECTRIC

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield two for every linear I: a cube, and a knee, sharper or softer."""
        if not isinstance(place, ElementPlace) or not self.suits(place):
            return
        if not isinstance(place.element, Inertance) or place.element.law is not None:
            return
        some = 0.2 * place.flow / place.content**3
        s = place.strength("saturation", place.unit(F, P, 3), (0.0, some), low=0.0)
        law = place.usual_law + s.symbol * p**3
        words = f"{place.name} holds less the more it carries: it saturates"
        edit, also = place.replace(law, s), place.junctions
        yield self.hypothesis(place, edit, law, (s,), words, also=also)
        knee = place.shape("saturation_power", "1", (0.0, 4.0), low=-1.0, high=20.0)
        usual = place.constant("saturation_momentum", place.unit(P), place.content)
        # Smooth at zero, where a power has no slope along its exponent.
        squared = (p / usual.symbol) ** 2 + SMOOTH**2
        law = place.usual_law + s.symbol * p**3 * squared ** (knee.symbol / 2)
        words += ", with the cube times a further power of what it carries"
        edit, own = place.replace(law, s, knee, usual), (s, knee, usual)
        yield self.hypothesis(
            place, edit, law, own, words, extends=(self.word,), also=also
        )
