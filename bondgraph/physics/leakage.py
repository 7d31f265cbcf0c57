"""Flows that are lost, or that pass between two stocks, in proportion to effort."""

from collections.abc import Iterator

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MOTION, E, F, Place
from bondgraph.physics.places.bond import BondPlace
from bondgraph.physics.places.junction import ZeroJunctionPlace
from bondgraph.physics.places.pair import StockPair
from bondgraph.structure.domains import (
    ANALOGUE,
    ELECTRICAL,
    HYDRAULIC,
    THERMAL,
)
from bondgraph.structure.edits import GraphEdit
from bondgraph.structure.elements import Compliance, EffortSource, Resistance
from bondgraph.structure.signals import e, f

SLIPPING = (0.003, 0.01, 0.03, 0.1, 0.3)
"""Shares of the motion that may be lost at the usual effort, where a fit begins."""


class Leak(AbstractPhysics):
    """A flow out of a 0-junction, or to another one, proportional to effort."""

    word = "leak"
    reference = "laminar leakage; insulation resistance; heat loss and conduction"
    passivity = Passivity.DISSIPATIVE
    signature = "a stock that empties by itself; taken for a smaller source"
    domains = frozenset({HYDRAULIC, ELECTRICAL, THERMAL, ANALOGUE})

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions without a freely fitted linear R, and for pairs."""
        if isinstance(place, StockPair) and self.suits(place):
            yield self._between(place)
        if not isinstance(place, ZeroJunctionPlace) or not self.suits(place):
            return
        if not place.has_free_linear(Resistance):
            yield self._out_of(place)

    def _out_of(self, place: ZeroJunctionPlace) -> Hypothesis:
        some = 0.2 * place.flow / place.effort
        g = place.strength("leak", place.unit(F, E), (0.0, some), low=0.0)
        law = g.symbol * e
        element = Resistance(place.name_of(self.word), law=law)
        words = f"{place.a(F)} lost in proportion to {place.domain.effort}"
        return self.hypothesis(place, place.insert(element, g), law, (g,), words)

    def _between(self, place: StockPair) -> Hypothesis:
        some = 0.2 * place.flow / place.effort
        stem = f"leak_to_{place.second}_from"
        g = place.strength(stem, place.unit(F, E), (0.0, some), low=0.0)
        law = g.symbol * e
        element = Resistance(place.name_of(f"path_to_{place.second}_from"), law=law)
        words = (
            f"{place.a(F)} from {place.name} to {place.second} in proportion to the "
            f"difference of {place.domain.effort}"
        )
        return self.hypothesis(place, place.connect(element, g), law, (g,), words)


class Slip(Leak):
    """Motion lost between two parts in proportion to what they transmit."""

    word = "slip"
    reference = "creep of belts; fluid couplings; Maxwell body"
    signature = "the far side falls behind under load and does not come back"
    domains = MOTION
    stem = "slip_resistance"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions, and where both sides of a bond move on their own."""
        if isinstance(place, ZeroJunctionPlace) and not _gives_way(place):
            if self.suits(place):
                yield self._tied(place)
            return
        yield from Leak.propose(self, place)
        if not isinstance(place, BondPlace) or not self.suits(place):
            return
        if place.both_sides_resist:
            yield self._tied(place)

    def _tied(self, place: BondPlace | ZeroJunctionPlace) -> Hypothesis:
        """Return it between two sides that the model ties; the stiffer, the less.

        A leak of none has no solution there: both sides would set the effort.
        """
        words = (
            f"the two sides of {place.name} slip past each other in proportion to the "
            f"{place.domain.effort} that it passes on"
        )
        return self._past(place, words)

    def _past(self, place: BondPlace | ZeroJunctionPlace, words: str) -> Hypothesis:
        """Return a resistance across the difference of both sides' flows."""
        usual = place.effort / place.flow
        starts = tuple(usual / share for share in SLIPPING)
        grip = place.shape(self.stem, place.unit(E, F), starts, low=0.0)
        name = place.name_of(self.word)
        law = grip.symbol * f
        if isinstance(place, BondPlace):
            loss = Resistance(f"{name}_losses", law=law)
            edit: GraphEdit = place.loosen(name, (loss,), grip)
        else:
            edit = place.insert(Resistance(name, law=law), grip)
        return self.hypothesis(place, edit, law, (grip,), words)


class Bypass(Slip):
    """A flow that does not pass on through what follows, in proportion to effort."""

    word = "leak"
    reference = "eddy currents and iron loss across an inductance; leakage past a pump"
    signature = "a quick answer before that of the inductance; less arrives than leaves"
    domains = frozenset({HYDRAULIC, ELECTRICAL})
    stem = "bypass_resistance"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it where both sides of a bond set a flow of their own."""
        if not isinstance(place, BondPlace) or not self.suits(place):
            return
        if place.both_sides_resist:
            words = (
                f"{place.a(F)} past {place.name} in proportion to {place.domain.effort}"
            )
            yield self._past(place, words)


def _gives_way(place: ZeroJunctionPlace) -> bool:
    """Return whether something there sets the effort without a slip."""
    sets = Compliance | EffortSource
    return any(isinstance(node, sets) for node in place.neighbours)
