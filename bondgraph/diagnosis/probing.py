"""What happens at each place: signals of the fitted base model, read with probes.

A probe is a measurement added to a copy of the graph; it changes no equation. Typical
sizes scale the start values of hypotheses; the signals are the abscissae of recovered
laws.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.diagnosis.lasting import lasting
from bondgraph.diagnosis.ringing import ringing
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.state_equations import State
from bondgraph.fitting.estimate import FittedModel, pose, prepare
from bondgraph.fitting.horizon import Horizon, cut
from bondgraph.fitting.settling import settle
from bondgraph.fitting.truncated_inverse import truncated_inverse
from bondgraph.numeric.model import compile_model
from bondgraph.physics.places.base import ELECTRIC
from bondgraph.physics.places.displacements import known_displacement
from bondgraph.physics.places.junction import junction_place
from bondgraph.physics.places.scales import Scales
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import implicit
from bondgraph.structure.domains import Quantity
from bondgraph.structure.edits import InsertElement
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Inertance,
    Junction,
    OneJunction,
)
from bondgraph.structure.graph import FinishedGraph, Measurement
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import Signal, displacement, momentum, parameter_symbol

Array = NDArray[np.float64]
VIRTUAL = "virtual_source"
SELDOM = 0.01
"""A share of the samples in which a signal has not really been."""

STRAY = 50.0
"""So many times larger than hardly any other value: no machine, but a fit went there.

