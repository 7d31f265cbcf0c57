"""`separability`: before any claim, which places could be told apart at all.

Two answers, from the structure of the equations and from the machine as it was driven:
what the structure cannot isolate no values can; what it can isolate may still look
alike to the sensors there are. Then every sensor that is not there is tried.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.separability.angles import (
    SAME,
    Complex,
    angle_matrix,
    classes_of,
    responses,
)
from bondgraph.diagnosis.separability.records import (
    SensorProposal,
    Separability,
    SeparabilityStatus,
)
from bondgraph.diagnosis.separability.redundancy import isolability
from bondgraph.diagnosis.virtual.chain import Chain, linear_chain, trajectory
from bondgraph.diagnosis.virtual.noise import noise_scale
from bondgraph.diagnosis.virtual.sources import chosen_sources
from bondgraph.fitting.estimate import FitSettings, FittedModel, fit_model
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.shooting import Shots
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import OneJunction
from bondgraph.structure.graph import FinishedGraph, Measurement
from bondgraph.structure.signals import Signal

Array = NDArray[np.float64]
USUAL_NOISE = 1e-3
"""Of a signal's spread: noise of a sensor that is not there, at least."""
MOST_STEPS = 400
"""Steps that are linearised: operating points enough, however long the recordings."""


def separability(
    model: FittedModel | FinishedGraph,
    recordings: Sequence[BoundRecording],
    *,
    places: Sequence[str] | None = None,
) -> Separability:
    """Say which places these sensors can tell apart, and which sensor would help.

    Parameters
    ----------
    model
        A fitted model, or a graph whose parameters have values.
    recordings
        What drives it: trajectories matter where laws are not linear, and the noise of
        the sensors is estimated from them.
    places
        Names of junctions, inputs and outputs; all when None.

    Raises
    ------
    FitError, ParameterError
        If a place is not in the model, or a parameter has no value.
    """
    fitted = model if isinstance(model, FittedModel) else _held(model, recordings)
    sources = chosen_sources(fitted.graph, places)
    names = tuple(source.place for source in sources)
    candidates = _candidates(fitted.graph)
    visited, states = _some_steps(_extended(fitted, candidates), trajectory(fitted))
    chain = linear_chain(visited, sources, states=states)
    noise = _noises(chain, noise_scale(fitted, recordings))
    whole = responses(chain, noise, len(fitted.problem.shots.time))
    ny = len(fitted.graph.measurements)
    angles = angle_matrix(whole[:, :ny])
    classes = classes_of(names, angles < SAME)
    detectable, isolable = isolability(fitted.graph, sources)
    alike = ~(isolable & isolable.T)
    proposals = _proposals(fitted.graph, whole, ny, names, classes, candidates)
    return Separability(
        status=_status(classes),
        places=names,
        angles=angles,
        classes=classes,
        structural_classes=classes_of(names, alike),
        undetectable=tuple(
            name for name, seen in zip(names, detectable, strict=True) if not seen
        ),
        proposals=proposals,
        reasons=_reasons(classes, proposals),
    )


def _held(graph: FinishedGraph, recordings: Sequence[BoundRecording]) -> FittedModel:
    """Return a graph run through recordings with all its parameters held."""
    held = graph.with_parameters(
        [replace(parameter, std=0.0) for parameter in graph.parameters.members]
    )
    return fit_model(held, recordings, FitSettings(horizon=WholeRecordings()))


def _candidates(graph: FinishedGraph) -> tuple[Signal, ...]:
    """Return the common variables of junctions that no sensor reads."""
    read = {measurement.expression for measurement in graph.measurements}
    signals = (
        Signal(Quantity.FLOW if isinstance(j, OneJunction) else Quantity.EFFORT, j.name)
        for j in graph.junctions
    )
    return tuple(signal for signal in signals if signal not in read)


