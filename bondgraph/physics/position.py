"""Efforts that depend on position: springs, gravity, stops, cogging.

They need a displacement whose zero means something; where the origin would be free in
every recording, they are not proposed.
"""

import math
from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MECHANICAL, Coefficient, E, F, Place, Q
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import JunctionPlace, OneJunctionPlace
from bondgraph.structure.domains import ROTATION
from bondgraph.structure.elements import Compliance, EffortSource
from bondgraph.structure.nodes import is_linear
from bondgraph.structure.signals import f, flow, q


def restoring(place: JunctionPlace, name: str, law: sympy.Expr) -> EffortSource:
    """Return a source whose effort opposes `law`, a law of q and f here.

    A C would bring a displacement of its own, with an origin of its own; the effort has
    to read the one that the place already has.
    """
    here = {q: place.displacement_signal, f: flow(place.name)}
    return EffortSource(name, value=-law.xreplace(here))


def at_rest(place: OneJunctionPlace) -> tuple[Coefficient, ...]:
    """Return what a spring exerts at the origin; nothing beside a constant source.

    By the name that a constant bias has: without its stiffness a spring is one.
    """
    if place.has_free_bias:
        return ()
    return (place.strength("bias", place.unit(E)),)


class Gravity(AbstractPhysics):
    """The torque of an eccentric weight on a horizontal axis."""

    word = "gravity"
    reference = "physical pendulum: m g l sin(q + q_0), both phases fitted"
    passivity = Passivity.STORING
    signature = "an effort periodic in the angle; a spring over small angles"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at rotating 1-junctions whose angle is known, geared ones too.

        Beside a spring, too, that is the linear part of a hanging weight.
        """
        if not isinstance(place, OneJunctionPlace) or place.domain != ROTATION:
            return
        if place.displacement_signal is None:
            return
        yield self._whole(place)
        springs = (n for n in place.neighbours if isinstance(n, Compliance))
        if any(map(is_linear, springs)):
            yield self._beyond_its_linear_part(place)

    def _whole(self, place: OneJunctionPlace) -> Hypothesis:
        some = 0.3 * place.effort
        a = place.strength("gravity_sine", place.unit(E), (0.0, some))
        b = place.strength("gravity_cosine", place.unit(E))
        law = a.symbol * sympy.sin(q) + b.symbol * sympy.cos(q)
        element = restoring(place, place.name_of(self.word), law)
        words = "the torque of a weight that turns with the shaft"
        return self.hypothesis(place, place.insert(element, a, b), law, (a, b), words)

    def _beyond_its_linear_part(self, place: OneJunctionPlace) -> Hypothesis:
        some = place.effort / place.displacement
        a = place.strength("gravity_sine", place.unit(E), (0.0, some), low=0.0)
        law = a.symbol * (sympy.sin(q) - q)
        element = restoring(place, place.name_of(self.word), law)
        words = (
            "the torque of a weight that hangs from the shaft, of which the spring "
            "there is the linear part"
        )
        return self.hypothesis(place, place.insert(element, a), law, (a,), words)


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
        own = (k, *at_rest(place))
        law = k.symbol * q + sum(one.symbol for one in own[1:])
        element = restoring(place, place.name_of(self.word), law)
        edit = place.insert(element, *own)
        words = f"{place.a(E)} proportional to {place.domain.displacement}"
        extends = ("constant_bias",)
        yield self.hypothesis(place, edit, law, own, words, extends=extends)


class HardeningSpring(AbstractPhysics):
    """A spring whose stiffness grows (or falls) with deflection."""

    word = "hardening_spring"
    reference = "Duffing 1918"
    passivity = Passivity.STORING
    signature = "resonance moves with amplitude; odd harmonics"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where the displacement is known, and for a C on a 0-junction.

        Once about the origin, and once about wherever it rests: the zero of an encoder
        is where it was switched on.
        """
        if isinstance(place, OneJunctionPlace) and place.displacement_known:
            yield self._beside(place)
            yield self._about_its_rest(place, alone=False)
            if not place.has_free_linear(Compliance):
                yield self._about_its_rest(place, alone=True)
        if isinstance(place, ElementPlace) and isinstance(place.element, Compliance):
            on_one = place.is_one_junction(place.junctions[0])
            if not on_one and q in place.usual_law.free_symbols:
                yield self._own(place)

    def _beside(self, place: OneJunctionPlace) -> Hypothesis:
        some = 0.2 * place.effort / place.displacement**3
        k = place.strength("cubic_stiffness", place.unit(E, Q, 3), (0.0, some))
        law = k.symbol * q**3
        element = restoring(place, place.name_of(self.word), law)
        words = f"{place.a(E)} that grows with the cube of {place.domain.displacement}"
        springs = (n.name for n in place.neighbours if isinstance(n, Compliance))
        return self.hypothesis(
            place, place.insert(element, k), law, (k,), words, also=tuple(springs)
        )

    def _about_its_rest(self, place: OneJunctionPlace, *, alone: bool) -> Hypothesis:
        """Return c (q - a)^3 multiplied out: its parameters then act in proportion.

        Beside another spring, which gives the linear part and the preload, or alone.
        """
        some = 0.2 * place.effort / place.displacement**3
        k = place.strength("cubic_stiffness", place.unit(E, Q, 3), (0.0, some))
        bend = place.strength("square_stiffness", place.unit(E, Q, 2))
        own, extends = [k, bend], [self.word]
        law = k.symbol * q**3 + bend.symbol * q**2
        if alone:
            slope = place.strength("stiffness", place.unit(E, Q))
            preload = at_rest(place)
            law += slope.symbol * q + sum(one.symbol for one in preload)
            own += [slope, *preload]
            extends += ["spring", "constant_bias"]
        element = restoring(place, place.name_of(self.word), law)
        words = (
            f"{place.a(E)} that grows with the cube of {place.domain.displacement} "
            f"from where it rests{', and in proportion' if alone else ''}"
        )
        edit = place.insert(element, *own)
        return self.hypothesis(
            place, edit, law, tuple(own), words, extends=tuple(extends)
        )

    def _own(self, place: ElementPlace) -> Hypothesis:
        some = 0.2 * place.effort / place.content**3
        k = place.strength("cubic_stiffness", place.unit(E, Q, 3), (0.0, some))
        law = place.usual_law + k.symbol * q**3
        words = (
            f"{place.name} gives {place.a(E)} that also grows with the cube of "
            f"{place.domain.displacement}"
        )
        return self.hypothesis(
            place, place.replace(law, k), law, (k,), words, also=place.junctions
        )


