"""Signals that come late: lags and delays of inputs and of sensors.

A lag is a state z' = (x - z) / tau, made of graph elements, or two of them in a row:
heat on its way to a thermometer comes through more than one body. A delay T is the
Padé form of orders 2 over 3, which is strictly proper, so that a jump does not come
through at once: up to w T = 2 its phase is right within 0.003 rad and its gain within
0.7 %, up to w T = 3 within 0.035 rad and 5.4 %.
"""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Place
from bondgraph.physics.places.channels import ChannelPlace, InputPlace
from bondgraph.structure.edits import SignalState
from bondgraph.structure.signals import displacement

STAGES = " of two equal stages"

MOST = 0.5
"""Of the longest recording: what comes later than that is in none of them."""


class Lag(AbstractPhysics):
    """A signal that follows with a time constant, once or in two equal stages."""

    word = "lag"
    reference = "low-pass of first order, or of second with two equal time constants"
    passivity = Passivity.SIGNAL
    signature = "a corner rounded off, phase without resonance; taken for a delay"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every input that changes, and every output."""
        if not isinstance(place, ChannelPlace) or place.is_constant:
            return
        for stages, stem, how in ((1, "lag", ""), (2, "lag_each", STAGES)):
            low, high = 0.02 * place.scales.step, place.scales.slowest
            tau = place.shape(stem, "s", _times(place), low=low, high=high)
            names = (place.name_of(f"lagged{'_twice' * k}") for k in range(stages))
            law, states = place.signal, []
            for name in names:
                states.append(lagging(name, law, tau.symbol))
                law = states[-1].value
            words = f"{place.name} {_verb(place)} with a lag{how}"
            edit = place.become(law, tau, states=tuple(states))
            yield self.hypothesis(place, edit, law, (tau,), words)


class Delay(AbstractPhysics):
    """A signal that comes a fixed time later: buses, buffers, computation, pipes."""

    word = "delay"
    reference = "Padé 1892; strictly proper form: Vajta 2000"
    passivity = Passivity.SIGNAL
    signature = "the same shape later, phase that falls with frequency; taken for a lag"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every input that changes, and every output of what is driven.

        What moves by itself shows no delay: any motion is as good an early one.
        """
        if not isinstance(place, ChannelPlace) or place.is_constant:
            return
        if not place.is_driven:
            return
        low, high = 0.05 * place.scales.step, MOST * place.scales.stretch
        time = place.shape("delay", "s", _times(place), low=low, high=high)
        name = place.name_of("delayed")
        states, law = delaying(name, place.signal, time.symbol)
        words = f"{place.name} {_verb(place)} late by a fixed time"
        edit = place.become(law, time, states=states)
        yield self.hypothesis(place, edit, law, (time,), words)


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


def _times(place: ChannelPlace) -> tuple[float, ...]:
    """Return times from a fraction of a sample to a fraction of the recording."""
    step, stretch = place.scales.step, place.scales.stretch
    longer = (1.5, 5.0, 20.0, 80.0)
    return (0.1 * step, *(n * step for n in longer if n * step < 0.1 * stretch))


def _verb(place: ChannelPlace) -> str:
    return "acts" if isinstance(place, InputPlace) else "reads"
