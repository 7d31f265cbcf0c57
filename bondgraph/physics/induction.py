"""Currents that a coil induces beside itself: shorted turns, and eddies in its iron.

Seen from its terminals such a loop, however well it is coupled, is a part of the
inductance with a resistance across it; what is coupled in full is a resistance across
all of it (`leakage.Bypass`).
"""

from collections.abc import Iterator

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import F, P, Place
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.physics.relaxation import bridged, size_to_fill, time_to_fill
from bondgraph.structure.domains import ELECTRICAL
from bondgraph.structure.elements import Inertance, Resistance
from bondgraph.structure.signals import f, p


class InducedCurrent(AbstractPhysics):
    """A part of an inductance across which a loop nearby is shorted."""

    word = "added_inertia"
    reference = "shorted secondary of a transformer; LR-2 model: Vanderkooy 1989"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "a current quicker at first than its inductance lets it, and then slower; "
        "taken for a smaller inductance or a larger resistance"
    )
    domains = frozenset({ELECTRICAL})

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction with an inductance."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if not any(isinstance(node, Inertance) for node in place.neighbours):
            return
        size = 0.1 * place.momentum / place.flow
        shared = size_to_fill(place, "induced_inductance", place.unit(P, F), size)
        tau = time_to_fill(place, "induced_time")
        loop = place.name_of("induced")
        part = Inertance(f"{loop}_part", law=p / shared.symbol)
        loss = Resistance(f"{loop}_losses", law=shared.symbol / tau.symbol * f)
        added = (shared.parameter, tau.parameter)
        edit = bridged(place, part, loop, loss, added)
        words = "a current that is induced nearby: eddies, or a shorted turn"
        yield self.hypothesis(place, edit, part.law, (shared, tau), words)
