"""What changes in the course of a recording, whatever passes through it.

What is warm or cold from before recovers; dirt, wear or a thing that nobody records go
on. That is told from a law of what passes through only where this comes back late in a
recording as it was early: else time is as good a variable as any.
"""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Coefficient, E, F, Place
from bondgraph.physics.places.channels import ChannelPlace, InputPlace
from bondgraph.physics.places.element import ElementPlace
from bondgraph.structure.elements import Compliance, Inertance, Transformer
from bondgraph.structure.nodes import is_linear
from bondgraph.structure.signals import Signal, t

WARM_UPS = (0.03, 0.1, 0.3, 1.0)
"""Times that fits of a warm-up start from, as shares of what one recording lasts."""

SILENT = (0.0,) * len(WARM_UPS)
"""A strength where each of these is tried without effect, before one with some."""

MOST = 0.9
"""Of its value an element loses at most over the longest recording."""


class ParameterDrift(AbstractPhysics):
    """A number that changes evenly in the course of a recording.

    A hopper that empties, a reel that fills, an air spring that loses its air: x (1 + a
    t) in place of the number x of a linear I, C or TF, slowly beside its motion. Or in
    place of what an input or a sensor is told to do, x: a battery that sags, an
    amplifier that warms.
    """

    word = "parameter_drift"
    reference = "Isermann, Fault-Diagnosis Systems 2006: parameters that drift"
    passivity = Passivity.SOURCE
    signature = "early fits late badly and late early; each by itself fits well"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for channels, linear I, C and TF, where what passes comes back."""
        if isinstance(place, ChannelPlace) and channel_comes_back(place):
            yield self._of_a_channel(place)
        if not isinstance(place, ElementPlace):
            return
        element = place.element
        if not isinstance(element, Inertance | Compliance | Transformer):
            return
        if is_linear(element) and comes_back(place, place.junctions[0]):
            yield _evenly(self, place)

    def _of_a_channel(self, place: ChannelPlace) -> Hypothesis:
        a, grown = _drift(place)
        law = place.signal * grown
        words = f"{place.name} {does(place)} in proportion, evenly with time"
        return self.hypothesis(place, place.become(law, a), law, (a,), words)


def in_time(
    physics: AbstractPhysics, place: ElementPlace, junction: str, least: float
) -> Iterator[Hypothesis]:
    """Yield that an element changes evenly, or recovers from how it begins.

    Only where what passes there is known to come back.

    Parameters
    ----------
    junction
        Where what passes has to come back.
    least
        Seconds in which it recovers at least.
    """
    if place.scales.lasting is not None and comes_back(place, junction):
        yield _evenly(physics, place)
        yield _recovering(physics, place, least)


def channel_comes_back(place: ChannelPlace) -> bool:
    """Return whether what is commanded, or read, is late as it was early."""
    own = place.signal
    commanded = isinstance(place, InputPlace) and isinstance(own, Signal)
    return may_come_back(place, own.name if commanded else place.name)


def does(place: ChannelPlace) -> str:
    """Return what a channel does more or less."""
    return f"{'does' if isinstance(place, InputPlace) else 'reads'} more or less"


def comes_back(place: Place, junction: str) -> bool:
    """Return whether what a junction has in common is late as it was early.

    Also if that is not known.
    """
    common = F if place.is_one_junction(junction) else E
    return may_come_back(place, f"{common}({junction})")


def may_come_back(place: Place, signal: str) -> bool:
    """Return whether a signal comes back, or that is not known."""
    return place.scales.lasting is None or signal in place.scales.lasting


def warm_ups(place: Place) -> tuple[float, ...]:
    """Return the seconds in which something may warm, cool or clog."""
    return tuple(share * place.scales.stretch for share in WARM_UPS)


def _drift(place: Place) -> tuple[Coefficient, sympy.Expr]:
    """Return the share by which what is there grows a second, and how it has grown."""
    stretch = place.scales.stretch
    starts = (0.0, 0.2 / stretch)
    a = place.strength("drift", "1/s", starts, low=-MOST / stretch)
    return a, 1 + a.symbol * (t - place.scales.begin)


def _evenly(physics: AbstractPhysics, place: ElementPlace) -> Hypothesis:
    a, grown = _drift(place)
    stores = isinstance(place.element, Inertance | Compliance)
    law = place.usual_law / grown if stores else place.usual_law * grown
    words = f"{place.name} changes evenly with time, whatever passes through it"
    edit = place.replace(law, a)
    return physics.hypothesis(place, edit, law, (a,), words, also=place.junctions)


def _recovering(
    physics: AbstractPhysics, place: ElementPlace, least: float
) -> Hypothesis:
    x = place.strength("beginning", "1", (*SILENT, 0.1), low=-MOST)
    tau = place.shape("recovery_time", "s", warm_ups(place) * 2, low=least)
    passed = t - place.scales.begin
    law = place.usual_law * (1 + x.symbol * sympy.exp(-passed / tau.symbol))
    words = f"{place.name} is another one as a recording begins, and recovers"
    edit = place.replace(law, x, tau)
    return physics.hypothesis(place, edit, law, (x, tau), words, also=place.junctions)
