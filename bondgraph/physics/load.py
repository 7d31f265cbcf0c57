"""Friction that grows with what a contact carries."""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy

from bondgraph.physics.dry_friction import (
    WhenSlow,
    changing,
    direction,
    the_same,
)
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MECHANICAL, Coefficient, E, Place
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Gyrator,
    Resistance,
    Transformer,
    ZeroJunction,
)
from bondgraph.structure.signals import effort


class LoadDependentFriction(AbstractPhysics):
    """Dry friction proportional to the effort that a bond transmits."""

    word = "load_dependent_friction"
    reference = "Amontons' law; Duclusaud et al., ICRA 2025 (arXiv 2410.08650)"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "dry friction that grows with what is carried; at one load it is Coulomb "
        "friction"
    )
    domains = MECHANICAL

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield per load at a 1-junction one with, one without a constant part.

        Then one where something else presses as well. Of a steady table also
        one that is another where it is slow.
        """
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        for load in _loads(place):
            yield self._law(place, load, constant=False)
            yield self._law(place, load, constant=True)
            if place.is_steady:
                yield self._law(place, load, constant=True, when_slow=changing)
            yield self._pressed_beside(place, load)

    def _law(
        self,
        place: OneJunctionPlace,
        load: "_Load",
        *,
        constant: bool,
        when_slow: WhenSlow = the_same,
    ) -> Hypothesis:
        some = 0.3 * place.effort
        start = (0.0, 0.0, 0.2) if constant else (0.0, 0.1, 0.3)
        mu = place.strength("mu", "1", start, low=0.0)
        c = place.strength("coulomb", place.unit(E), (0.0, some, some), low=0.0)
        sign, width = direction(place)
        slow = when_slow(place, sign)
        pressed = mu.symbol * sympy.Abs(load.carried(place.name_of(self.word)))
        law = (c.symbol + pressed if constant else pressed) * sign * slow.factor
        own = (mu, c) if constant else (mu,)
        narrower = ("coulomb_friction", self.word) if constant else ()
        return self._rubbing(
            place,
            law,
            (*own, *slow.coefficients, width),
            f"{'has a constant part and ' if constant else ''}grows with "
            f"{load.told(place)}{slow.words}",
            extends=slow.extending(self.word, *narrower),
        )

    def _pressed_beside(self, place: OneJunctionPlace, load: "_Load") -> Hypothesis:
        """Return the law of a contact that something else presses as well.

        A weight, a belt or a clamp that moves nothing, and so is in no model of the
        motion, presses on what the load presses on: with one sign of the load there is
        more friction, with the other less, until the load lifts off what is pressed.
        """
        some = 0.3 * place.effort
        mu = place.strength("mu", "1", (0.0, 0.2, -0.2))
        c = place.strength("coulomb", place.unit(E), (0.0, some, some), low=0.0)
        sign, width = direction(place)
        carried = load.carried(place.name_of(self.word))
        return self._rubbing(
            place,
            sympy.Abs(c.symbol + mu.symbol * carried) * sign,
            (mu, c, width),
            f"grows with {load.told(place)} in one sense and shrinks with it in the "
            "other, as where something presses beside it",
            extends=("coulomb_friction", self.word),
        )

    def _rubbing(
        self,
        place: OneJunctionPlace,
        law: sympy.Expr,
        coefficients: tuple[Coefficient, ...],
        words: str,
        *,
        extends: tuple[str, ...],
    ) -> Hypothesis:
        """Return the hypothesis of a resistance of that law, told in these words."""
        rubs = Resistance(place.name_of(self.word), law=law)
        words = f"{place.a(E)} against the motion that {words}"
        edit = place.insert(rubs, *coefficients)
        return self.hypothesis(place, edit, law, coefficients, words, extends=extends)


@dataclass(frozen=True, slots=True)
class _Load:
    """What presses the contact: the effort of a bond, or what friction leaves of it."""

    bond: str
    less_own: bool = False

    def carried(self, own: str) -> sympy.Expr:
        """Return the effort that presses, beside a friction called `own`."""
        return effort(self.bond) - effort(own) if self.less_own else effort(self.bond)

    def told(self, place: OneJunctionPlace) -> str:
        """Return it in words."""
        passed = "passed on from" if self.less_own else "transmitted through"
        return f"the {place.domain.effort} {passed} {self.bond}"


def _loads(place: OneJunctionPlace) -> tuple[_Load, ...]:
    """Return at most two efforts that may load the contact.

    What a two-port carries on comes first; where the chain ends, what arrives less the
    friction itself is the same thing; then what arrives, then driven sources, then
    what parts beside this one share (the torque of a shaft that ends here).
    """
    graph = place.graph
    outward: list[_Load] = []
    inward: list[_Load] = []
    driven: list[_Load] = []
    shared: list[_Load] = []
    for bond in graph.bonds_at(place.name):
        other = graph.node(bond.other(place.name))
        load = _Load(bond.name)
        if isinstance(other, Transformer | Gyrator):
            (outward if bond.tail == place.name else inward).append(load)
        elif isinstance(other, EffortSource | FlowSource) and other.value is None:
            driven.append(load)
        elif isinstance(other, ZeroJunction):
            shared.append(load)
    passed = [] if outward else [_Load(load.bond, less_own=True) for load in inward]
    return (*outward, *passed, *inward, *driven, *shared)[:2]
