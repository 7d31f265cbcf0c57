"""Efforts that depend on position or on nothing: springs, gravity, bias; and drag."""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import E, F, P, Place, Q
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.domains import ROTATION, TRANSLATION
from bondgraph.structure.elements import Compliance, EffortSource, Inertance, Resistance
from bondgraph.structure.signals import displacement, f, q


def restoring(place: Place, name: str, law: sympy.Expr) -> EffortSource:
    """Return a source whose effort opposes `law`, a law of the displacement q here.

    A C would bring a displacement of its own, with an origin of its own; the effort has
    to read the one that the place already has.
    """
    return EffortSource(name, value=-law.xreplace({q: displacement(place.name)}))


class QuadraticDrag(AbstractPhysics):
    """Effort proportional to the square of the flow, against it."""

    word = "quadratic_drag"
    reference = "Newton's drag law; turbulent pressure loss"
    passivity = Passivity.DISSIPATIVE
    signature = "losses only at speed; taken for viscous friction over a narrow range"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not isinstance(place, OneJunctionPlace):
            return
        some = 0.2 * place.effort / place.flow**2
        b = place.strength("quadratic", place.unit(E, F, 2), (0.0, some), low=0.0)
        law = b.symbol * f * sympy.Abs(f)
        element = Resistance(place.name_of(self.word), law=law)
        words = f"{place.a(E)} that grows with the square of {place.domain.flow}"
        yield self.hypothesis(place, place.insert(element, b), law, (b,), words)


class ConstantBias(AbstractPhysics):
    """A constant effort."""

    word = "constant_bias"
    reference = "offset of an actuator, gravity along a straight path"
    passivity = Passivity.SOURCE
    signature = "the same error at rest and in motion; taken for a sensor's offset"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 1-junctions that have no fitted constant source."""
        if not isinstance(place, OneJunctionPlace) or place.has_free_bias:
            return
        b = place.strength("bias", place.unit(E))
        element = EffortSource(place.name_of(self.word), value=b.symbol)
        words = f"a constant {place.domain.effort}"
        yield self.hypothesis(place, place.insert(element, b), b.symbol, (b,), words)


class Gravity(AbstractPhysics):
    """The torque of an eccentric weight on a horizontal axis."""

    word = "gravity"
    reference = "physical pendulum: m g l sin(q + q_0), both phases fitted"
    passivity = Passivity.STORING
    signature = "an effort periodic in the angle; a spring over small angles"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at rotating 1-junctions whose angle is known."""
        if not isinstance(place, OneJunctionPlace) or place.domain != ROTATION:
            return
        if not place.displacement_known:
            return
        some = 0.3 * place.effort
        a = place.strength("gravity_sine", place.unit(E), (0.0, some))
        b = place.strength("gravity_cosine", place.unit(E))
        law = a.symbol * sympy.sin(q) + b.symbol * sympy.cos(q)
        element = restoring(place, place.name_of(self.word), law)
        words = "the torque of a weight that turns with the shaft"
        yield self.hypothesis(place, place.insert(element, a, b), law, (a, b), words)


class Spring(AbstractPhysics):
    """An effort proportional to displacement, with its rest position."""

    word = "spring"
    reference = "Hooke's law"
    passivity = Passivity.STORING
    signature = "an effort that follows the displacement; gravity over small angles"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where the displacement is known and no fitted linear C sits."""
        if not isinstance(place, OneJunctionPlace) or not place.displacement_known:
            return
        if place.has_free_linear(Compliance):
            return
        some = 0.2 * place.effort / place.displacement
        k = place.strength("stiffness", place.unit(E, Q), (0.0, some), low=0.0)
        rest = place.strength("spring_offset", place.unit(E))
        law = k.symbol * q + rest.symbol
        element = restoring(place, place.name_of(self.word), law)
        edit = place.insert(element, k, rest)
        words = f"{place.a(E)} proportional to {place.domain.displacement}"
        yield self.hypothesis(place, edit, law, (k, rest), words)


class HardeningSpring(AbstractPhysics):
    """A spring whose stiffness grows (or falls) with deflection."""

    word = "hardening_spring"
    reference = "Duffing 1918"
    passivity = Passivity.STORING
    signature = "resonance moves with amplitude; odd harmonics"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where the displacement is known."""
        if not isinstance(place, OneJunctionPlace) or not place.displacement_known:
            return
        some = 0.2 * place.effort / place.displacement**3
        k = place.strength("cubic_stiffness", place.unit(E, Q, 3), (0.0, some))
        law = k.symbol * q**3
        element = restoring(place, place.name_of(self.word), law)
        words = f"{place.a(E)} that grows with the cube of {place.domain.displacement}"
        yield self.hypothesis(place, place.insert(element, k), law, (k,), words)


class AddedInertia(AbstractPhysics):
    """Inertia that the model does not have, or has with a value it cannot leave."""

    word = "added_inertia"
    reference = "added mass; reflected inertia"
    passivity = Passivity.STORING
    signature = "slower and lower in frequency; taken for a smaller drive or compliance"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at mechanical 1-junctions without a freely fitted linear I."""
        if not isinstance(place, OneJunctionPlace):
            return
        if place.domain not in (ROTATION, TRANSLATION):
            return
        if place.has_free_linear(Inertance):
            return
        some = 0.1 * place.scales.at(P, place.name, place.effort) / place.flow
        starts = (1e-3 * some, some)
        inertia = place.shape("added_inertia", place.unit(P, F), starts, low=0.0)
        element = Inertance(place.name_of(self.word))
        words = "inertia that moves along and is not in the model"
        yield self.hypothesis(
            place,
            place.insert(element, inertia),
            inertia.symbol * f,
            (inertia,),
            words,
        )
