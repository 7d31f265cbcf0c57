"""Flows that are lost, or that pass between two stocks, in proportion to effort."""

from collections.abc import Iterator

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MOTION, E, F, Place
from bondgraph.physics.places.bond import BondPlace
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import ZeroJunctionPlace
from bondgraph.physics.places.pair import StockPair
from bondgraph.structure.domains import (
    ANALOGUE,
    ELECTRICAL,
    HYDRAULIC,
    THERMAL,
)
from bondgraph.structure.edits import GraphEdit, LoosenBond
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    OneJunction,
    Resistance,
    ZeroJunction,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import e, f

SLIPPING = (0.003, 0.01, 0.03, 0.1, 0.3)
"""Shares of the motion that may be lost at the usual effort, where a fit begins."""


class Leak(AbstractPhysics):
    """A flow out of a 0-junction, or to another one, proportional to effort.

    Or past a store amid a loop, as a capacitor discharges itself.
    """

    word = "leak"
    reference = "laminar leakage; insulation resistance; heat loss and conduction"
    passivity = Passivity.DISSIPATIVE
    signature = "a stock that empties by itself; taken for a smaller source"
    domains = frozenset({HYDRAULIC, ELECTRICAL, THERMAL, ANALOGUE})

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions without a freely fitted linear R, and for pairs.

        And for a C amid a loop, which has no 0-junction of its own.
        """
        if isinstance(place, StockPair) and self.suits(place):
            yield self._between(place)
        if isinstance(place, ElementPlace) and self.suits(place):
            yield from self._past_a_store(place)
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

    def _past_a_store(self, place: ElementPlace) -> Iterator[Hypothesis]:
        """Yield it past a C that the flow of a loop goes through.

        Not past a spring: what relaxes there has a law of its own.
        """
        (junction, *others) = place.junctions
        store = isinstance(place.element, Compliance) and place.domain not in MOTION
        if not store or others or not _amid_a_loop(place.graph, junction):
            return
        some = 0.2 * place.flow / place.effort
        g = place.strength("leak", place.unit(F, E), (0.0, some), low=0.0)
        law = g.symbol * e
        name = place.name_of(self.word)
        loss = Resistance(f"{name}_losses", law=law)
        (bond,) = place.graph.bonds_at(place.name)
        edit = LoosenBond(bond, name, (loss,), (g.parameter,))
        words = (
            f"{place.name} loses what it holds in proportion to its "
            f"{place.domain.effort}"
        )
        yield self.hypothesis(place, edit, law, (g,), words, also=(junction,))

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


def _amid_a_loop(graph: FinishedGraph, junction: str) -> bool:
    """Return whether a 1-junction is no mere branch that hangs on a 0-junction.

    What a branch's store loses is lost where it hangs on, but for what lies between.
    """
    if not isinstance(graph.node(junction), OneJunction):
        return False
    ends = (graph.node(bond.other(junction)) for bond in graph.bonds_at(junction))
    beyond = [type(end) for end in ends if not isinstance(end, Compliance | Resistance)]
    return beyond != [ZeroJunction]


def _gives_way(place: ZeroJunctionPlace) -> bool:
    """Return whether something there sets the effort without a slip."""
    sets = Compliance | EffortSource
    return any(isinstance(node, sets) for node in place.neighbours)
