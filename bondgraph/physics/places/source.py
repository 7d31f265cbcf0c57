"""Sources as places, and those inside of a loop: they need not give what is asked."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import sympy

from bondgraph.physics.places.base import PROPOSED, Coefficient, E, F, Place
from bondgraph.structure.domains import ANALOGUE, EnergyDomain, Quantity
from bondgraph.structure.edits import (
    GraphEdit,
    ReplaceRelation,
    SeveralEdits,
    SignalState,
)
from bondgraph.structure.elements import EffortSource, Node, Source
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.signals import Signal, parameters_in, signals_in


@dataclass(frozen=True, slots=True)
class SourcePlace(Place):
    """A source of effort or of flow."""

    @property
    def domain(self) -> EnergyDomain:
        """The energy domain of its bond."""
        return self.graph.domain_at(self.name)

    @property
    def quantity(self) -> Quantity:
        """What it imposes: effort or flow."""
        return _imposed(self.graph.node(self.name))

    @property
    def junction(self) -> str:
        """The junction it drives."""
        return self._bond.other(self.name)

    @property
    def usual(self) -> float:
        """The typical size of what it imposes, at the junction it drives."""
        return self.scales.at(self.quantity, self.junction)

    @property
    def _bond(self) -> Bond:
        (bond,) = self.graph.bonds_at(self.name)
        return bond


@dataclass(frozen=True, slots=True)
class ActuatorPlace(SourcePlace):
    """A source steered by a command and by what the machine does: a loop's actuator."""

    is_constant = False

    @property
    def signal(self) -> sympy.Expr:
        """What the model asks of it."""
        node = self.graph.node(self.name)
        assert isinstance(node, Source)
        assert node.value is not None
        return node.value

    @property
    def readings(self) -> tuple[Signal, ...]:
        """What it reads of the machine, first of its loop, beside an input's command.

        Beside a set point there is nothing to tell it from all that it is asked.
        """
        commands = _commands(self.graph)
        signals = signals_in(self.signal)
        if commands.isdisjoint(signals):
            return ()
        machine = (s for s in signals if self.graph.domain_at(s.place) != ANALOGUE)
        return tuple(
            signal
            for signal in machine
            if signal not in commands and self._readers(signal)[0] == self.name
        )

    def _readers(self, signal: Signal) -> list[str]:
        """Return the sources steered in loops that read a signal, the machine's first.

        That of a sum of errors reads what the source that acts on the machine reads.
        """
        graph = self.graph
        readers = [
            name
            for name in actuators(graph)
            if signal in signals_in(replace(self, name=name).signal)
        ]
        return sorted(readers, key=lambda name: graph.domain_at(name) == ANALOGUE)

    @property
    def channel_unit(self) -> str:
        """The unit of what it imposes."""
        return self.unit(self.quantity)

    @property
    def range(self) -> tuple[float, float]:
        """The least and the largest value that it was asked for."""
        return self.scales.range_of(f"{self.quantity}({self._bond.name})", self.usual)

    @property
    def peak(self) -> float:
        """The largest size of what it was asked for."""
        return max(map(abs, self.range))

    def become(
        self,
        value: sympy.Expr,
        *coefficients: Coefficient,
        states: tuple[SignalState, ...] = (),
        nested: bool = True,
    ) -> ReplaceRelation:
        """Return the edit that lets it give another expression of what is asked."""
        parameters = tuple(c.parameter for c in coefficients)
        return ReplaceRelation(self.name, value, parameters, states, nested)

    def read_as(
        self,
        signal: Signal,
        value: sympy.Expr,
        *coefficients: Coefficient,
        states: tuple[SignalState, ...],
    ) -> GraphEdit:
        """Return the edit by which all of its loop takes a reading for another."""
        others = (replace(self, name=name) for name in self._readers(signal)[1:])
        edits = tuple(o.become(o.signal.xreplace({signal: value})) for o in others)
        law = self.signal.xreplace({signal: value})
        own = self.become(law, *coefficients, states=states)
        return SeveralEdits((own, *edits)) if edits else own


def actuators(graph: FinishedGraph) -> Iterator[str]:
    """Yield the sources that a command and the machine steer together.

    The command is an input, or a constant set point that what the machine does counts
    against in proportion. What an input alone steers has the limits of that input, and
    what a finding has put there is no source of the author's.
    """
    commands = _commands(graph)
    for node in graph.elements:
        if not isinstance(node, Source) or node.value is None:
            continue
        numbers = (graph.parameters[name] for name in parameters_in(node.value))
        authored = all(number.source != PROPOSED for number in numbers)
        commanded = [signal in commands for signal in signals_in(node.value)]
        steered = any(commanded) or _has_set_point(node.value)
        if authored and steered and not all(commanded):
            yield node.name


def _commands(graph: FinishedGraph) -> frozenset[Signal]:
    """Return the signals that inputs are, and where they arrive."""
    return frozenset(
        Signal(_imposed(source), near)
        for source in graph.inputs
        for near in (
            source.name,
            *(bond.other(source.name) for bond in graph.bonds_at(source.name)),
        )
    )


def _has_set_point(value: sympy.Expr) -> bool:
    """Return whether signals count in proportion, and something is there without."""
    signals = signals_in(value)
    if not signals or value.xreplace(dict.fromkeys(signals, sympy.S.Zero)).is_zero:
        return False
    return bool(value.is_polynomial(*signals) and sympy.Poly(value, *signals).is_linear)


def _imposed(source: Node) -> Quantity:
    """Return what a source imposes: effort or flow."""
    return E if isinstance(source, EffortSource) else F
