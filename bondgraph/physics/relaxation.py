"""Stores behind a resistance: what is there takes in more, but only in time.

Beside a stock it is a second one (the wall of a room, the iron of a machine, a vessel
behind an orifice); in a branch of a circuit it is a voltage that builds up behind the
current (polarisation); amid a passage it is what lies between its two sides (the wall
of a heat exchanger, a hose). Each adds one state, which fades with a time of its own.
"""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import (
    ELECTRIC,
    FLUID,
    HEAT,
    Coefficient,
    E,
    F,
    Place,
    Q,
)
from bondgraph.physics.places.junction import (
    JunctionPlace,
    OneJunctionPlace,
    ZeroJunctionPlace,
)
from bondgraph.structure.edits import (
    InsertElement,
    LoosenBond,
    ObstructBond,
    ReplaceRelation,
    SeveralEdits,
)
from bondgraph.structure.elements import Compliance, Junction, OnePort, Resistance
from bondgraph.structure.graph import Bond
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.renaming import Renaming
from bondgraph.structure.signals import f, parameter_symbol, q, signals_in

SHARES = (0.03, 0.1, 0.01)
"""Of a recording's length: the times that fits start from, the middle one first. A fit
that keeps its promise there tries no other.
"""

FASTEST = 5.0
"""Samples: what fills faster is not told from an error of the clock."""


class StoreBehind(AbstractPhysics):
    """A second store behind a resistance: it fills and empties in a time of its own."""

    word = "added_compliance"
    reference = "RC ladders of walls and windings; Randles 1947 (polarisation)"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "a quick answer and then a slow one; taken for a larger stock, a leak or a "
        "slow disturbance"
    )
    domains = FLUID | HEAT | ELECTRIC

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it beside every stock, and in circuits wherever there is a loss."""
        if not isinstance(place, JunctionPlace) or not self.suits(place):
            return
        kinds = {type(node) for node in place.neighbours}
        if isinstance(place, ZeroJunctionPlace) and Compliance in kinds:
            yield self._beside(place)
        if isinstance(place, OneJunctionPlace) and Resistance in kinds:
            yield from self._in_line(place)

    def _beside(self, place: ZeroJunctionPlace) -> Hypothesis:
        """Return a stock beside the one that is there, and what lies between."""
        size = place.displacement / place.effort
        c = size_to_fill(place, "second_capacity", place.unit(Q, E), size)
        tau = time_to_fill(place)
        store = Compliance(place.name_of("second_store"), law=q / c.symbol)
        between = Resistance(
            place.name_of("way_to_second_store"), law=tau.symbol / c.symbol * f
        )
        added = (c.parameter, tau.parameter)
        edit = SeveralEdits(
            (
                InsertElement(place.name, store, added[:1]),
                ObstructBond(
                    Bond(place.name, store.name),
                    place.name_of("behind"),
                    (between,),
                    added,
                ),
            )
        )
        what = {
            "thermal": "a second mass that takes heat, behind a resistance",
            "electrical": "a second capacity behind a resistance",
        }.get(place.domain.name, "a second volume behind a resistance")
        return self.hypothesis(place, edit, store.law, (c, tau), what)

    def _in_line(self, place: OneJunctionPlace) -> Iterator[Hypothesis]:
        """Yield a resistance beside a capacity, through which all current goes."""
        if place.domain not in ELECTRIC:
            return
        size = place.effort / place.flow
        r = size_to_fill(place, "slow_resistance", place.unit(E, F), 0.1 * size)
        tau = time_to_fill(place)
        loss = Resistance(place.name_of("slow_loss"), law=r.symbol * f)
        store = Compliance(place.name_of("slow_store"), law=r.symbol / tau.symbol * q)
        added = (r.parameter, tau.parameter)
        edit = bridged(place, loss, place.name_of("slow"), store, added)
        words = "a voltage that builds up with the current in time: polarisation"
        yield self.hypothesis(place, edit, loss.law, (r, tau), words)


class StoreAmid(AbstractPhysics):
    """A store amid a passage: what flows in at one end comes out late at the other."""

    word = "added_compliance"
    reference = "two halves of a line and the store between: a T section"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "either side answers the other late; taken for larger stores at its ends, or a "
        "lag of a sensor"
    )
    domains = FLUID | HEAT | ELECTRIC

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it amid a passage with one loss, the same in either direction."""
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        graph = place.graph
        losses = [one for one in place.neighbours if isinstance(one, Resistance)]
        ends = [
            bond
            for bond in graph.bonds_at(place.name)
            if isinstance(graph.node(bond.other(place.name)), Junction)
        ]
        if len(losses) != 1 or len(ends) != 2:
            return
        (loss,) = losses
        whole = loss.law or parameter_symbol(loss.name) * f
        if signals_in(whole) or sympy.expand(whole + whole.subs(f, -f)) != 0:
            return
        size = 0.1 * place.flow * place.scales.stretch / place.effort
        c = size_to_fill(place, "capacity_amid", place.unit(Q, E), size)
        store = Compliance(place.name_of("store_amid"), law=q / c.symbol)
        half = Resistance(place.name_of("other_half"), law=whole / 2)
        loosened = LoosenBond(ends[1], place.name_of("amid"), (store,), (c.parameter,))
        beyond = Renaming({place.name: loosened.split}).bond(ends[1])
        edit = SeveralEdits(
            (
                loosened,
                ObstructBond(beyond, place.name_of("behind"), (half,)),
                ReplaceRelation(loss.name, whole / 2, nested=True),
            )
        )
        what = {
            "thermal": "a mass amid it that takes heat from either side",
            "electrical": "a capacity amid it",
        }.get(place.domain.name, "a volume amid it that gives way")
        yield self.hypothesis(place, edit, store.law, (c,), what)


def bridged(
    place: OneJunctionPlace,
    part: OnePort,
    name: str,
    bridge: OnePort,
    added: tuple[Parameter, Parameter],
) -> SeveralEdits:
    """Return the edit that hangs a part at a place with another one across it.

    What flows divides between the two; their effort is one, at a 0-junction `name`.

    Parameters
    ----------
    added
        The number of the part alone, and the one beside it that the bridge has.
    """
    return SeveralEdits(
        (
            InsertElement(place.name, part, added[:1]),
            LoosenBond(Bond(place.name, part.name), name, (bridge,), added),
        )
    )


def size_to_fill(
    place: JunctionPlace, stem: str, unit: str, size: float
) -> Coefficient:
    """Return how much a state that fades holds, in starts of next to none and some."""
    n = len(SHARES)
    starts = (1e-3 * size,) * n + (size,) * n
    return place.strength(stem, unit, starts, low=1e-6 * size)


def time_to_fill(place: JunctionPlace, stem: str = "fill_time") -> Coefficient:
    """Return the time of a state that fades, in starts of `SHARES`, small and large."""
    low = FASTEST * place.scales.step
    times = tuple(max(share * place.scales.stretch, 2 * low) for share in SHARES)
    return place.shape(stem, "s", times * 2, low=low, high=place.scales.slowest)
