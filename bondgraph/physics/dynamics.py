"""Signals that come late: lags and delays of inputs, sensors and loops.

A lag is a state z' = (x - z) / tau, made of graph elements, or two of them in a row:
heat on its way to a thermometer comes through more than one body. A delay T is the
Padé form of orders 2 over 3, which is strictly proper, so that a jump does not come
through at once: up to w T = 2 its phase is right within 0.003 rad and its gain within
0.7 %, up to w T = 3 within 0.035 rad and 5.4 %.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Coefficient, Place
from bondgraph.physics.places.channels import ChannelPlace, OutputPlace
from bondgraph.physics.places.source import ActuatorPlace
from bondgraph.structure.edits import GraphEdit, SignalState
from bondgraph.structure.signals import Signal, displacement

Following = ChannelPlace | ActuatorPlace

STAGES = " of two equal stages"

MOST = 0.5
"""Of the longest recording: what comes later than that is in none of them."""


@dataclass(frozen=True, slots=True)
class Late:
    """What may come late: all of a place's signal, or what a loop reads there.

    Parameters
    ----------
    reading
        Of the machine; None for the whole signal.
    """

    place: Following
    reading: Signal | None = None

    @property
    def signal(self) -> sympy.Expr:
        """What follows late."""
        return self.place.signal if self.reading is None else self.reading

    @property
    def suffix(self) -> str:
        """Of the names of what is added."""
        return "" if self.reading is None else f"_of_{self.reading.place}"

    @property
    def words(self) -> str:
        """What is late, without how."""
        name = self.place.name
        if self.reading is not None:
            return f"what {name} reads of {self.reading.place} comes"
        return f"{name} {'reads' if isinstance(self.place, OutputPlace) else 'acts'}"

    def hypothesis(
        self,
        physics: AbstractPhysics,
        later: sympy.Expr,
        time: Coefficient,
        states: tuple[SignalState, ...],
        how: str,
    ) -> Hypothesis:
        """Return the hypothesis that `later` takes the signal's place."""
        place, reading = self.place, self.reading
        words = f"{self.words} {how}"
        edit: GraphEdit
        if reading is None:
            law, edit = later, place.become(later, time, states=states)
        else:
            assert isinstance(place, ActuatorPlace)
            law = place.signal.xreplace({reading: later})
            edit = place.read_as(reading, later, time, states=states)
        return physics.hypothesis(place, edit, law, (time,), words)


def _what_may_be_late(place: Place) -> Iterator[Late]:
    """Yield the whole signal, and each reading of the machine that a loop acts on."""
    if isinstance(place, Following) and not place.is_constant:
        yield Late(place)
    if isinstance(place, ActuatorPlace):
        yield from (Late(place, reading) for reading in place.readings)


class Lag(AbstractPhysics):
    """A signal that follows with a time constant, once or in two equal stages."""

    word = "lag"
    reference = "low-pass of first order, or of second with two equal time constants"
    passivity = Passivity.SIGNAL
    signature = "a corner rounded off, phase without resonance; taken for a delay"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for what changes: an input, an output, what a loop asks."""
        for stages, stem, how in ((1, "lag", ""), (2, "lag_each", STAGES)):
            for late in _what_may_be_late(place):
                yield self._of(late, stages, stem, how)

    def _of(self, late: Late, stages: int, stem: str, how: str) -> Hypothesis:
        place, suffix = late.place, late.suffix
        low, high = 0.02 * place.scales.step, place.scales.slowest
        tau = place.shape(f"{stem}{suffix}", "s", _times(place), low=low, high=high)
        names = (place.name_of(f"lagged{suffix}{'_twice' * k}") for k in range(stages))
        law, states = late.signal, []
        for name in names:
            states.append(lagging(name, law, tau.symbol))
            law = states[-1].value
        return late.hypothesis(self, law, tau, tuple(states), f"with a lag{how}")


class Delay(AbstractPhysics):
    """A signal that comes a fixed time later: buses, buffers, computation, pipes."""

    word = "delay"
    reference = "Padé 1892; strictly proper form: Vajta 2000"
    passivity = Passivity.SIGNAL
    signature = "the same shape later, phase that falls with frequency; taken for a lag"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every input that changes, and every output of what is driven.

        What moves by itself shows no delay: any motion is as good an early one. Within
        a loop it shows in how that moves.
        """
        if isinstance(place, ChannelPlace) and not place.is_driven:
            return
        for late in _what_may_be_late(place):
            place, suffix = late.place, late.suffix
            low, high = 0.05 * place.scales.step, MOST * place.scales.stretch
            times = _times(place)
            time = place.shape(f"delay{suffix}", "s", times, low=low, high=high)
            name = place.name_of(f"delayed{suffix}")
            states, law = delaying(name, late.signal, time.symbol)
            yield late.hypothesis(self, law, time, states, "late by a fixed time")


LATE = (Lag.word, Delay.word)
"""A lag in one stage or two, and a delay."""


def lagging(name: str, signal: sympy.Expr, time: sympy.Expr) -> SignalState:
    """Return the state that follows `signal` with the time constant `time`."""
    return SignalState(name, (signal - displacement(name)) / time)


def delaying(
    name: str, signal: sympy.Expr, time: sympy.Expr
) -> tuple[tuple[SignalState, ...], sympy.Expr]:
    """Return the states of a delay, and the delayed signal.

    (60 - 24 s + 3 s²) / (60 + 36 s + 9 s² + s³) in s T, as a chain of three states.
    """
    names = [f"{name}_{i}" for i in (1, 2, 3)]
    one, two, three = map(displacement, names)
    rates = (two, three, signal - 60 * one - 36 * two - 9 * three)
    states = tuple(
        SignalState(own, rate / time) for own, rate in zip(names, rates, strict=True)
    )
    return states, 60 * one - 24 * two + 3 * three


def _times(place: Following) -> tuple[float, ...]:
    """Return times from a fraction of a sample to a fraction of the recording."""
    step, stretch = place.scales.step, place.scales.stretch
    longer = (1.5, 5.0, 20.0, 80.0)
    return (0.1 * step, *(n * step for n in longer if n * step < 0.1 * stretch))
