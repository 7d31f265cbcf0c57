"""Channels that were taken for one another: a wrong socket, a wrong column."""

from collections.abc import Iterator
from dataclasses import replace

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Place
from bondgraph.physics.places.channels import InputPlace, OutputPlace
from bondgraph.physics.slips import own_values
from bondgraph.structure.edits import SwapInputs, SwapMeasurements
from bondgraph.structure.graph import Measurement
from bondgraph.structure.signals import Signal
from bondgraph.structure.units import compatible, conversion


class InputSwap(AbstractPhysics):
    """Two inputs of one kind that were taken for each other."""

    word = "input_swap"
    reference = "wiring and labelling of channels"
    passivity = Passivity.SIGNAL
    signature = "each input seems to act where the other one sits"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for an input and every later one of its kind, once per pair."""
        if not isinstance(place, InputPlace):
            return
        names = [source.name for source in place.graph.inputs]
        for other in place.of_its_kind:
            if names.index(other.name) > names.index(place.name):
                yield self._swapped(place, other.name)

    def _swapped(self, place: InputPlace, other: str) -> Hypothesis:
        words = (
            f"{place.name} and {other} are swapped, each drives what the other should"
        )
        law = Signal(place.quantity, other)
        edit = SwapInputs(place.name, other)
        swapped = self.hypothesis(place, edit, law, (), words)
        return replace(swapped, starts=(own_values(place),))


class SensorSwap(AbstractPhysics):
    """Two readings of one unit that were taken for each other."""

    word = "sensor_swap"
    reference = "wiring and labelling of channels"
    passivity = Passivity.SIGNAL
    signature = "both readings are right, each under the other's name"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for an output and every later one of its unit, once per pair."""
        if not isinstance(place, OutputPlace):
            return
        own = place.measurement
        outputs = place.graph.measurements
        for other in outputs[outputs.index(own) + 1 :]:
            if _may_be_taken_for(own, other):
                yield self._swapped(place, own, other)

    def _swapped(
        self, place: OutputPlace, own: Measurement, other: Measurement
    ) -> Hypothesis:
        edit = SwapMeasurements(own.name, other.name)
        words = (
            f"{own.name} and {other.name} are swapped, each reads what the other should"
        )
        swapped = self.hypothesis(place, edit, other.expression, (), words)
        # What was fitted to swapped readings is no place to begin from.
        return replace(swapped, starts=(own_values(place),))


def _may_be_taken_for(own: Measurement, other: Measurement) -> bool:
    """Return whether two outputs have one unit and do not read the same."""
    if own.expression == other.expression or not compatible(own.unit, other.unit):
        return False
    return conversion(own.unit, other.unit) == (1.0, 0.0)
