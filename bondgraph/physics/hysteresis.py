"""Friction with memory: an effort that depends on the way it came.

The memory z of Dahl's law lies between -1 and 1. It follows the flow until it
saturates, over a distance w, the presliding: z' = (f - |f| z) / w. The effort is s z.
It stores s w z²/2 and takes out s |f| z² >= 0, so it only ever loses power. Motion that
goes one way only shows no memory: there it is Coulomb friction, or a late start. And
where w is next to none it is Coulomb friction that holds, and is told as that.
"""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from bondgraph.physics.hypothesis import (
    AbstractPhysics,
    Hypothesis,
    Limit,
    Memory,
    Passivity,
)
from bondgraph.physics.places.base import MECHANICAL, Coefficient, E, Place, Q
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.edits import SignalState
from bondgraph.structure.elements import EffortSource
from bondgraph.structure.signals import displacement, flow

SHARES = (0.03, 0.1, 0.4)
"""Presliding distances that fits start from, in typical displacements."""

SKEWS = (*(0.0,) * len(SHARES), *(0.25,) * len(SHARES), -0.5)
"""Starts of r beside those: at -1 a loop is loaded along a straight line."""

AT_ONCE = 2.0
"""A presliding of so many times the least one is none: it is dry friction."""

MOST = 1.0
"""The memory of Dahl's law; with a skew below -1 it grows as long as it is loaded."""

LONGEST = 0.5
"""Of the distance travelled: a memory that is never used up is a spring's."""


class DahlHysteresis(AbstractPhysics):
    """Friction that is elastic before it slides."""

    word = "hysteresis"
    reference = "Dahl, TOR-0158(3107-18), 1968"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "loops in effort over displacement whatever the speed; taken for Coulomb "
        "friction where the motion is large, for a spring where it is small"
    )
    domains = MECHANICAL

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction whose motion reverses."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if not place.reverses:
            return
        name = place.name_of("memory")
        z, rate = displacement(name), flow(place.name)
        size, way = _size_and_way(place)
        state = SignalState(name, (rate - sympy.Abs(rate) * z) / way.symbol)
        dahl = self._with_memory(place, state, size, (size, way))
        yield replace(dahl, memory=Memory(name, MOST))

    def _with_memory(
        self,
        place: OneJunctionPlace,
        state: SignalState,
        size: Coefficient,
        coefficients: tuple[Coefficient, ...],
        extends: tuple[str, ...] = (),
    ) -> Hypothesis:
        law = size.symbol * state.value
        element = EffortSource(place.name_of("hysteresis"), value=-law)
        words = f"{place.a(E)} against the motion that builds up over a distance"
        edit = place.insert(element, *coefficients, states=(state,))
        found = self.hypothesis(place, edit, law, coefficients, words, extends=extends)
        way = coefficients[1].parameter
        dry = f"{place.a(E)} of constant size against the motion, which holds at rest"
        limit = Limit(way.name, AT_ONCE * way.bounds[0], "coulomb_friction", dry)
        return replace(found, limit=limit)


class BoucWenHysteresis(DahlHysteresis):
    """Hysteresis whose loops are not alike in loading and unloading.

    z' = (f - |f| z - r f |z|) / w, which is Dahl's at r = 0. For r <= 1 it never gives
    power: with 1 / V'(z) between (1 - (1 + r) z) / (w z) and (1 + (1 - r) z) / (w z)
    the store V grows by no more than z f, whether it is loaded or unloaded. Below -1
    the loops grow stiffer as they are loaded.
    """

    reference = "Bouc 1967; Wen, J. Engineering Mechanics 102, 1976; Ismail et al. 2009"
    signature = "loops that are stiff on return; its parameters are hard to tell apart"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction whose motion reverses."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if not place.reverses:
            return
        name = place.name_of("memory")
        z, rate = displacement(name), flow(place.name)
        size, way = _size_and_way(place)
        skew = place.shape("hysteresis_skew", "1", SKEWS, low=-3.0, high=1.0)
        taken = sympy.Abs(rate) * z + skew.symbol * rate * sympy.Abs(z)
        state = SignalState(name, (rate - taken) / way.symbol)
        coefficients = (size, way, skew)
        yield self._with_memory(place, state, size, coefficients, ("hysteresis",))


def _size_and_way(place: OneJunctionPlace) -> tuple[Coefficient, Coefficient]:
    """Return the effort of sliding and the distance before it."""
    low, high = place.displacement_range
    ways = tuple(share * place.displacement for share in SHARES)
    ways = tuple(min(way, LONGEST / 2 * (high - low)) for way in ways)
    none, some = (0.0,) * len(ways), (0.3 * place.effort,) * len(ways)
    size = place.strength("hysteresis", place.unit(E), none + some, low=0.0)
    way = place.shape(
        "presliding",
        place.unit(Q),
        ways * 2,
        low=0.01 * ways[0],
        high=LONGEST * (high - low),
    )
    return size, way
