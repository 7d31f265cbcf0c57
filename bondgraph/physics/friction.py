"""Friction at a 1-junction: an effort against the flow."""

from collections.abc import Iterator
from dataclasses import replace
from types import MappingProxyType

import sympy

from bondgraph.physics.dry_friction import (
    WhenSlow,
    changing,
    direction,
    the_same,
)
from bondgraph.physics.hypothesis import (
    AbstractPhysics,
    Hypothesis,
    Limit,
    Passivity,
)
from bondgraph.physics.places.base import (
    FLUID,
    MECHANICAL,
    E,
    F,
    Place,
)
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.domains import ELECTRICAL
from bondgraph.structure.elements import Resistance
from bondgraph.structure.signals import f

ALIKE = 0.02
"""Dry friction that differs by no more between the directions is alike in both."""


class ViscousFriction(AbstractPhysics):
    """Effort proportional to flow."""

    word = "viscous_friction"
    reference = "Newton's law of viscosity; Ohm's law; Hagen-Poiseuille"
    passivity = Passivity.DISSIPATIVE
    signature = "motion dies out faster the faster it is; taken for a larger resistance"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where no fitted linear R sits already."""
        if not isinstance(place, OneJunctionPlace):
            return
        if place.has_free_linear(Resistance):
            return
        some = 0.2 * place.effort / place.flow
        b = place.strength("viscous", place.unit(E, F), (0.0, some), low=0.0)
        law = b.symbol * f
        element = Resistance(place.name_of(self.word), law=law)
        words = f"{place.a(E)} proportional to {place.domain.flow}"
        yield self.hypothesis(place, place.insert(element, b), law, (b,), words)


class CoulombFriction(AbstractPhysics):
    """Dry friction of constant size."""

    word = "coulomb_friction"
    reference = "Coulomb 1785; Armstrong-Hélouvry et al., Automatica 30, 1994"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "an effort that jumps where the flow turns; taken for Stribeck friction where "
        "the recovered signal is smooth, and for load-dependent friction at one load"
    )
    domains = MECHANICAL | FLUID
    stem = "coulomb"
    sentence = "{an_effort} of constant size against the motion"
    sentences = MappingProxyType(
        {"hydraulic": "a pressure of constant size below which nothing flows (yield)"}
    )

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        some = 0.3 * place.effort
        c = place.strength(self.stem, place.unit(E), (0.0, some), low=0.0)
        sign, width = direction(place)
        law = c.symbol * sign
        edit = place.insert(Resistance(place.name_of(self.word), law=law), c, width)
        words = self.sentences.get(place.domain.name, self.sentence)
        words = words.format(an_effort=place.a(E))
        yield self.hypothesis(place, edit, law, (c, width), words)


class VoltageDrop(CoulombFriction):
    """A voltage that falls off whatever the current is: brushes, diodes, contacts."""

    word = "voltage_drop"
    reference = "brush contact drop of commutator machines; forward voltage of a diode"
    signature = "no current below a voltage; taken for friction of what the motor turns"
    domains = frozenset({ELECTRICAL})
    stem = "drop"
    sentence = "a voltage of constant size against the current"


class DirectionDependentFriction(AbstractPhysics):
    """Dry friction whose size differs between the two directions."""

    word = "direction_dependent_friction"
    reference = "Armstrong-Hélouvry et al., Automatica 30, 1994, section 2"
    passivity = Passivity.DISSIPATIVE
    domains = MECHANICAL
    signature = "Coulomb friction beside a constant bias, which in motion is the same"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where no fitted constant source sits.

        Beside one it says nothing of its own: in motion the two are the same. Of a
        steady table also one that is another where it is slow.
        """
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if place.has_free_bias:
            return
        yield self._law(place, the_same)
        if place.is_steady:
            yield self._law(place, changing)

    def _law(self, place: OneJunctionPlace, when_slow: WhenSlow) -> Hypothesis:
        sizes = (0.0, 0.3 * place.effort)
        c = place.strength("coulomb", place.unit(E), sizes, low=0.0)
        # A share: bounds keep it passive, and at zero it is Coulomb friction.
        share = place.strength("asymmetry", "1", (0.0, 0.0), low=-1.0, high=1.0)
        sign, width = direction(place)
        slow = when_slow(place, sign)
        law = c.symbol * (sign + share.symbol * sympy.Abs(sign)) * slow.factor
        coefficients = (c, share, *slow.coefficients, width)
        element = Resistance(place.name_of(self.word), law=law)
        found = self.hypothesis(
            place,
            place.insert(element, *coefficients),
            law,
            coefficients,
            f"{place.a(E)} against the motion, larger ahead by a share (asymmetry) "
            f"of its mean size, smaller back{slow.words}",
            extends=slow.extending(self.word, CoulombFriction.word),
        )
        if slow.words:
            return found
        alike = CoulombFriction.sentence.format(an_effort=place.a(E))
        limit = Limit(share.name, ALIKE, CoulombFriction.word, alike)
        return replace(found, limit=limit)


class StribeckFriction(AbstractPhysics):
    """Dry friction that is larger at low speed."""

    word = "stribeck_friction"
    reference = "Stribeck 1902; Armstrong-Hélouvry et al., Automatica 30, 1994, eq. 3"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "an effort largest just after the flow turns, stick-slip at low speed; taken "
        "for Coulomb friction where the flow is rarely small"
    )
    domains = MECHANICAL

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        some, speed = 0.3 * place.effort, place.flow
        sizes = (0.0, 0.0, some, some)
        c = place.strength("coulomb", place.unit(E), sizes, low=0.0)
        rise = place.strength("stribeck_rise", place.unit(E), sizes, low=0.0)
        speeds = (0.1 * speed, 0.4 * speed, 0.1 * speed, 0.4 * speed)
        at = place.shape("stribeck_flow", place.unit(F), speeds, low=0.02 * speed)
        sign, width = direction(place)
        fading = sympy.exp(-((f / at.symbol) ** 2))
        law = (c.symbol + rise.symbol * fading) * sign
        element = Resistance(place.name_of(self.word), law=law)
        yield self.hypothesis(
            place,
            place.insert(element, c, rise, at, width),
            law,
            (c, rise, at, width),
            f"{place.a(E)} against the motion that falls with speed",
            extends=("coulomb_friction",),
        )
