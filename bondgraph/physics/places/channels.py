"""Inputs and outputs as places: what drives and what reads may not be ideal."""

from dataclasses import dataclass

from bondgraph.physics.places.base import E, F, Place
from bondgraph.structure.domains import ANALOGUE, EnergyDomain, Quantity
from bondgraph.structure.elements import EffortSource
from bondgraph.structure.graph import Measurement
from bondgraph.structure.signals import Signal, signals_in


@dataclass(frozen=True, slots=True)
class InputPlace(Place):
    """A source that a recording drives: what arrives may not be what was asked for."""

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain of its bond."""
        return self.graph.domain_at(self.name)

    @property
    def quantity(self) -> Quantity:
        """What it imposes: effort or flow."""
        return E if isinstance(self.graph.node(self.name), EffortSource) else F

    @property
    def commanded(self) -> Signal:
        """The recorded signal."""
        return Signal(self.quantity, self.name)


@dataclass(frozen=True, slots=True)
class OutputPlace(Place):
    """A measurement: what the sensor says may not be what is there."""

    @property
    def measurement(self) -> Measurement:
        """The measurement as the model has it."""
        return next(m for m in self.graph.measurements if m.name == self.name)

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain it reads; analogue where it reads several."""
        read = signals_in(self.measurement.expression)
        domains = [self.graph.domain_at(signal.place) for signal in read]
        one = domains and all(domain is domains[0] for domain in domains)
        return domains[0] if one else ANALOGUE