TOUCH = 3e-3
"""Of the way: so far in, a stop that takes its losses at once has all of them."""


class EndStop(AbstractPhysics):
    """A stop at one end of the way, elastic and with losses while it is pressed."""

    word = "end_stop"
    reference = "Hunt and Crossley, J. Applied Mechanics 42, 1975; Kelvin-Voigt body"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "motion that ends at one position however hard it is driven; taken for a "
        "hardening spring where the stop is soft"
    )
    domains = MECHANICAL
    shares = (0.5, 0.65, 0.8, 0.95, 0.99)
    """Of the way that was seen: where a stop is looked for, a hard one at the end."""

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield the upper and the lower stop where the displacement is known."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if place.displacement_known:
            low, high = place.displacement_range
            for at_once in (False, True):
                yield self._stop(place, low, high, side=1, at_once=at_once)
                yield self._stop(place, high, low, side=-1, at_once=at_once)

    def _stop(
        self,
        place: OneJunctionPlace,
        begin: float,
        end: float,
        *,
        side: int,
        at_once: bool,
    ) -> Hypothesis:
        """Return a stop whose losses grow as it is pressed, or are there at once."""
        way = abs(end - begin)
        at = tuple(begin + share * (end - begin) for share in self.shares)
        # What stops a motion within the rest of the way takes all effort there.
        some = tuple(place.effort / ((1.0 - share) * way) for share in self.shares)
        none = (0.0,) * len(at)
        end_name = "upper" if side > 0 else "lower"
        stop = place.shape(f"{end_name}_stop", place.unit(Q), at * 2)
        k = place.strength(
            f"{end_name}_stop_stiffness", place.unit(E, Q), none + some, low=0.0
        )
        touch = TOUCH * way
        unit = place.unit(E, F) if at_once else place.per(place.unit(E), Q, F)
        depth = 0.1 * way if at_once else 1.0
        damping = tuple(0.2 * stiff * depth / place.flow for stiff in some)
        d = place.strength(f"{end_name}_stop_damping", unit, none + damping, low=0.0)
        pressed = sympy.Max(side * (q - stop.symbol), 0)
        lost = sympy.Min(pressed / touch, 1) if at_once else pressed
        # What leaves quickly is let go: a stop pushes and never pulls.
        law = side * sympy.Max(0, k.symbol * pressed + side * d.symbol * lost * f)
        element = restoring(place, place.name_of(f"{end_name}_end_stop"), law)
        words = (
            f"{place.a(E)} that stops the motion at {'an upper' if side > 0 else 'a'}"
            f"{'' if side > 0 else ' lower'} end of its way"
            f"{', with losses from the first touch' if at_once else ''}"
        )
        edit = place.insert(element, stop, k, d)
        return self.hypothesis(place, edit, law, (stop, k, d), words)


class Cogging(AbstractPhysics):
    """An effort that repeats along the way: poles, teeth, an eccentric wheel."""

    word = "cogging"
    reference = "detent torque of permanent magnet machines: Hanselman 2006"
    passivity = Passivity.STORING
    signature = "ripple fixed to the position, whose frequency rises with speed"
    turns = (*range(2, 101), 120, 144, 200)
    cycles = tuple(0.5 * half for half in range(3, 65))
    domains = MECHANICAL

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where the displacement is known, behind a gear too.

        Whole numbers per turn are tried on a shaft that turns round (once per turn is
        gravity's law), numbers of periods over the way elsewhere: halves of them, for
        between two numbers that differ by one a fit does not find its way. Nothing
        repeats along how far a spring is stretched.
        """
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if place.displacement_signal is None or place.gives:
            return
        low, high = place.displacement_range
        turns = place.domain == ROTATION and high - low > 2.0 * math.pi
        along = tuple(2.0 * math.pi * n / (high - low) for n in self.cycles)
        waves = tuple(map(float, self.turns)) if turns else along
        # A period and less over the way is a spring that is not straight.
        least = 1.0 if turns else along[0]
        n = place.shape("cogging_wave", place.per("1", Q), waves, low=least)
        a = place.strength("cogging_sine", place.unit(E))
        b = place.strength("cogging_cosine", place.unit(E))
        law = a.symbol * sympy.sin(n.symbol * q) + b.symbol * sympy.cos(n.symbol * q)
        element = restoring(place, place.name_of(self.word), law)
        words = f"{place.a(E)} that repeats along the {place.domain.displacement}"
        edit = place.insert(element, a, b, n)
        yield self.hypothesis(place, edit, law, (a, b, n), words)
