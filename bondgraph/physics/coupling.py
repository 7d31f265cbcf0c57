"""What acts between two motions that the model does not let act on each other.

A wheel that spins couples the two tilts of what carries it; two windings near each
other, two axes on one frame, share what moves; two bodies drag or pull each other.
"""

from collections.abc import Iterator

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MOTION, E, F, P, Place, Q
from bondgraph.physics.places.pair import ApartPair, MotionPair
from bondgraph.structure.domains import ELECTRICAL
from bondgraph.structure.elements import EffortSource, Gyrator, Inertance, Resistance
from bondgraph.structure.signals import f


class GyroscopicCoupling(AbstractPhysics):
    """Each of two motions gets an effort in proportion to the other's flow.

    The two take as much power from one as they give to the other.
    """

    word = "gyroscopic_coupling"
    reference = "Euler's equations of a spinning body; Coriolis forces of small motions"
    passivity = Passivity.STORING
    signature = "one axis moves when the other is driven, a quarter of a swing later"
    domains = MOTION

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for two motions that nothing joins."""
        if not isinstance(place, ApartPair) or not self.suits(place):
            return
        some = 0.2 * place.effort / place.flow
        r = place.strength("gyration", place.unit(E, F), (0.0, some, -some))
        law = r.symbol
        edit = place.couple(Gyrator(place.name_of(self.word), law=law), r)
        flow = place.domain.flow
        words = (
            f"{place.a(E)} on {place.second} proportional to the {flow} of "
            f"{place.name}, and the opposite one back"
        )
        yield self.hypothesis(place, edit, law, (r,), words)


class Drag(AbstractPhysics):
    """Two motions drag each other in proportion to the difference of their flows."""

    word = "viscous_friction"
    reference = "Newton's law of viscosity; Stokes; magnetic drag"
    passivity = Passivity.DISSIPATIVE
    signature = "one is carried along when the other moves; taken for friction of both"
    domains = MOTION

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for two motions that nothing joins, or a third one only."""
        if not isinstance(place, MotionPair) or not self.suits(place):
            return
        some = 0.2 * place.effort / place.flow
        b = place.strength("drag", place.unit(E, F), (0.0, some), low=0.0)
        law = b.symbol * f
        element = Resistance(place.name_of(f"drag_of_{place.second}_on"), law=law)
        words = (
            f"{place.a(E)} between {place.name} and {place.second} proportional to the "
            f"difference of {place.domain.flow}"
        )
        yield self.hypothesis(place, place.connect(element, b), law, (b,), words)


class Tie(AbstractPhysics):
    """Two motions pull each other in proportion to the difference of displacements."""

    word = "spring"
    reference = "Hooke's law"
    passivity = Passivity.STORING
    signature = "two resonances where each had one; beats between the two"
    domains = MOTION

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for such two of known displacements."""
        if not isinstance(place, MotionPair) or not self.suits(place):
            return
        if place.way is None:
            return
        some = 0.2 * place.effort / place.displacement
        k = place.strength("stiffness", place.unit(E, Q), (0.0, some), low=0.0)
        law = k.symbol * place.way
        name = place.name_of(f"spring_of_{place.second}_on")
        edit = place.connect(EffortSource(name, value=-law), k)
        words = (
            f"{place.a(E)} between {place.name} and {place.second} proportional to the "
            f"difference of {place.domain.displacement}"
        )
        yield self.hypothesis(place, edit, law, (k,), words)


class SharedInertia(AbstractPhysics):
    """Inertia that moves with two motions: with their sum, or with their difference."""

    word = "added_inertia"
    reference = "mutual inductance; inertial coupling of two axes"
    passivity = Passivity.STORING
    signature = "one accelerates when the other does"
    domains = MOTION | {ELECTRICAL}

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield both for two motions that nothing joins."""
        if not isinstance(place, ApartPair) or not self.suits(place):
            return
        yield from (self._moving(place, summed=summed) for summed in (True, False))

    def _moving(self, place: ApartPair, *, summed: bool) -> Hypothesis:
        some = 0.1 * place.momentum / place.flow
        which = "sum" if summed else "difference"
        unit = place.unit(P, F)
        starts = (1e-3 * some, some)
        inertia = place.shape(f"inertia_of_{which}", unit, starts, low=0.0)
        edit = place.connect(Inertance(inertia.name), inertia, summed=summed)
        words = (
            f"inertia that moves with the {which} of the {place.domain.flow} of "
            f"{place.name} and {place.second}"
        )
        law = inertia.symbol * f
        return self.hypothesis(place, edit, law, (inertia,), words)
