"""Friction at a 1-junction: an effort against the flow.

Dry friction is written smooth, ``tanh(f / f_s)`` with a flow f_s 300 times below the
typical one; that flow is a parameter of the inserted element, marked exact.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Coefficient, E, F, Place
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Gyrator,
    Resistance,
    Transformer,
)
from bondgraph.structure.signals import effort, f

REGULARISATION = 1 / 300


def direction(place: OneJunctionPlace) -> tuple[sympy.Expr, Coefficient]:
    """Return the smooth sign of the flow and the coefficient that smooths it."""
    width = place.constant("slip_flow", place.unit(F), REGULARISATION * place.flow)
    return sympy.tanh(f / width.symbol), width


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

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not isinstance(place, OneJunctionPlace):
            return
        some = 0.3 * place.effort
        c = place.strength("coulomb", place.unit(E), (0.0, some), low=0.0)
        sign, width = direction(place)
        law = c.symbol * sign
        edit = place.insert(Resistance(place.name_of(self.word), law=law), c, width)
        words = f"{place.a(E)} of constant size against the motion"
        yield self.hypothesis(place, edit, law, (c, width), words)


class DirectionDependentFriction(AbstractPhysics):
    """Dry friction whose size differs between the two directions."""

    word = "direction_dependent_friction"
    reference = "Armstrong-Hélouvry et al., Automatica 30, 1994, section 2"
    passivity = Passivity.DISSIPATIVE
    signature = "Coulomb friction beside a constant bias, which in motion is the same"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where no fitted constant source sits.

        Beside one it says nothing of its own: in motion the two are the same.
        """
        if not isinstance(place, OneJunctionPlace) or place.has_free_bias:
            return
        some = 0.3 * place.effort
        c = place.strength("coulomb", place.unit(E), (0.0, some), low=0.0)
        half = place.strength("coulomb_difference", place.unit(E))
        sign, width = direction(place)
        law = c.symbol * sign + half.symbol * sympy.Abs(sign)
        element = Resistance(place.name_of(self.word), law=law)
        words = (
            f"{place.a(E)} against the motion, larger in one direction "
            "than in the other"
        )
        yield self.hypothesis(
            place,
            place.insert(element, c, half, width),
            law,
            (c, half, width),
            words,
            extends=("coulomb_friction",),
        )


class StribeckFriction(AbstractPhysics):
    """Dry friction that is larger at low speed."""

    word = "stribeck_friction"
    reference = "Stribeck 1902; Armstrong-Hélouvry et al., Automatica 30, 1994, eq. 3"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "an effort largest just after the flow turns, stick-slip at low speed; taken "
        "for Coulomb friction where the flow is rarely small"
    )

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not isinstance(place, OneJunctionPlace):
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


class LoadDependentFriction(AbstractPhysics):
    """Dry friction proportional to the effort that a bond transmits."""

    word = "load_dependent_friction"
    reference = "Amontons' law; Duclusaud et al., ICRA 2025 (arXiv 2410.08650)"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "dry friction that grows with what is carried; at one load it is Coulomb "
        "friction"
    )

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield two per load at a 1-junction: without and with a constant part."""
        if not isinstance(place, OneJunctionPlace):
            return
        for load in _loads(place):
            yield self._law(place, load, constant=False)
            yield self._law(place, load, constant=True)

    def _law(
        self, place: OneJunctionPlace, load: "_Load", *, constant: bool
    ) -> Hypothesis:
        some = 0.3 * place.effort
        start = (0.0, 0.0, 0.2) if constant else (0.0, 0.1, 0.3)
        mu = place.strength("mu", "1", start, low=0.0)
        c = place.strength("coulomb", place.unit(E), (0.0, some, some), low=0.0)
        sign, width = direction(place)
        name = place.name_of(self.word)
        carried = (
            effort(load.bond) - effort(name) if load.less_own else effort(load.bond)
        )
        pressed = mu.symbol * sympy.Abs(carried)
        law = (c.symbol + pressed if constant else pressed) * sign
        coefficients = (mu, c, width) if constant else (mu, width)
        passed = "passed on from" if load.less_own else "transmitted through"
        return self.hypothesis(
            place,
            place.insert(Resistance(name, law=law), *coefficients),
            law,
            coefficients,
            f"{place.a(E)} against the motion that "
            f"{'has a constant part and ' if constant else ''}grows with the "
            f"{place.domain.effort} {passed} {load.bond}",
            extends=("coulomb_friction",) if constant else (),
        )


@dataclass(frozen=True, slots=True)
class _Load:
    """What presses the contact: the effort of a bond, or what friction leaves of it."""

    bond: str
    less_own: bool = False


def _loads(place: OneJunctionPlace) -> tuple[_Load, ...]:
    """Return at most two efforts that may load the contact.

    What a two-port carries on comes first; where the chain ends, what arrives less the
    friction itself is the same thing; then what arrives, then driven sources.
    """
    graph = place.graph
    outward: list[_Load] = []
    inward: list[_Load] = []
    driven: list[_Load] = []
    for bond in graph.bonds_at(place.name):
        other = graph.node(bond.other(place.name))
        load = _Load(bond.name)
        if isinstance(other, Transformer | Gyrator):
            (outward if bond.tail == place.name else inward).append(load)
        elif isinstance(other, EffortSource | FlowSource) and other.value is None:
            driven.append(load)
    passed = [] if outward else [_Load(load.bond, less_own=True) for load in inward]
    return (*outward, *passed, *inward, *driven)[:2]
