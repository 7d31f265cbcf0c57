"""What is local at a place: its own flow or effort, displacement, loads, and time.

The variables are read where the smoothing found the machine to be, with the source that
stands for what is missing: its states fit the recordings, the base model's do not.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.location.laws import LocalVariable
from bondgraph.diagnosis.virtual.chain import Chain
from bondgraph.diagnosis.virtual.sources import PlaceKind, VirtualSource
from bondgraph.fitting.estimate import FittedModel, prepare
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import Junction, is_one_port
from bondgraph.structure.graph import FinishedGraph, Measurement
from bondgraph.structure.signals import Signal

Array = NDArray[np.float64]
CONJUGATE = {Quantity.EFFORT: Quantity.FLOW, Quantity.FLOW: Quantity.EFFORT}
INTEGRAL = {
    Quantity.EFFORT: Quantity.MOMENTUM,
    Quantity.FLOW: Quantity.DISPLACEMENT,
}


@dataclass(frozen=True, slots=True)
class _Read:
    """A signal to read and the part it plays."""

    signal: Signal
    role: str


class Probes:
    """The signals around all places of a fitted model, read through one model.

    A signal that would add a state of its own is not read.
    """

    def __init__(self, fitted: FittedModel, sources: Sequence[VirtualSource]) -> None:
        graph = fitted.graph
        self._fitted = fitted
        wanted = (read.signal for s in sources for read in _wanted(graph, s))
        self._signals = tuple(dict.fromkeys(wanted))
        probes = tuple(
            Measurement(f"probe_{i}", signal, "1")
            for i, signal in enumerate(self._signals)
        )
        measurements = (*graph.measurements, *probes)
        self._model = prepare(replace(graph, measurements=measurements))

    def read(self, shots: Shots, theta: Array, states: Array) -> dict[str, Array]:
        """Return outputs and signals by name, along given states."""
        n, width = len(states), len(self._model.output_names)
        problem = self._fitted.problem
        alone = Shots(
            shots.time, shots.inputs, np.zeros((n, width)), tuple(range(n + 1))
        )
        shot = shoot(
            self._model,
            alone,
            parameters=problem.with_parameters(theta),
            initial=states,
            directions=None,
            solver=problem.solver,
            hold=problem.hold,
        )
        names = [*problem.model.output_names, *(s.name for s in self._signals)]
        return dict(zip(names, np.ascontiguousarray(shot.outputs.T), strict=True))


def local_variables(
    fitted: FittedModel,
    chain: Chain,
    source: VirtualSource,
    signals: Mapping[str, Array],
) -> dict[str, LocalVariable]:
    """Return the variables at a place by name.

    Parameters
    ----------
    signals
        As `Probes.read` gives them.
    """
    found: dict[str, LocalVariable] = {}
    for read in _wanted(fitted.graph, source):
        name, values = read.signal.name, signals[read.signal.name]
        found[name] = LocalVariable(
            name=name,
            role=read.role,
            unit=_unit(fitted.graph, read.signal),
            values=values,
        )
        if read.role == "own":
            integral = _integral(fitted.graph, chain, read.signal, values)
            found[integral.name] = integral
    if source.kind is PlaceKind.INPUT:
        index = fitted.problem.model.input_names.index(source.place)
        column = chain.shots.inputs[:, index]
        found = {source.place: _value(source, column), **found}
    if source.kind is PlaceKind.OUTPUT:
        found[source.place] = _value(source, signals[source.place])
    if chain.follows.any():
        found["time"] = LocalVariable(
            name="time", role="time", unit="s", values=_clock(chain)
        )
    return found


def _wanted(graph: FinishedGraph, source: VirtualSource) -> list[_Read]:
    """Return the signals to read at a place."""
    if source.kind is PlaceKind.OUTPUT:
        return []
    if source.kind is PlaceKind.INPUT:
        effort = (
            graph.input_unit(source.place) == graph.domain_at(source.place).effort_unit
        )
        answer = Quantity.FLOW if effort else Quantity.EFFORT
        return [_Read(Signal(answer, source.place), "conjugate")]
    own = Quantity.FLOW if source.kind is PlaceKind.EFFORT else Quantity.EFFORT
    reads = [_Read(Signal(own, source.place), "own")]
    for bond in graph.bonds_at(source.place):
        other = graph.node(bond.other(source.place))
        if isinstance(other, Junction) or not is_one_port(other):
            reads.append(_Read(Signal(CONJUGATE[own], bond.name), "load"))
    return reads


def _unit(graph: FinishedGraph, signal: Signal) -> str:
    return graph.domain_at(signal.place).unit(signal.quantity)


def _value(source: VirtualSource, values: Array) -> LocalVariable:
    return LocalVariable(
        name=source.place,
        role="value",
        unit=source.unit,
        values=np.ascontiguousarray(values),
    )


def _integral(
    graph: FinishedGraph, chain: Chain, own: Signal, values: Array
) -> LocalVariable:
    """Return the displacement (momentum) from where each recording began."""
    quantity = INTEGRAL[own.quantity]
    steps = np.where(
        chain.follows, np.diff(chain.shots.time, prepend=chain.shots.time[0]), 0.0
    )
    before = np.concatenate([values[:1], values[:-1]])
    total = np.cumsum(0.5 * (values + before) * steps)
    starts = np.flatnonzero(~chain.follows)
    lengths = np.diff([*starts, len(total)])
    total = total - np.repeat(total[starts], lengths)
    signal = Signal(quantity, own.place)
    return LocalVariable(
        name=signal.name,
        role="displacement",
        unit=_unit(graph, signal),
        values=total,
    )


def _clock(chain: Chain) -> Array:
    """Return the time since the first sample, recordings one after the other."""
    steps = np.diff(chain.shots.time, prepend=chain.shots.time[0])
    return np.cumsum(np.where(chain.follows, steps, 0.0))
