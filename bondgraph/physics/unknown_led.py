"""Free curves of a resistance that something elsewhere leads.

A film that a fan cools, a damper with a coil, a valve with its opening: what is wrong
of it follows what leads it, or goes with what its law already makes of that.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import sympy

from bondgraph.physics.bends import Knots
from bondgraph.physics.curves import drawn, even
from bondgraph.physics.hypothesis import Form, Hypothesis, Make, Shape
from bondgraph.physics.places.base import Coefficient, E, F
from bondgraph.physics.places.channels import ChannelPlace, InputPlace, OutputPlace
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.smooth import Smooth
from bondgraph.structure.elements import FlowSource, Resistance
from bondgraph.structure.graph import used_parameters
from bondgraph.structure.signals import Signal, e, f, parameter_symbol

STEERED = 4
"""Knots of what steers a resistance: of two variables a law is told by few."""


def forms_of_led(
    make: Make, place: ElementPlace, smooth: Smooth | None
) -> Iterator[Form]:
    """Yield what makes each curve that something elsewhere has a part in."""
    assert isinstance(place.element, Resistance)
    if _is_led(place.element):
        yield partial(_led, make, place, smooth)
    for channel in _elsewhere(place):
        yield partial(_steered, make, place, channel, smooth)


def _is_led(element: Resistance) -> bool:
    """Return whether its law follows something elsewhere: the coil of a brake, a valve.

    What is wrong of the law grows with that too, and no curve beside it tells it.
    """
    own = {e, f}
    signals = element.law.free_symbols if element.law is not None else set()
    return bool(signals & own) and any(isinstance(s, Signal) for s in signals - own)


@dataclass(frozen=True, slots=True)
class _Along:
    """What a factor of a law goes along: its symbol there, and what is drawn of it."""

    stem: str
    symbol: sympy.Symbol
    shown: Signal
    name: str
    unit: str
    size: float
    knots: Knots


def _led(make: Make, place: ElementPlace, smooth: Smooth | None) -> Hypothesis:
    """Make a resistance that something leads a curve of its own flow or effort too."""
    local = f if place.usual_law.has(f) else e
    quantity, size = (F, place.flow) if local is f else (E, place.effort)
    (junction,), (bond,) = place.junctions, place.graph.bonds_at(place.name)
    shared = place.is_one_junction(junction) == (local is f)
    met = junction if shared else bond.name
    knots = even(place.scales.range_of(f"{quantity}({met})", size), size)
    own, name = Signal(quantity, place.name), place.domain.word(quantity)
    along = _Along("curve", local, own, name, place.unit(quantity), size, knots)
    return _multiplied(make, place, along, smooth)


def _steered(
    make: Make, place: ElementPlace, channel: ChannelPlace, smooth: Smooth | None
) -> Hypothesis:
    """Make a resistance a curve of something that is recorded elsewhere."""
    signal, name = channel.signal, channel.name
    assert isinstance(signal, Signal)
    knots, unit = even(channel.range, channel.peak, STEERED), channel.channel_unit
    stem = f"curve_{name}"
    along = _Along(stem, signal, signal, name, unit, channel.peak, knots)
    return _multiplied(make, place, along, smooth)


def _multiplied(
    make: Make, place: ElementPlace, along: _Along, smooth: Smooth | None
) -> Hypothesis:
    """Multiply the law of a resistance by a curve.

    Its own numbers are in the curve: beside one, only their product shows.
    """
    usual, own = _as_it_is(place)
    width = place.constant(f"{along.stem}_width", along.unit, along.size)
    x = along.symbol / width.symbol
    curve, heights = drawn(place, along.stem, "1", x, along.knots, smooth)
    law, factor = usual * (1 + curve), 1 + curve.subs(along.symbol, along.shown)
    edit = place.replace(law, *heights, width, *own)
    words = f"{place.name} changes with {along.name}"
    found = make(place, edit, law, heights, words, also=place.junctions)
    called = f"{'resistance' if usual.has(f) else 'conductance'} to its usual"
    given = (along.shown, along.name, along.unit)
    return replace(found, shape=Shape(*given, factor, called, "1", multiplies=True))


def _elsewhere(place: ElementPlace) -> Iterator[ChannelPlace]:
    """Yield what is recorded, changes, and is not beside a resistance already.

    A flow into the store that it empties is not beside one whose law is written: its
    jet may meet the outlet. A linear one that only bends would seem to be steered by
    it. A drive beside a friction is: one that grows with the load has laws of its own.
    """
    graph = place.graph
    beside: set[str] = {place.name, *place.junctions}
    for junction in place.junctions:
        bonds = graph.bonds_at(junction)
        beside |= {bond.name for bond in bonds}
        beside |= {bond.other(junction) for bond in bonds}
        bent = place.element.law is not None
        if bent and not place.is_one_junction(junction):
            beside -= {s.name for s in graph.inputs if isinstance(s, FlowSource)}
    # What a command has become steers sooner than the command does.
    channels: list[ChannelPlace] = [
        OutputPlace(graph, m.name, place.scales) for m in graph.measurements
    ]
    channels += (
        InputPlace(graph, source.name, place.scales) for source in graph.inputs
    )
    known: set[sympy.Expr] = set()
    for channel in channels:
        signal = channel.signal
        if channel.is_constant or not isinstance(signal, Signal) or signal in known:
            continue
        known.add(signal)
        if signal.place not in beside:
            yield channel


def _as_it_is(place: ElementPlace) -> tuple[sympy.Expr, list[Coefficient]]:
    """Return the law of an element with its own numbers held where they are now."""
    graph, law = place.graph, place.usual_law
    others = [node for node in graph.nodes if node.name != place.name]
    elsewhere = used_parameters(others, graph.measurements)
    held = []
    for parameter in graph.parameters.members:
        symbol = parameter_symbol(parameter.name)
        if law.has(symbol) and parameter.name not in elsewhere:
            is_own = parameter.name == place.name
            stem = "usual" if is_own else f"usual_{parameter.name}"
            now = place.scales.fitted.get(parameter.name, parameter.value)
            # A resistance of nothing has no size; in a written law a number may be 0.
            if now is None or (is_own and now == 0.0):
                now = 1.0
            held.append(place.constant(stem, parameter.unit, now))
            law = law.subs(symbol, held[-1].symbol)
    return law, held
