"""Free curves of what is elsewhere: of another motion, or an input of another machine.

An axis that answers to what another one does, an actuator that acts on its neighbour.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from bondgraph.physics.curves import drawn, even, turning
from bondgraph.physics.hypothesis import Form, Hypothesis, Make, Shape
from bondgraph.physics.places.apart import inputs_apart_from, moving_apart_from
from bondgraph.physics.places.base import E, F
from bondgraph.physics.places.channels import InputPlace
from bondgraph.physics.places.displacements import known_displacement
from bondgraph.physics.places.junction import OneJunctionPlace
from bondgraph.physics.smooth import Smooth
from bondgraph.structure.elements import EffortSource
from bondgraph.structure.signals import Signal, displacement, flow


def forms_of_others(
    make: Make, place: OneJunctionPlace, smooth: Smooth | None
) -> Iterator[Form]:
    """Yield what makes each curve of another motion, or of an input of one."""
    others = moving_apart_from(place.graph, place.name)
    for other in others:
        signals = [flow(other)]
        if known_displacement(place.graph, other) == {other: 1}:
            signals.append(displacement(other))
        for signal in signals:
            yield partial(_of_motion, make, place, signal, smooth)
    for name in inputs_apart_from(place.graph, place.name) if others else ():
        channel = InputPlace(place.graph, name, place.scales)
        if not channel.is_constant:
            yield partial(_of_input, make, place, channel, smooth)


def _of_motion(
    make: Make, place: OneJunctionPlace, signal: Signal, smooth: Smooth | None
) -> Hypothesis:
    """Let an effort here be a curve of the flow or displacement of another motion."""
    turns = signal.quantity is F
    default = place.flow if turns else place.displacement
    size = place.scales.of(signal.name, default)
    visited = place.scales.range_of(signal.name, default)
    knots = (turning if turns else even)(visited, size)
    word, unit = place.domain.word(signal.quantity), place.unit(signal.quantity)
    called = f"the {word} of {signal.place}"
    return _curve(make, place, (signal, called, unit), size, knots, smooth)


def _of_input(
    make: Make, place: OneJunctionPlace, channel: InputPlace, smooth: Smooth | None
) -> Hypothesis:
    """Let an effort here be a curve of an input that drives another machine."""
    size = channel.peak
    knots, unit = even(channel.range, size), channel.channel_unit
    given = (channel.signal, channel.name, unit)
    return _curve(make, place, given, size, knots, smooth)


def _curve(
    make: Make,
    place: OneJunctionPlace,
    given: tuple[Signal, str, str],
    size: float,
    knots: tuple[float, ...],
    smooth: Smooth | None,
) -> Hypothesis:
    """Hang a source whose effort is a curve of a signal, with its name and unit."""
    signal, called, unit = given
    stem = f"curve_{signal.place}"
    width = place.constant(f"{stem}_width", unit, size)
    x = signal / width.symbol
    curve, heights = drawn(place, stem, place.unit(E), x, knots, smooth)
    name = place.name_of(f"unknown_{signal.quantity}_{signal.place}")
    edit = place.insert(EffortSource(name, value=-curve), *heights, width)
    words = f"{place.a(E)} that is an unnamed function of {called}"
    found = make(place, edit, curve, heights, words)
    shape = Shape(*given, curve, place.domain.word(E), place.unit(E))
    return replace(found, shape=shape)
