"""Flexible parts: some of what moves is tied by a spring of its own.

A link that bends has modes; seen from its root each is a mass on a spring, whatever the
shape of the link (Hughes, J. Astronautical Sciences 22, 1974).
"""

import math
from collections.abc import Iterator

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MECHANICAL, F, P, Place
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.edits import InsertElement, LoosenBond, SeveralEdits
from bondgraph.structure.elements import Compliance, Inertance, Resistance
from bondgraph.structure.graph import Bond
from bondgraph.structure.signals import f, p, q

RATES = 4
"""How many natural frequencies are tried, from slow to fast."""


class FlexibleMode(AbstractPhysics):
    """A mode of a part that bends: a mass that is tied by a spring and a damper."""

    word = "compliance"
    reference = "modal masses of a flexible appendage: Hughes 1974"
    passivity = Passivity.DISSIPATIVE
    signature = "a resonance with an antiresonance below it; taken for added inertia"
    domains = MECHANICAL

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction with an inertia."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if not any(isinstance(node, Inertance) for node in place.neighbours):
            return
        mass = 0.1 * place.momentum / place.flow
        masses = (1e-3 * mass,) * RATES + (mass,) * RATES
        m = place.strength("mode_inertia", place.unit(P, F), masses, low=1e-6 * mass)
        w = place.shape("mode_frequency", "rad/s", _rates(place) * 2, low=0.0)
        # What bends rings. What follows slowly is a drift, whose mass means nothing.
        z = place.shape("mode_damping", "1", (0.05,), low=0.0, high=1.0)
        name = place.name_of("mode")
        part = Inertance(f"{name}_part", law=p / m.symbol)
        spring = Compliance(f"{name}_spring", law=m.symbol * w.symbol**2 * q)
        loss = 2 * z.symbol * m.symbol * w.symbol * f
        ties = (spring, Resistance(f"{name}_damper", law=loss))
        added = tuple(c.parameter for c in (m, w, z))
        edit = SeveralEdits(
            (
                InsertElement(place.name, part, added[:1]),
                LoosenBond(Bond(place.name, part.name), name, ties, added),
            )
        )
        words = "a part that moves along on a spring: something there bends"
        yield self.hypothesis(place, edit, spring.law, (m, w, z), words)


def _rates(place: OneJunctionPlace) -> tuple[float, ...]:
    """Return frequencies that the recording can show, evenly in their logarithm.

    Of these the nearest gives way to each at which something rings.
    """
    slow = 2.0 * math.pi * 3.0 / place.scales.stretch
    fast = max(0.3 * math.pi / place.scales.step, 2.0 * slow)
    rates = [slow * (fast / slow) ** ((i + 0.5) / RATES) for i in range(RATES)]
    for rings in place.scales.ringing:
        rates.remove(min(rates, key=lambda rate: abs(math.log(rate / rings))))
    return (*place.scales.ringing, *rates)
