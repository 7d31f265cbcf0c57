"""States of signals, made of graph elements: lags, delays, memory, hidden heat.

In the analogue domain a flow source into a 0-junction with a unit C is an integrator:
its displacement grows with the rate that the source reads anywhere in the graph. No
power passes between such a piece and the machine.
"""

from dataclasses import dataclass

import sympy

from bondgraph.structure.domains import ANALOGUE, EnergyDomain
from bondgraph.structure.elements import (
    Compliance,
    FlowSource,
    OnePort,
    Source,
    ZeroJunction,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import Signal, displacement, q


@dataclass(frozen=True, slots=True)
class SignalState:
    """A state with a rate; read it as ``displacement(name)``.

    Parameters
    ----------
    name
        Of the integrator, a C.
    rate
        An expression of signals, parameters and time.
    """

    name: str
    rate: sympy.Expr

    @property
    def domain(self) -> EnergyDomain:
        """The domain of its bonds; their units are whatever the rate says."""
        return ANALOGUE

    @property
    def nodes(self) -> tuple[ZeroJunction, OnePort, OnePort]:
        """The junction, the source of the rate, and the integrator on it."""
        return (
            ZeroJunction(f"{self.name}_node"),
            FlowSource(f"{self.name}_rate", value=self.rate),
            Compliance(self.name, law=q),
        )

    @property
    def value(self) -> Signal:
        """The signal to read."""
        return displacement(self.name)


def carries_signals_only(graph: FinishedGraph, junction: str) -> bool:
    """Return whether a junction is no part of the machine but of a signal.

    Either an integrator of a `SignalState`, or a source from which nothing is drawn:
    where a command stands, as it is recorded or wrapped.
    """
    bonds = graph.bonds_at(junction)
    nodes = [graph.node(bond.other(junction)) for bond in bonds]
    if len(nodes) == 1:
        return isinstance(nodes[0], Source)
    integrators = [n for n in nodes if isinstance(n, Compliance) and n.law == q]
    rates = [n for n in nodes if isinstance(n, FlowSource) and n.value is not None]
    return len(nodes) == 2 and len(integrators) == len(rates) == 1
