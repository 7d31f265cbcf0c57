"""Friction at a 1-junction: an effort against the flow.

Dry friction is written smooth, ``tanh(f / f_s)`` with a flow f_s 300 times below the
typical one; that flow is a parameter of the inserted element, marked exact.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.place import E, F, Place, symbols
from bondgraph.structure import signals
from bondgraph.structure.elements import (
    EffortSource,
    FlowSource,
    Gyrator,
    Resistance,
    Transformer,
)
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import effort

REGULARISATION = 1 / 300


def _direction(place: Place) -> tuple[sympy.Expr, Parameter]:
    """Return the smooth sign of the flow and the parameter that smooths it."""
    smooth = place.parameter(
        "slip_flow", place.unit(F), exact=REGULARISATION * place.flow
    )
    (width,) = symbols(smooth)
    return sympy.tanh(signals.f / width), smooth


class ViscousFriction(AbstractPhysics):
    """Effort proportional to flow."""

    word = "viscous_friction"
    reference = "Newton's law of viscosity"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where no fitted linear R sits already."""
        if not place.is_one_junction or place.has_free_linear(Resistance):
            return
        b = place.parameter("viscous", place.unit(E, F), low=0.0)
        (coefficient,) = symbols(b)
        law = coefficient * signals.f
        name = place.name_of("viscous_friction")
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(Resistance(name, law=law), b),
            law=law,
            words=f"{place.a(E)} proportional to {place.domain.flow}",
            depends_on=("flow",),
            starts=({b.name: 0.0}, {b.name: 0.2 * place.effort / place.flow}),
        )


class CoulombFriction(AbstractPhysics):
    """Dry friction of constant size."""

    word = "coulomb_friction"
    reference = "Coulomb 1785; Armstrong-Hélouvry et al., Automatica 30, 1994"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not place.is_one_junction:
            return
        c = place.parameter("coulomb", place.unit(E), low=0.0)
        direction, smooth = _direction(place)
        (size,) = symbols(c)
        law = size * direction
        name = place.name_of("coulomb_friction")
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(Resistance(name, law=law), c, smooth),
            law=law,
            words=f"{place.a(E)} of constant size against the motion",
            depends_on=("flow",),
            starts=({c.name: 0.0}, {c.name: 0.3 * place.effort}),
        )


class DirectionDependentFriction(AbstractPhysics):
    """Dry friction whose size differs between the two directions."""

    word = "direction_dependent_friction"
    reference = "Armstrong-Hélouvry et al., Automatica 30, 1994, section 2"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where no fitted constant source sits.

        Beside one it says nothing of its own: in motion the two are the same.
        """
        if not place.is_one_junction or place.has_free_bias:
            return
        c = place.parameter("coulomb", place.unit(E), low=0.0)
        difference = place.parameter("coulomb_difference", place.unit(E))
        direction, smooth = _direction(place)
        size, half = symbols(c, difference)
        law = size * direction + half * sympy.Abs(direction)
        name = place.name_of("direction_dependent_friction")
        some = 0.3 * place.effort
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(Resistance(name, law=law), c, difference, smooth),
            law=law,
            words=(
                f"{place.a(E)} against the motion, larger in one direction "
                "than in the other"
            ),
            depends_on=("flow",),
            starts=(
                {c.name: 0.0, difference.name: 0.0},
                {c.name: some, difference.name: 0.0},
            ),
            extends=("coulomb_friction",),
        )


class StribeckFriction(AbstractPhysics):
    """Dry friction that is larger at low speed."""

    word = "stribeck_friction"
    reference = "Stribeck 1902; Armstrong-Hélouvry et al., Automatica 30, 1994, eq. 3"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not place.is_one_junction:
            return
        c = place.parameter("coulomb", place.unit(E), low=0.0)
        rise = place.parameter("stribeck_rise", place.unit(E), low=0.0)
        at = place.parameter("stribeck_flow", place.unit(F), low=0.02 * place.flow)
        direction, smooth = _direction(place)
        size, extra, width = symbols(c, rise, at)
        law = (size + extra * sympy.exp(-((signals.f / width) ** 2))) * direction
        name = place.name_of("stribeck_friction")
        some = 0.3 * place.effort
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(Resistance(name, law=law), c, rise, at, smooth),
            law=law,
            words=f"{place.a(E)} against the motion that falls with speed",
            depends_on=("flow",),
            starts=tuple(
                {c.name: size, rise.name: size, at.name: share * place.flow}
                for share, size in ((0.1, 0.0), (0.1, some), (0.4, some))
            ),
            extends=("coulomb_friction",),
        )


class LoadDependentFriction(AbstractPhysics):
    """Dry friction proportional to the effort that a bond transmits."""

    word = "load_dependent_friction"
    reference = "Amontons' law; Duclusaud et al., ICRA 2025 (arXiv 2410.08650)"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield two per load at a 1-junction: without and with a constant part."""
        if not place.is_one_junction:
            return
        for load in _loads(place):
            yield self._law(place, load, constant=False)
            yield self._law(place, load, constant=True)

    def _law(self, place: Place, load: "_Load", *, constant: bool) -> Hypothesis:
        mu = place.parameter("mu", "1", low=0.0)
        c = place.parameter("coulomb", place.unit(E), low=0.0)
        direction, smooth = _direction(place)
        coefficient, size = symbols(mu, c)
        name = place.name_of("load_dependent_friction")
        carried = (
            effort(load.bond) - effort(name) if load.less_own else effort(load.bond)
        )
        proportional = coefficient * sympy.Abs(carried)
        law = (size + proportional if constant else proportional) * direction
        constants: dict[str, float] = {c.name: 0.3 * place.effort} if constant else {}
        parameters = (mu, c, smooth) if constant else (mu, smooth)
        passed = "passed on from" if load.less_own else "transmitted through"
        return Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(Resistance(name, law=law), *parameters),
            law=law,
            words=(
                f"{place.a(E)} against the motion that "
                f"{'has a constant part and ' if constant else ''}grows with the "
                f"{place.domain.effort} {passed} {load.bond}"
            ),
            depends_on=("flow", f"effort({load.bond})"),
            starts=tuple(
                {mu.name: value, **constants}
                for value in ((0.0, 0.2) if constant else (0.0, 0.1, 0.3))
            ),
            extends=("coulomb_friction",) if constant else (),
        )


@dataclass(frozen=True, slots=True)
class _Load:
    """What presses the contact: the effort of a bond, or what friction leaves of it."""

    bond: str
    less_own: bool = False


def _loads(place: Place) -> tuple[_Load, ...]:
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
