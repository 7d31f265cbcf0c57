"""What happens at one moment: a number that steps, an effort or a flow that sets in.

A belt tears, a valve sticks, a window is opened, a load is put down. The moment is
found along with the size: a step is smoothed over a share of a recording at first, so
that a fit feels where it is, and is made sharp where that tells
(`diagnosis.search.laws.sharper`).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.in_time import (
    MOST,
    channel_comes_back,
    comes_back,
    does,
)
from bondgraph.physics.places.base import Coefficient, E, F, Place
from bondgraph.physics.places.channels import ChannelPlace
from bondgraph.physics.places.element import ElementPlace
from bondgraph.physics.places.junction import JunctionPlace, OneJunctionPlace
from bondgraph.structure.elements import EffortSource, FlowSource
from bondgraph.structure.nodes import is_linear
from bondgraph.structure.signals import parameter_symbol, t

MOMENTS = 12
"""Evenly over the longest recording, where fits of a moment start from."""

SMOOTHED = 2 * MOMENTS
"""Of a recording one part in so many is the width of a step at first."""


@dataclass(frozen=True, slots=True)
class Step:
    """From 0 to 1 at a moment.

    Parameters
    ----------
    height
        An expression of time.
    own
        The moment, and the width over which it is smoothed.
    """

    height: sympy.Expr
    own: tuple[Coefficient, ...]


def begun_at(place: Place) -> Step:
    """Return what is 0 before a moment, which is fitted, and 1 after it."""
    begin, stretch = place.scales.begin, place.scales.stretch
    middles = ((k + 0.5) / MOMENTS for k in range(MOMENTS))
    starts = tuple(begin + share * stretch for share in middles)
    at = place.shape("moment", "s", starts, low=begin, high=begin + stretch)
    width = place.edge("moment_width", "s", stretch / SMOOTHED)
    passed = (t - at.symbol) / width.symbol
    return Step((1 + sympy.tanh(passed)) / 2, (at, width))


@dataclass(frozen=True)
class AtOneMoment(AbstractPhysics):
    """Something that happens once.

    Parameters
    ----------
    anywhere
        Also where what passes does not come back, and anything may be a law of time.
    """

    anywhere: bool = False

    reference = "Basseville and Nikiforov, Detection of Abrupt Changes 1993"
    passivity = Passivity.SOURCE


class ParameterStep(AtOneMoment):
    """A number that is another one from one moment on.

    x (1 + a) from then on in place of the number x of a linear R, I, C, of a TF or GY,
    or of what an input or a sensor does.
    """

    word = "parameter_step"
    signature = "before a moment all fits, and after it all fits with another number"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for channels and linear elements, where what passes comes back."""
        if isinstance(place, ChannelPlace):
            if self.anywhere or channel_comes_back(place):
                yield self._of_a_channel(place)
            return
        if not isinstance(place, ElementPlace) or not is_linear(place.element):
            return
        if self.anywhere or comes_back(place, place.junctions[0]):
            yield self._of_an_element(place)

    def _of_a_channel(self, place: ChannelPlace) -> Hypothesis:
        times, own = _stepped(place)
        law = place.signal * times
        words = f"{place.name} {does(place)} in proportion from one moment on"
        return self.hypothesis(place, place.become(law, *own), law, own, words)

    def _of_an_element(self, place: ElementPlace) -> Hypothesis:
        times, own = _stepped(place)
        number = parameter_symbol(place.name)
        law = place.usual_law.xreplace({number: number * times})
        words = f"{place.name} is another one from one moment on"
        edit = place.replace(law, *own)
        return self.hypothesis(place, edit, law, own, words, also=place.junctions)


class DisturbanceStep(AtOneMoment):
    """A constant effort at a 1-junction, or flow at a 0-junction, that sets in."""

    word = "disturbance_step"
    signature = "an error that is there from one moment on, whatever is done"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at junctions where what they have in common comes back."""
        if not isinstance(place, JunctionPlace):
            return
        if not self.anywhere and not comes_back(place, place.name):
            return
        step = begun_at(place)
        one = isinstance(place, OneJunctionPlace)
        size = place.strength("step", place.unit(E if one else F))
        law = size.symbol * step.height
        source = (EffortSource if one else FlowSource)(
            place.name_of(self.word), value=law
        )
        own = (size, *step.own)
        words = f"{place.a(E if one else F)} that sets in at one moment"
        yield self.hypothesis(place, place.insert(source, *own), law, own, words)


def _stepped(place: Place) -> tuple[sympy.Expr, tuple[Coefficient, ...]]:
    """Return how many times what it was a number is: once, and then by a share more.

    A share, for no more than most of it is lost: a number that may have any size then
    may have the wrong sign.
    """
    step = begun_at(place)
    share = place.strength("step", "1", low=-MOST)
    return 1 + share.symbol * step.height, (share, *step.own)
