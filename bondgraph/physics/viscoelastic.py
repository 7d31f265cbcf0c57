"""Springs that relax: a part of their stiffness yields in time.

Rubber, tissue and rope do it by what they are made of, an air spring by a capillary to
a second chamber. Beside the lasting spring stands another one behind a damper, the
standard linear solid: quick motion meets both of them, slow motion the first alone, and
in between the damper takes out power.
"""

from collections.abc import Iterator

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MECHANICAL, E, Place, Q
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.physics.relaxation import FASTEST, bridged, size_to_fill
from bondgraph.structure.elements import Compliance, Resistance
from bondgraph.structure.signals import f, q

TIMES = (1.0, 0.2, 5.0)
"""Of the time in which the place moves: what relaxes about then shows the most."""


class RelaxingSpring(AbstractPhysics):
    """A second spring behind a damper, beside a spring."""

    word = "added_compliance"
    reference = "Maxwell 1867; standard linear solid: Zener 1948"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "stiffer the quicker it moves, with losses that fall at high frequency; taken "
        "for viscous friction, hysteresis, or a lag of what drives it"
    )
    domains = MECHANICAL

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction with a spring."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if not any(isinstance(node, Compliance) for node in place.neighbours):
            return
        size = place.effort / place.displacement
        stiff = size_to_fill(place, "relaxing_stiffness", place.unit(E, Q), size)
        low, slowest = FASTEST * place.scales.step, place.scales.slowest
        period = place.displacement / place.flow
        times = tuple(min(max(share * period, 2 * low), slowest / 2) for share in TIMES)
        tau = place.shape("relaxation_time", "s", times * 2, low=low, high=slowest)
        behind = place.name_of("relaxing")
        spring = Compliance(f"{behind}_spring", law=stiff.symbol * q)
        damper = Resistance(f"{behind}_damper", law=stiff.symbol * tau.symbol * f)
        added = (stiff.parameter, tau.parameter)
        edit = bridged(place, spring, behind, damper, added)
        words = "a second spring behind a damper: a part of the stiffness relaxes"
        yield self.hypothesis(place, edit, spring.law, (stiff, tau), words)