def _extended(fitted: FittedModel, candidates: Sequence[Signal]) -> FittedModel:
    """Return the fit with more sensors, of which no samples are known."""
    graph, shots = fitted.graph, fitted.problem.shots
    more = tuple(
        Measurement(f"candidate_{i}", s, "1") for i, s in enumerate(candidates)
    )
    unknown = np.full((len(shots.time), len(more)), np.nan)
    padded = Shots(
        shots.time, shots.inputs, np.hstack([shots.outputs, unknown]), shots.edges
    )
    return replace(
        fitted,
        graph=replace(graph, measurements=(*graph.measurements, *more)),
        problem=replace(fitted.problem, shots=padded),
    )


def _some_steps(fitted: FittedModel, states: Array) -> tuple[FittedModel, Array]:
    """Return the fit with a few of its steps, each a window, and the states there."""
    shots = fitted.problem.shots
    inside = np.ones(len(shots.time), dtype=bool)
    inside[list(shots.edges[:-1])] = False
    ends = np.flatnonzero(inside)
    if len(ends) <= MOST_STEPS:
        return fitted, states
    chosen = ends[np.linspace(0, len(ends) - 1, MOST_STEPS).astype(int)]
    rows = np.column_stack([chosen - 1, chosen]).ravel()
    some = Shots(
        shots.time[rows],
        shots.inputs[rows],
        shots.outputs[rows],
        tuple(range(0, len(rows) + 1, 2)),
    )
    return replace(fitted, problem=replace(fitted.problem, shots=some)), states[rows]


def _noises(chain: Chain, known: Array) -> Array:
    """Return the noise of the sensors there are, and of those there are not."""
    spread = np.std(chain.outputs, axis=0)
    ny = len(known)
    share = np.median(known / np.where(spread[:ny] > 0.0, spread[:ny], np.inf))
    assumed = max(float(share), USUAL_NOISE) * spread[ny:]
    return np.concatenate([known, np.where(assumed > 0.0, assumed, np.inf)])


def _proposals(
    graph: FinishedGraph,
    whole: Complex,
    ny: int,
    names: tuple[str, ...],
    classes: tuple[tuple[str, ...], ...],
    candidates: Sequence[Signal],
) -> tuple[SensorProposal, ...]:
    """Return the sensors that would split a class, the clearest first."""
    found = []
    for k, signal in enumerate(candidates):
        with_it = angle_matrix(whole[:, [*range(ny), ny + k]])
        for members in classes:
            own = [names.index(member) for member in members]
            angles = with_it[np.ix_(own, own)]
            into = classes_of(members, angles < SAME)
            if len(into) < 2:
                continue
            label = {name: i for i, part in enumerate(into) for name in part}
            least = min(
                angles[i, j]
                for i in range(len(own))
                for j in range(i)
                if label[members[i]] != label[members[j]]
            )
            found.append(
                SensorProposal(
                    quantity=graph.domain_at(signal.place).word(signal.quantity),
                    place=signal.place,
                    unit=graph.domain_at(signal.place).unit(signal.quantity),
                    splits=members,
                    into=into,
                    angle=float(least),
                )
            )
    return tuple(sorted(found, key=lambda p: (-len(p.into), -p.angle)))


def _status(classes: tuple[tuple[str, ...], ...]) -> SeparabilityStatus:
    if all(len(members) == 1 for members in classes):
        return SeparabilityStatus.ALL
    if len(classes) == 1:
        return SeparabilityStatus.NONE
    return SeparabilityStatus.CLASSES


def _reasons(
    classes: tuple[tuple[str, ...], ...], proposals: Sequence[SensorProposal]
) -> tuple[str, ...]:
    reasons = []
    for members in classes:
        if len(members) < 2:
            continue
        reasons.append(f"Free signals at {', '.join(members)} look alike.")
        best = next((p for p in proposals if p.splits == members), None)
        reasons.append(
            best.statement
            if best is not None
            else "No one further effort or flow sensor at a junction would split these."
        )
    return tuple(reasons)
