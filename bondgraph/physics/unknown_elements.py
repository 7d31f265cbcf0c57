"""Free curves in the own law of an element.

A ratio on the way, what a store holds, what a resistance between two stores lets pass.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import sympy

from bondgraph.physics.curves import BOTH_WAYS, drawn, even, turning
from bondgraph.physics.hypothesis import Form, Hypothesis, Make, Shape
from bondgraph.physics.places.base import (
    ELECTRIC,
    MECHANICAL,
    E,
    F,
    P,
    Q,
)
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import (
    JunctionPlace,
    OneJunctionPlace,
    junction_place,
)
from bondgraph.physics.smooth import Smooth
from bondgraph.physics.unknown_led import forms_of_led
from bondgraph.structure.elements import (
    Compliance,
    Gyrator,
    Inertance,
    Resistance,
    Transformer,
)
from bondgraph.structure.signals import (
    displacement,
    e,
    effort,
    momentum,
    p,
    q,
)

STORE = 8
"""Knots of what a store answers with."""


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
            yield from forms_of_led(make, place, smooth)


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
