"""Heat: radiation, and resistances and magnets that change as they warm."""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.in_time import SILENT, in_time, warm_ups
from bondgraph.physics.places.base import HEAT, MOTION, Coefficient, E, F, Place
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import ZeroJunctionPlace
from bondgraph.structure.domains import ELECTRICAL, THERMAL
from bondgraph.structure.edits import SignalState
from bondgraph.structure.elements import (
    Compliance,
    Gyrator,
    Resistance,
    ZeroJunction,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import displacement, e, effort, flow

ICE = 273.15
ROOM = 293.15
"""Kelvin; efforts that stay below `COLD` are taken for temperatures above a room's."""
COLD = 150.0


class Radiation(AbstractPhysics):
    """Heat lost with the fourth power of the absolute temperature.

    A model may count temperatures from absolute zero, from the freezing point or from
    the room; typical sizes tell which, and the surroundings' temperature is fitted.
    """

    word = "radiation"
    reference = "Stefan 1879, Boltzmann 1884"
    passivity = Passivity.DISSIPATIVE
    signature = "a loss that grows faster than the temperature; nearly linear near it"
    domains = HEAT

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at every 0-junction."""
        if not isinstance(place, ZeroJunctionPlace) or not self.suits(place):
            return
        absolute = place.effort > COLD
        zero = place.constant("radiation_zero", "K", 0.0 if absolute else ICE)
        room = place.shape("radiation_room", "K", (ROOM,), low=200.0, high=600.0)
        k = place.strength("radiation", "W", (0.0, 0.2 * place.flow), low=0.0)
        hot = (e + zero.symbol) / ROOM
        law = k.symbol * (hot**4 - (room.symbol / ROOM) ** 4)
        element = Resistance(place.name_of(self.word), law=law)
        words = "heat lost with the fourth power of the absolute temperature"
        edit = place.insert(element, k, room, zero)
        yield self.hypothesis(place, edit, law, (k, room, zero), words)


FILAMENTS_WARM, BODIES_WARM = 0.01, 2.0
"""Seconds: no wire is warm sooner than the first; no bearing, damper or filter is warm,
or dirty, sooner than the second.
"""


class TemperatureDependentResistance(AbstractPhysics):
    """A resistance that changes as its own losses warm it.

    Its rise x follows the power it takes, late: x' = (h e f - x) / tau, and the law is
    that of the resistance times 1 + x. A winding's grows, a lubricant's falls. Or it
    changes in the course of a recording, whatever it takes. A wall between two
    temperatures has their mean. Where the model has bodies that hold heat, it may be as
    warm as one of them.
    """

    word = "temperature_dependent_resistance"
    reference = "Ohm's law with a temperature coefficient; first-order warm-up"
    passivity = Passivity.DISSIPATIVE
    signature = "a resistance that drifts over minutes of use; taken for wear or bias"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every linear R; a thermal one is as warm as what it joins."""
        if not isinstance(place, ElementPlace):
            return
        if not isinstance(place.element, Resistance) or place.element.law is not None:
            return
        if place.domain == THERMAL:
            yield self._by_place(place)
            return
        yield self._by_use(place)
        yield from in_time(self, place, place.junctions[0], _quickest(place))
        for body in _bodies(place.graph):
            yield _by_body(self, place, body)

    def _by_place(self, place: ElementPlace) -> Hypothesis:
        temperature = _mean_temperature(place)
        a = place.strength("temperature_slope", "1/K", (0.0, 0.2 / place.effort))
        law = place.usual_law * (1 + a.symbol * temperature)
        words = f"{place.name} changes with the temperature of what it joins"
        edit = place.replace(law, a)
        return self.hypothesis(place, edit, law, (a,), words, also=place.junctions)

    def _by_use(self, place: ElementPlace) -> Hypothesis:
        some = 0.2 / (place.effort * place.flow)
        h = place.strength("warming", place.per("1", E, F), (*SILENT, some))
        power = effort(place.name) * flow(place.name)
        words = f"{place.name} changes as it warms"
        if place.domain != ELECTRICAL:
            # No temperature is seen, and a filter that clogs looks the same.
            words = f"{place.name} changes by what it has borne: warmth, wear or dirt"
        return _warmed(self, place, h, power, _quickest(place), words)


class TemperatureDependentGyrator(AbstractPhysics):
    """A motor constant that changes as the losses of the winding warm its magnets.

    Its rise x follows those losses, late: x' = (h f^2 - x) / tau with the winding's
    current f, and the law is the constant times 1 + x. Or it changes in the course of a
    recording, whatever the winding does. Where the model has bodies that hold heat, the
    magnets may be as warm as they are.
    """

    word = "temperature_dependent_gyrator"
    reference = "remanence with a temperature coefficient; first-order warm-up"
    passivity = Passivity.STORING
    signature = "a torque per current that drifts over minutes; taken for friction"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every GY between a winding and what it moves."""
        if not isinstance(place, ElementPlace):
            return
        if not isinstance(place.element, Gyrator):
            return
        domains = {place.graph.domain_at(name): name for name in place.junctions}
        winding = domains.get(ELECTRICAL, "")
        if not winding or not MOTION & domains.keys():
            return
        if place.is_one_junction(winding):
            least = _quickest(place, BODIES_WARM)
            yield self._by_use(place, winding, least)
            yield from in_time(self, place, winding, least)
        for body in _bodies(place.graph):
            yield _by_body(self, place, body)

    def _by_use(self, place: ElementPlace, winding: str, least: float) -> Hypothesis:
        current = flow(winding)
        weaker = -0.1 / place.scales.of(current.name) ** 2
        h = place.strength("warming", "1/A^2", (*SILENT, weaker))
        words = f"{place.name} changes as its magnets warm or cool"
        return _warmed(self, place, h, current**2, least, words)


def _warmed(
    physics: AbstractPhysics,
    place: ElementPlace,
    h: Coefficient,
    heat: sympy.Expr,
    least: float,
    words: str,
) -> Hypothesis:
    """Return that an element changes by a rise x of its own: x' = (h heat - x) / tau.

    Parameters
    ----------
    least
        Seconds in which it warms at least.
    """
    tau = place.shape("warming_time", "s", warm_ups(place) * 2, low=least)
    name = place.name_of("rise")
    rate = (h.symbol * heat - displacement(name)) / tau.symbol
    law = place.usual_law * (1 + displacement(name))
    edit = place.replace(law, h, tau, states=(SignalState(name, rate),))
    return physics.hypothesis(place, edit, law, (h, tau), words, also=place.junctions)


def _quickest(place: ElementPlace, least: float | None = None) -> float:
    """Return the least time in which it may warm, as a wire or a body by its domain."""
    if least is None:
        least = FILAMENTS_WARM if place.domain == ELECTRICAL else BODIES_WARM
    return max(0.003 * place.scales.stretch, least)


def _by_body(physics: AbstractPhysics, place: ElementPlace, body: str) -> Hypothesis:
    """Return that an element is another one where a body of the model is warm."""
    temperature = effort(body)
    typical = place.scales.of(temperature.name)
    absolute = typical > COLD
    zero = place.constant(f"usual_at_{body}", "K", ROOM if absolute else 0.0)
    some = 0.2 / (ROOM if absolute else typical)
    stem = f"temperature_slope_{body}"
    a = place.strength(stem, "1/K", (0.0, some))
    law = place.usual_law * (1 + a.symbol * (temperature - zero.symbol))
    words = f"{place.name} changes with the temperature of {body}"
    edit = place.replace(law, a, zero)
    return physics.hypothesis(place, edit, law, (a, zero), words, also=place.junctions)


def _bodies(graph: FinishedGraph) -> list[str]:
    """Return the junctions of a common temperature at which heat is stored."""
    return [
        node.name
        for node in graph.nodes
        if isinstance(node, ZeroJunction)
        and graph.domain_at(node.name) == THERMAL
        and any(
            isinstance(graph.node(bond.other(node.name)), Compliance)
            for bond in graph.bonds_at(node.name)
        )
    ]


def _mean_temperature(place: ElementPlace) -> sympy.Expr:
    """Return the mean of the temperatures around a thermal resistance."""
    (junction,) = place.junctions
    if not place.is_one_junction(junction):
        return effort(junction)
    bonds = place.graph.bonds_at(junction)
    around = [bond.name for bond in bonds if bond.other(junction) != place.name]
    return sympy.Add(*map(effort, around)) / len(around)
