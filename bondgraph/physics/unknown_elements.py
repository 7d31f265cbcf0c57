"""Free curves in the own law of an element.

A ratio on the way, what a store holds, what a resistance between two stores lets pass,
and one that something elsewhere steers: a film that a fan cools, a damper with a coil.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import sympy

from bondgraph.physics.curves import BOTH_WAYS, drawn, even, turning
from bondgraph.physics.hypothesis import Hypothesis, Shape
from bondgraph.physics.places.base import (
    ELECTRIC,
    MECHANICAL,
    Coefficient,
    E,
    F,
    P,
    Q,
)
from bondgraph.physics.places.channels import ChannelPlace, InputPlace, OutputPlace
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import (
    JunctionPlace,
    OneJunctionPlace,
    junction_place,
)
from bondgraph.physics.smooth import Smooth
from bondgraph.structure.elements import (
    Compliance,
    FlowSource,
    Gyrator,
    Inertance,
    Resistance,
    Transformer,
)
from bondgraph.structure.graph import used_parameters
from bondgraph.structure.signals import (
    Signal,
    displacement,
    e,
    effort,
    momentum,
    p,
    parameter_symbol,
    q,
)

Make = Callable[..., Hypothesis]
"""What makes a hypothesis of that physics: `AbstractPhysics.hypothesis`."""

Form = Callable[[], Hypothesis]
"""What makes one curve; a finely drawn one is long to write."""

STORE = 8
"""Knots of what a store answers with."""

STEERED = 4
"""Knots of what steers a resistance: of two variables a law is told by few."""


def forms_of_element(
    make: Make, place: ElementPlace, smooth: Smooth | None
) -> Iterator[Form]:
    """Yield what makes each curve that the law of an element may be."""
    match place.element:
        case Transformer() | Gyrator():
            for name in filter(place.is_one_junction, place.junctions):
                beside = junction_place(place.graph, name, place.scales)
                if beside.domain in MECHANICAL and beside.displacement_known:
                    yield partial(_ratio, make, place, beside, smooth)
        case Inertance() if place.domain in ELECTRIC:
            yield partial(_store, make, place, smooth)
        case Compliance() if not any(
            map(place.is_one_junction, place.junctions)
        ):  # At a 1-junction it is the curve of the displacement there.
            yield partial(_store, make, place, smooth)
        case Resistance():
            if place.flow_law is not None:
                yield partial(_passed, make, place, place.flow_law, smooth)
            for channel in _elsewhere(place):
                yield partial(_steered, make, place, channel, smooth)


def passes(place: OneJunctionPlace) -> bool:
    """Return whether an R there lets a flow pass that the efforts at its ends set.

    Its curve is one of the effort then: of what is added to its effort as a curve of
    the flow, a part may fall, and the flow be any of several.
    """
    parts = (
        ElementPlace(place.graph, node.name, place.scales)
        for node in place.neighbours
        if isinstance(node, Resistance)
    )
    return any(part.flow_law is not None for part in parts)


def _passed(
    make: Make, place: ElementPlace, usual: sympy.Expr, smooth: Smooth | None
) -> Hypothesis:
    """Let a resistance pass a flow that is a free curve of the effort, beside its own.

    Parameters
    ----------
    usual
        The flow that it passes by its own law, of e.
    """
    size, (bond,) = place.effort, place.graph.bonds_at(place.name)
    knots = turning(place.scales.range_of(f"{E}({bond.name})", size), size)
    odd = smooth is not None and smooth.is_odd_over(knots)
    width = place.constant("curve_effort", place.unit(E), size)
    x = e / width.symbol
    curve, heights = drawn(place, "curve", place.unit(F), x, knots, smooth, odd=odd)
    law = usual + curve
    words = (
        f"{place.name} lets {place.a(F)} pass that is an unnamed function of "
        f"{place.domain.word(E)}{BOTH_WAYS if odd else ''}"
    )
    edit = place.replace(law, *heights, width)
    found = make(place, edit, law, heights, words, also=place.junctions)
    own = effort(place.name)
    given = (own, place.domain.word(E), place.unit(E))
    called = place.domain.word(F)
    shape = Shape(*given, law.subs(e, own), called, place.unit(F))
    return replace(found, shape=shape)


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


def _steered(
    make: Make, place: ElementPlace, channel: ChannelPlace, smooth: Smooth | None
) -> Hypothesis:
    """Make a resistance a curve of something that is recorded elsewhere.

    Its own numbers are in the curve: beside one, only their product shows.
    """
    size = channel.peak
    usual, own = _as_it_is(place)
    stem = f"curve_{channel.name}"
    knots = even(channel.range, size, STEERED)
    width = place.constant(f"{stem}_width", channel.channel_unit, size)
    x = channel.signal / width.symbol
    curve, heights = drawn(place, stem, "1", x, knots, smooth)
    law = usual * (1 + curve)
    words = f"{place.name} changes with {channel.name}"
    edit = place.replace(law, *heights, width, *own)
    found = make(place, edit, law, heights, words, also=place.junctions)
    steering = (channel.signal, channel.name, channel.channel_unit)
    shape = Shape(*steering, 1 + curve, "resistance to its usual", "1")
    return replace(found, shape=shape)


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


def _ratio(
    make: Make, place: ElementPlace, beside: JunctionPlace, smooth: Smooth | None
) -> Hypothesis:
    """Make a ratio a curve of a displacement beside it."""
    size = beside.displacement
    knots = even(beside.scales.range_of(f"{Q}({beside.name})", size), size)
    stem = f"curve_{beside.name}"
    width = place.constant(f"{stem}_width", beside.unit(Q), size)
    x = beside.displacement_signal / width.symbol
    curve, heights = drawn(place, stem, "1", x, knots, smooth)
    law = place.usual_law * (1 + curve)
    words = f"{place.name} changes along the way of {beside.name}"
    edit = place.replace(law, *heights, width)
    found = make(place, edit, law, heights, words, also=place.junctions)
    way = (beside.displacement_signal, beside.domain.displacement, beside.unit(Q))
    return replace(found, shape=Shape(*way, 1 + curve, "ratio to its usual", "1"))


def _store(make: Make, place: ElementPlace, smooth: Smooth | None) -> Hypothesis:
    """Make what a store answers with a curve of what it holds, beside its law."""
    if isinstance(place.element, Inertance):
        held, answer, own, signal = P, F, p, momentum(place.name)
        name, typical = place.domain.momentum, place.flow
    else:
        held, answer, own, signal = Q, E, q, displacement(place.name)
        name, typical = place.domain.displacement, place.effort
    value = place.scales.fitted.get(place.name) or place.linear_value or 1.0
    size = place.scales.at(held, place.name, value * typical)
    knots = even(place.scales.range_of(f"{held}({place.name})", size), size, STORE)
    width = place.constant("curve_held", place.unit(held), size)
    unit = place.unit(answer)
    x = own / width.symbol
    curve, heights = drawn(place, "curve", unit, x, knots, smooth, bent=True)
    law = place.usual_law + curve
    words = f"{place.name} holds along an unnamed curve"
    edit = place.replace(law, *heights, width)
    found = make(place, edit, law, heights, words, also=place.junctions)
    shown = place.usual_law.subs(own, signal) + curve.subs(own, signal)
    given = (signal, name, place.unit(held))
    called = place.domain.word(answer)
    return replace(found, shape=Shape(*given, shown, called, unit))
