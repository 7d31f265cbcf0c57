"""Efforts that bind at speed: drag with the square of the flow, and a speed limit."""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import ELECTRIC, FLUID, MECHANICAL, E, F, Place
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.domains import HYDRAULIC
from bondgraph.structure.elements import Resistance
from bondgraph.structure.signals import f


class QuadraticDrag(AbstractPhysics):
    """Effort proportional to the square of the flow, against it."""

    word = "quadratic_drag"
    reference = "Newton's drag law; turbulent pressure loss (Darcy-Weisbach)"
    passivity = Passivity.DISSIPATIVE
    signature = "losses only at speed; taken for viscous friction over a narrow range"
    domains = MECHANICAL | FLUID | ELECTRIC

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        some = 0.2 * place.effort / place.flow**2
        b = place.strength("quadratic", place.unit(E, F, 2), (0.0, some), low=0.0)
        law = b.symbol * f * sympy.Abs(f)
        element = Resistance(place.name_of(self.word), law=law)
        words = f"{place.a(E)} that grows with the square of {place.domain.flow}"
        if place.domain == HYDRAULIC:
            words += " (turbulent flow)"
        yield self.hypothesis(place, place.insert(element, b), law, (b,), words)


class SpeedLimit(AbstractPhysics):
    """A flow that does not pass a limit, whatever drives it."""

    word = "saturation"
    reference = "no-load speed of a drive; choked flow"
    passivity = Passivity.DISSIPATIVE
    signature = "motion at one speed while more is asked for; taken for drag"
    domains = MECHANICAL | FLUID

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        low, high = place.scales.range_of(f"{F}({place.name})", place.flow)
        peak = max(abs(low), abs(high))
        limits = tuple(share * peak for share in (0.9, 0.75, 0.6, 0.45))
        unit = place.unit(F)
        limit = place.shape("flow_limit", unit, limits * 2, low=0.05 * peak)
        none = (0.0,) * len(limits)
        some = (3.0 * place.effort / place.flow,) * len(limits)
        k = place.strength("flow_limit_steepness", place.unit(E, F), none + some, low=0)
        law = k.symbol * (f - sympy.Max(sympy.Min(f, limit.symbol), -limit.symbol))
        element = Resistance(place.name_of("flow_limit"), law=law)
        words = f"a limit that the {place.domain.flow} does not pass"
        edit = place.insert(element, limit, k)
        yield self.hypothesis(place, edit, law, (limit, k), words)
