"""Inputs and outputs as places: what drives and what reads may not be ideal."""

from abc import abstractmethod
from dataclasses import dataclass

import sympy

from bondgraph.physics.places.base import Coefficient, E, F, Place
from bondgraph.physics.places.source import SourcePlace
from bondgraph.structure.domains import ANALOGUE, EnergyDomain
from bondgraph.structure.edits import ReplaceMeasurement, SignalState, WrapInput
from bondgraph.structure.graph import Measurement
from bondgraph.structure.signals import Signal, signals_in


@dataclass(frozen=True, slots=True)
class ChannelPlace(Place):
    """An input or output: a signal that a recording holds."""

    @property
    @abstractmethod
    def signal(self) -> sympy.Expr:
        """What the model takes it for."""

    @property
    @abstractmethod
    def channel_unit(self) -> str:
        """Its unit."""

    @property
    @abstractmethod
    def range(self) -> tuple[float, float]:
        """Its least and largest value."""

    @property
    def is_constant(self) -> bool:
        """Whether it is known to hold one value: then nothing shows how it changes."""
        return False

    @property
    def is_driven(self) -> bool:
        """Whether some recorded input changes."""
        places = (
            InputPlace(self.graph, s.name, self.scales) for s in self.graph.inputs
        )
        return any(not place.is_constant for place in places)

    @property
    def peak(self) -> float:
        """The largest size."""
        return max(map(abs, self.range))

    @abstractmethod
    def become(
        self,
        value: sympy.Expr,
        *coefficients: Coefficient,
        states: tuple[SignalState, ...] = (),
        nested: bool = True,
    ) -> ReplaceMeasurement | WrapInput:
        """Return the edit that makes it another expression of the signal."""


@dataclass(frozen=True, slots=True)
class InputPlace(ChannelPlace, SourcePlace):
    """A source that a recording drives: what arrives may not be what was asked for."""

    @property
    def of_its_kind(self) -> tuple["InputPlace", ...]:
        """The other inputs that impose the same quantity of the same domain."""
        others = (
            InputPlace(self.graph, source.name, self.scales)
            for source in self.graph.inputs
            if source.name != self.name
        )
        alike = (self.quantity, self.domain)
        return tuple(o for o in others if (o.quantity, o.domain) == alike)

    @property
    def signal(self) -> Signal:
        """The recorded signal."""
        return Signal(self.quantity, self.name)

    @property
    def meets_itself(self) -> bool:
        """Whether what is common at its junction is what it imposes."""
        common = F if self.is_one_junction(self.junction) else E
        return self.quantity is common

    @property
    def channel_unit(self) -> str:
        """The unit of what it imposes."""
        return self.unit(self.quantity)

    @property
    def range(self) -> tuple[float, float]:
        """Its least and largest value."""
        return self.scales.range_of(self.signal.name, self.usual)

    @property
    def is_constant(self) -> bool:
        """Whether the recordings hold it at one value."""
        return self.scales.is_constant(self.signal.name)

    @property
    def tenths(self) -> int:
        """In how many tenths of its largest size it has been."""
        return self.scales.tenths.get(self.name, 10)

    def become(
        self,
        value: sympy.Expr,
        *coefficients: Coefficient,
        states: tuple[SignalState, ...] = (),
        nested: bool = True,
    ) -> WrapInput:
        """Return the edit that applies another expression of the signal."""
        parameters = tuple(c.parameter for c in coefficients)
        applied = self.name_of("applied")
        return WrapInput(self.name, value, applied, parameters, states, nested)


@dataclass(frozen=True, slots=True)
class OutputPlace(ChannelPlace):
    """A measurement: what the sensor says may not be what is there."""

    @property
    def measurement(self) -> Measurement:
        """The measurement as the model has it."""
        return next(m for m in self.graph.measurements if m.name == self.name)

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain it reads; analogue where it reads several."""
        read = signals_in(self.signal)
        domains = [self.graph.domain_at(signal.place) for signal in read]
        one = domains and all(domain is domains[0] for domain in domains)
        return domains[0] if one else ANALOGUE

    @property
    def signal(self) -> sympy.Expr:
        """What the model says the sensor reads."""
        return self.measurement.expression

    @property
    def channel_unit(self) -> str:
        """The unit of the measurement."""
        return self.measurement.unit

    @property
    def range(self) -> tuple[float, float]:
        """Its least and largest value."""
        read = self.signal
        default = self.scales.of(read.name) if isinstance(read, Signal) else 1.0
        return self.scales.range_of(self.name, default)

    def become(
        self,
        value: sympy.Expr,
        *coefficients: Coefficient,
        states: tuple[SignalState, ...] = (),
        nested: bool = True,
    ) -> ReplaceMeasurement:
        """Return the edit that lets the sensor read another expression."""
        parameters = tuple(c.parameter for c in coefficients)
        return ReplaceMeasurement(
            self.name, value, parameters, states, nested, self.signal
        )