Impacts, which are short as well, are some ten times what else acts.
"""

BEGUN_ASTRAY = 3.0
"""The same of the first samples of a window, whose state nothing but the fit tells."""


def common_signal(junction: Junction) -> Signal:
    """Return the variable that the bonds of a junction share."""
    if isinstance(junction, OneJunction):
        return Signal(Quantity.FLOW, junction.name)
    return Signal(Quantity.EFFORT, junction.name)


def _probes(graph: FinishedGraph) -> tuple[Signal, ...]:
    """Return the signals to read: common variables, and what the bonds carry."""
    own = [common_signal(junction) for junction in graph.junctions]
    for junction in graph.junctions:
        other = Quantity.EFFORT if isinstance(junction, OneJunction) else Quantity.FLOW
        own += [Signal(other, bond.name) for bond in graph.bonds_at(junction.name)]
    read = {
        signal
        for measurement in graph.measurements
        for signal in measurement.expression.free_symbols
        if isinstance(signal, Signal) and signal.quantity is Quantity.DISPLACEMENT
    }
    held = {
        displacement(element.name)
        for element in graph.elements
        if isinstance(element, Compliance)
    } | {
        momentum(element.name)
        for element in graph.elements
        if isinstance(element, Inertance) and graph.domain_at(element.name) in ELECTRIC
    }
    unique = dict.fromkeys([*own, *sorted(read | held, key=lambda s: s.name)])
    return tuple(unique)


def probe(
    fitted: FittedModel, signals: Sequence[sympy.Expr]
) -> dict[sympy.Expr, Array]:
    """Return the samples of signals, or of what is made of them, as simulated.

    A signal that follows from no equation at the first sample (an algebraic loop that a
    step can close, and nothing before it) is nan, and takes no other with it.
    """
    found = _probed_together(fitted, signals)
    if len(signals) < 2 or any(np.isfinite(x).any() for x in found.values()):
        return found
    half = len(signals) // 2
    return probe(fitted, signals[:half]) | probe(fitted, signals[half:])


def _probed_together(
    fitted: FittedModel, signals: Sequence[sympy.Expr]
) -> dict[sympy.Expr, Array]:
    graph = replace(
        fitted.graph,
        measurements=(
            *fitted.graph.measurements,
            *(Measurement(f"probe_{i}", s, "1") for i, s in enumerate(signals)),
        ),
    )
    problem, shots = fitted.problem, fitted.problem.shots
    padded = Shots(
        shots.time,
        shots.inputs,
        np.zeros((len(shots.time), len(graph.measurements))),
        shots.edges,
    )
    shot = shoot(
        prepare(graph),
        padded,
        parameters=fitted.parameters,
        initial=fitted.optimum.initial,
        directions=None,
        solver=problem.solver,
        hold=problem.hold,
    )
    values = shot.outputs[:, len(fitted.graph.measurements) :]
    return {signal: values[:, i] for i, signal in enumerate(signals)}


def measure_scales(fitted: FittedModel) -> Scales:
    """Return typical sizes and ranges of the signals at every place, and of channels.

    What a sensor reads directly has the range that was measured: a model without an
    end stop passes it.
    """
    graph, shots = fitted.graph, fitted.problem.shots
    found = {
        signal.name: _without_strays(_once_begun(values, shots))
        for signal, values in probe(fitted, _probes(graph)).items()
    }
    names = fitted.problem.model.input_names
    for name, values in zip(names, shots.inputs.T, strict=True):
        effort = isinstance(graph.node(name), EffortSource)
        quantity = Quantity.EFFORT if effort else Quantity.FLOW
        found[Signal(quantity, name).name] = values
    for measurement, values in zip(graph.measurements, shots.outputs.T, strict=True):
        found[measurement.name] = values
        if isinstance(measurement.expression, Signal):
            found[measurement.expression.name] = values
    found |= _between(graph, fitted.values, found)
    known = {name: x for name, x in found.items() if np.isfinite(x).any()}
    sizes = {name: float(np.sqrt(np.nanmean(x**2))) for name, x in known.items()}
    for junction in graph.junctions:
        quantity = (
            Quantity.EFFORT if isinstance(junction, OneJunction) else Quantity.FLOW
        )
        bonds = [f"{quantity}({b.name})" for b in graph.bonds_at(junction.name)]
        told = [sizes[bond] for bond in bonds if bond in sizes]
        sizes[f"{quantity}({junction.name})"] = max(told, default=0.0)
    interval = shots.interval
    return Scales(
        sizes,
        {name: (float(np.nanmin(x)), float(np.nanmax(x))) for name, x in known.items()},
        interval=interval,
        duration=float(
            max(shots.time[s.stop - 1] - shots.time[s.start] for s in shots.slices)
        ),
        fitted=fitted.values,
        least={} if interval else _least(known),
        ringing=ringing(fitted),
        tenths={
            name: _tenths(values)
            for name, values in zip(names, shots.inputs.T, strict=True)
        },
        # Rows of a table come in no order.
        lasting=lasting(shots.time, known) if interval else frozenset(),
        begin=float(shots.time.min()),
    )


def _once_begun(values: Array, shots: Shots) -> Array:
    """Return values without the first of a window that begins far beyond all others.

    Where hardly anything tells the state in which a window begins, a stiff model may
    begin anywhere, and is where it belongs some samples later.
    """
    usual = _usual(values)
    if not usual:
        return values
    low, high = np.nanquantile(values, (SELDOM / 2, 1.0 - SELDOM / 2))
    beyond = ~((values >= low) & (values <= high))
    kept = values.copy()
    for window in shots.slices:
        if np.abs(values[window.start]) > BEGUN_ASTRAY * usual:
            kept[window][np.logical_and.accumulate(beyond[window])] = np.nan
    return kept


def _without_strays(values: Array) -> Array:
    """Return values without the few that are as if from elsewhere."""
    usual = _usual(values)
    return np.where(np.abs(values) > STRAY * usual, np.nan, values) if usual else values


def _usual(values: Array) -> float:
    """Return what hardly any value is beyond in size; 0 where there is none."""
    sizes = np.abs(values)
    known = np.isfinite(sizes).any()
    return float(np.nanquantile(sizes, 1.0 - SELDOM)) if known else 0.0


def _tenths(values: Array) -> int:
    """Return in how many tenths of its largest size a signal has been, not just once.

    In one of a hundred samples, in that of zero too.
    """
    sizes = np.abs(values[np.isfinite(values)])
    if not sizes.size or sizes.max() == 0.0:
        return 1
    counts, _ = np.histogram(sizes / sizes.max(), bins=10, range=(0.0, 1.0))
    return int(np.count_nonzero(counts >= SELDOM * sizes.size))


def _least(known: Mapping[str, Array]) -> dict[str, float]:
    """Return the least size other than zero of every signal that has one."""
    sizes = {name: np.abs(x[np.isfinite(x) & (x != 0.0)]) for name, x in known.items()}
    return {name: float(size.min()) for name, size in sizes.items() if size.size}


def _between(
    graph: FinishedGraph, values: Mapping[str, float], found: Mapping[str, Array]
) -> dict[str, Array]:
    """Return displacements that are made of those found, with the fitted `values`."""
    numbers = {parameter_symbol(name): value for name, value in values.items()}
    between = {}
    for junction in graph.junctions:
        parts = known_displacement(graph, junction.name) or {}
        factors = {displacement(name).name: k for name, k in parts.items()}
        own = displacement(junction.name).name
        if factors and own not in found and factors.keys() <= found.keys():
            shares = [float(k.xreplace(numbers)) * found[n] for n, k in factors.items()]
            between[own] = np.sum(shares, axis=0)
    return between


@dataclass(frozen=True, slots=True, eq=False)
class RecoveredSignal:
    """The missing effort (1-junction) or flow (0-junction) at one place.

    One value per window, positive into the junction, with the window's mean of the
    local variables (and of what else was asked for); ``explained`` is the share of the
    squared error it removes.
    """

    place: str
    value: Array
    std: Array
    local: dict[str, Array]
    explained: float


def recover(
    fitted: FittedModel,
    place: str,
    recordings: Sequence[BoundRecording],
    horizon: Horizon,
    also: Mapping[str, sympy.Expr] = MappingProxyType({}),
) -> RecoveredSignal:
    """Return the signal that a virtual source at `place` must give, window by window.

    The source is a state with rate zero whose initial value is estimated together with
    the other initial states, at the fitted parameters.

    Parameters
    ----------
    also
        What else to read beside the local variables, by the name it is to have.
    """
    shots = cut(recordings, horizon)
    graph = fitted.graph
    junction = next(j for j in graph.junctions if j.name == place)
    kind = EffortSource if isinstance(junction, OneJunction) else FlowSource
    symbol = parameter_symbol(f"{VIRTUAL}_value")
    edit = InsertElement(
        place, kind(VIRTUAL, value=symbol), (Parameter(name=symbol.name, value=0.0),)
    )
    virtual = edit.apply(graph)
    equations = derive(virtual)
    rate = parameter_symbol(f"{VIRTUAL}_rate")
    unknown = replace(
        equations,
        states=(*equations.states, State(symbol, rate, place, "1")),
        rates=(*equations.rates, rate * 0),
        parameters=tuple(p for p in equations.parameters if p != symbol),
    )
    plain = pose(graph, fitted.problem.model, shots, fitted.settings)
    plain = replace(
        plain,
        sigma=fitted.problem.sigma,
        start=fitted.parameters,
        solver=implicit(fitted.problem.solver),
    )
    origin = np.zeros((shots.n_windows, plain.model.n_states))
    states, before = settle(plain, plain.start[plain.free], origin)
    freed = replace(plain, model=compile_model(unknown))
    initial = np.column_stack([states, np.zeros(shots.n_windows)])
    settled, after = settle(freed, freed.start[freed.free], initial)
    value = settled[:, -1]
    return RecoveredSignal(
        place=place,
        value=value,
        std=_value_std(after.hessian, after.cost, shots.edges),
        local=_local_means(fitted, junction, shots, states, also),
        explained=_explained(before.cost, after.cost),
    )


def _explained(before: Array, after: Array) -> float:
    """Return the share of the cost taken away, over windows that can be simulated."""
    ran = np.isfinite(before) & np.isfinite(after)
    whole = float(before[ran].sum())
    return 1.0 - float(after[ran].sum()) / whole if whole > 0.0 else 0.0


def _value_std(hessian: Array, cost: Array, edges: Sequence[int]) -> Array:
    """Return the standard deviation of the virtual value in each window.

    Infinite where a window cannot be simulated.
    """
    spare = np.maximum(np.diff(edges) - hessian.shape[-1], 1)
    variance = truncated_inverse(hessian)[:, -1, -1]
    ran = np.isfinite(cost)
    power = np.maximum(variance, 0.0) * np.where(ran, cost, 0.0) / spare
    std: Array = np.where(ran, np.sqrt(power), np.inf)
    return std


def _local_means(
    fitted: FittedModel,
    junction: Junction,
    shots: Shots,
    states: Array,
    also: Mapping[str, sympy.Expr],
) -> dict[str, Array]:
    """Return window means of the local variables, by quantity, and of what else."""
    own = common_signal(junction)
    wanted: dict[str, sympy.Expr] = {own.quantity.value: own, **also}
    moved_by = junction_place(fitted.graph, junction.name, Scales()).displacement_signal
    if moved_by is not None:
        wanted[Quantity.DISPLACEMENT.value] = moved_by
    moved = replace(
        fitted,
        problem=replace(fitted.problem, shots=shots),
        optimum=replace(fitted.optimum, initial=states),
    )
    signals = probe(moved, tuple(wanted.values()))
    return {
        name: np.array([signals[signal][part].mean() for part in shots.slices])
        for name, signal in wanted.items()
    }
