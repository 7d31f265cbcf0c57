"""What passes more easily one way: check valves, diodes, rising heat, some dampers."""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import MECHANICAL, Coefficient, E, F, Place
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.structure.domains import ELECTRICAL, HYDRAULIC, THERMAL
from bondgraph.structure.elements import EffortSource, Inertance, Resistance
from bondgraph.structure.signals import e, effort, f

SHARES = (0.0, 0.5, 0.95)
"""From none to nearly all of what would flow back: what fits begin with."""

LEAST = 1e-3
"""The share of what usually flows that passes back where next to nothing does."""


class OneWayPassage(AbstractPhysics):
    """A resistance that is larger backwards, without end in a check valve or a diode.

    Ahead nothing may flow below a pressure that opens it, or a forward voltage. Heat
    has none: it passes so where it is convected, for it rises and hardly sinks. Beside
    an inertance (a coil, a column of liquid) the flow goes on by itself: there it is an
    effort that holds back what would return.
    """

    word = "one_way_passage"
    reference = "check valves: Merritt 1967; diodes, thermosiphons, heat pipes"
    passivity = Passivity.DISSIPATIVE
    signature = "flow that comes and does not go back; taken for a yield beside a bias"
    domains = frozenset({HYDRAULIC, ELECTRICAL, THERMAL})

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every resistance whose flow its effort sets, for both ways.

        And at every 1-junction with an inertance for the ways its flow goes.
        """
        if not self.suits(place):
            return
        if isinstance(place, OneJunctionPlace):
            yield from self._beside_an_inertance(place)
        if not isinstance(place, ElementPlace):
            return
        law = place.flow_law
        if law is None:
            return
        for ahead in (True, False):
            if place.domain != THERMAL:
                yield self._one_way(place, law, ahead=ahead)
            elif _is_seen_to_turn(place):
                yield self._easier_one_way(place, law, ahead=ahead)

    def _beside_an_inertance(self, place: OneJunctionPlace) -> Iterator[Hypothesis]:
        """Yield it for each way in which the flow goes; back of it, less does."""
        if not any(isinstance(node, Inertance) for node in place.neighbours):
            return
        low, high = place.scales.range_of(f"{F}({place.name})", place.flow)
        for way, goes, against in (
            ("", high > 0.0, sympy.Min(f, 0)),
            ("back_", low < 0.0, sympy.Max(f, 0)),
        ):
            if not goes:
                continue
            usual, unit = place.effort / place.flow, place.unit(E, F)
            ratio = place.constant(f"{way}passage", unit, usual)
            less = place.strength(f"{way}one_way", "1", SHARES, low=0.0, high=1.0)
            law = against * ratio.symbol * less.symbol / (1 + LEAST - less.symbol)
            element = Resistance(place.name_of(f"{way}check"), law=law)
            words = (
                f"{place.name} passes less {'ahead' if way else 'back'} than "
                f"{'back' if way else 'ahead'} by the share one_way, and nothing at 1"
            )
            edit = place.insert(element, ratio, less)
            yield self.hypothesis(place, edit, law, (less,), words)

    def _one_way(
        self, place: ElementPlace, usual: sympy.Expr, *, ahead: bool
    ) -> Hypothesis:
        """Return it with the flow, as the bonds point, ahead or back."""
        less = self._less(place, (0.0, 1.0, 1.0), ahead=ahead)
        opens = (0.0, 0.0, 0.1 * place.effort)
        way = "" if ahead else "back_"
        crack = place.strength(f"{way}opening", place.unit(E), opens, low=0.0)
        along, against = sympy.Max(e - crack.symbol, 0), sympy.Min(e, 0)
        if not ahead:
            along, against = sympy.Min(e + crack.symbol, 0), sympy.Max(e, 0)
        law = usual.xreplace({e: along + (1 - less.symbol) * against})
        words = (
            f"{_passes_less(place, ahead=ahead)}, and there only beyond "
            f"{place.a(E)} that opens it"
        )
        edit = place.replace(law, less, crack)
        own = (less, crack)
        return self.hypothesis(place, edit, law, own, words, also=place.junctions)

    def _easier_one_way(
        self, place: ElementPlace, usual: sympy.Expr, *, ahead: bool
    ) -> Hypothesis:
        """Return it without an effort that opens it."""
        less = self._less(place, SHARES, ahead=ahead)
        along, against = sympy.Max(e, 0), sympy.Min(e, 0)
        if not ahead:
            along, against = against, along
        law = usual.xreplace({e: along + (1 - less.symbol) * against})
        words = _passes_less(place, ahead=ahead)
        edit = place.replace(law, less)
        return self.hypothesis(place, edit, law, (less,), words, also=place.junctions)

    def _less(
        self, place: ElementPlace, shares: tuple[float, ...], *, ahead: bool
    ) -> Coefficient:
        """Return the share that does not pass against the way."""
        stem = "one_way" if ahead else "back_one_way"
        return place.strength(stem, "1", shares, low=0.0, high=1.0)


def _is_seen_to_turn(place: ElementPlace) -> bool:
    """Return whether the flow goes both ways between efforts that are known.

    Where one is not, as of a room that nobody measured, a model that lacks something
    lets the flow turn.
    """
    (junction,), graph = place.junctions, place.graph
    read = {measurement.expression for measurement in graph.measurements}
    ends = (bond.other(junction) for bond in graph.bonds_at(junction))
    known = all(
        effort(end) in read
        or any(
            isinstance(graph.node(bond.other(end)), EffortSource)
            for bond in graph.bonds_at(end)
        )
        for end in ends
        if end != place.name
    )
    return known and place.scales.reverses(f"{F}({junction})")


def _passes_less(place: ElementPlace, *, ahead: bool) -> str:
    """Return in words which way less passes."""
    return (
        f"{place.name} passes less {'back' if ahead else 'ahead'} than "
        f"{'ahead' if ahead else 'back'} by the share one_way"
    )


class DirectionDependentDamping(AbstractPhysics):
    """Damping that is larger in one direction: a valve in the damper's piston."""

    word = "direction_dependent_friction"
    reference = "bump and rebound of shock absorbers: Dixon 2007; door closers"
    passivity = Passivity.DISSIPATIVE
    domains = MECHANICAL
    signature = "a slope over the flow with a kink at zero; taken for a bias or drag"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 1-junction, for each direction, where it moves in both.

        Not beside a fitted constant source and a resistance with a law of its own, dry
        friction for instance: each direction has its own line there already, and one
        more slope would only bend them.
        """
        if not isinstance(place, OneJunctionPlace) or not self.suits(place):
            return
        if not place.scales.reverses(f"{F}({place.name})"):
            return
        losses = (n for n in place.neighbours if isinstance(n, Resistance))
        if place.has_free_bias and any(loss.law is not None for loss in losses):
            return
        some = 0.3 * place.effort / place.flow
        for stem, way, moving in (
            ("damping_ahead", "ahead", sympy.Max(f, 0)),
            ("damping_back", "back", sympy.Min(f, 0)),
        ):
            b = place.strength(stem, place.unit(E, F), (0.0, some), low=0.0)
            law = b.symbol * moving
            element = Resistance(place.name_of(f"{way}_only"), law=law)
            words = (
                f"{place.a(E)} proportional to {place.domain.flow}, and only {way}: "
                "the damping differs between the directions"
            )
            edit = place.insert(element, b)
            yield self.hypothesis(place, edit, law, (b,), words)
