"""Efforts that depend on position or on nothing: springs, gravity, bias; and drag."""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.place import E, F, Place, symbols
from bondgraph.structure import signals
from bondgraph.structure.domains import ROTATION, TRANSLATION, Quantity
from bondgraph.structure.elements import Compliance, EffortSource, Inertance, Resistance
from bondgraph.structure.signals import displacement

Q = Quantity.DISPLACEMENT


def restoring(place: Place, name: str, law: sympy.Expr) -> EffortSource:
    """Return a source whose effort opposes `law`, a law of the displacement q here.

    A C would bring a displacement of its own, with an origin of its own; the effort has
    to read the one that the place already has.
    """
    return EffortSource(
        name, value=-law.xreplace({signals.q: displacement(place.name)})
    )


class QuadraticDrag(AbstractPhysics):
    """Effort proportional to the square of the flow, against it."""

    word = "quadratic_drag"
    reference = "Newton's drag law; turbulent pressure loss"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not place.is_one_junction:
            return
        b = place.parameter("quadratic", place.unit(E, F, 2), low=0.0)
        (coefficient,) = symbols(b)
        law = coefficient * signals.f * sympy.Abs(signals.f)
        name = place.name_of("quadratic_drag")
        some = 0.2 * place.effort / place.flow**2
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(Resistance(name, law=law), b),
            law=law,
            words=(f"{place.a(E)} that grows with the square of {place.domain.flow}"),
            depends_on=("flow",),
            starts=({b.name: 0.0}, {b.name: some}),
        )


class ConstantBias(AbstractPhysics):
    """A constant effort."""

    word = "constant_bias"
    reference = "offset of an actuator, gravity along a straight path"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 1-junctions that have no fitted constant source."""
        if not place.is_one_junction or place.has_free_bias:
            return
        b = place.parameter("bias", place.unit(E))
        (size,) = symbols(b)
        name = place.name_of("constant_bias")
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(EffortSource(name, value=size), b),
            law=size,
            words=f"a constant {place.domain.effort}",
            depends_on=(),
            starts=({b.name: 0.0},),
        )


class Gravity(AbstractPhysics):
    """The torque of an eccentric weight on a horizontal axis."""

    word = "gravity"
    reference = "physical pendulum: m g l sin(q + q_0), both phases fitted"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at rotating 1-junctions whose angle is known."""
        if not place.is_one_junction or place.domain != ROTATION:
            return
        if not place.displacement_known:
            return
        a = place.parameter("gravity_sine", place.unit(E))
        b = place.parameter("gravity_cosine", place.unit(E))
        sine, cosine = symbols(a, b)
        law = sine * sympy.sin(signals.q) + cosine * sympy.cos(signals.q)
        name = place.name_of("gravity")
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(restoring(place, name, law), a, b),
            law=law,
            words="the torque of a weight that turns with the shaft",
            depends_on=("displacement",),
            starts=(
                {a.name: 0.0, b.name: 0.0},
                {a.name: 0.3 * place.effort, b.name: 0.0},
            ),
        )


class Spring(AbstractPhysics):
    """An effort proportional to displacement, with its rest position."""

    word = "spring"
    reference = "Hooke's law"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where the displacement is known and no fitted linear C sits."""
        if not place.is_one_junction or not place.displacement_known:
            return
        if place.has_free_linear(Compliance):
            return
        k = place.parameter("stiffness", place.unit(E, Q), low=0.0)
        offset = place.parameter("spring_offset", place.unit(E))
        stiffness, rest = symbols(k, offset)
        law = stiffness * signals.q + rest
        name = place.name_of("spring")
        some = 0.2 * place.effort / place.displacement
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(restoring(place, name, law), k, offset),
            law=law,
            words=(f"{place.a(E)} proportional to {place.domain.displacement}"),
            depends_on=("displacement",),
            starts=(
                {k.name: 0.0, offset.name: 0.0},
                {k.name: some, offset.name: 0.0},
            ),
        )


class HardeningSpring(AbstractPhysics):
    """A spring whose stiffness grows (or falls) with deflection."""

    word = "hardening_spring"
    reference = "Duffing 1918"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where the displacement is known."""
        if not place.is_one_junction or not place.displacement_known:
            return
        k = place.parameter("cubic_stiffness", place.unit(E, Q, 3))
        (stiffness,) = symbols(k)
        law = stiffness * signals.q**3
        name = place.name_of("hardening_spring")
        some = 0.2 * place.effort / place.displacement**3
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(restoring(place, name, law), k),
            law=law,
            words=(
                f"{place.a(E)} that grows with the cube of {place.domain.displacement}"
            ),
            depends_on=("displacement",),
            starts=({k.name: 0.0}, {k.name: some}),
        )


class AddedInertia(AbstractPhysics):
    """Inertia that the model does not have, or has with a value it cannot leave."""

    word = "added_inertia"
    reference = "added mass; reflected inertia"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at mechanical 1-junctions without a freely fitted linear I."""
        if not place.is_one_junction or place.domain not in (ROTATION, TRANSLATION):
            return
        if place.has_free_linear(Inertance):
            return
        momentum = Quantity.MOMENTUM
        name = place.name_of("added_inertia")
        inertia = place.parameter("added_inertia", place.unit(momentum, F), low=0.0)
        (symbol,) = symbols(inertia)
        some = 0.1 * place.scales.at(momentum, place.name, place.effort) / place.flow
        yield Hypothesis(
            physics=self.word,
            place=place.name,
            element=name,
            edit=place.insert(Inertance(name), inertia),
            law=symbol * signals.f,
            words="inertia that moves along and is not in the model",
            depends_on=("flow",),
            starts=({inertia.name: 1e-3 * some}, {inertia.name: some}),
        )
