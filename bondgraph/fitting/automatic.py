"""The horizon that suits a machine: whole recordings, or windows found by growing."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.first_states import first_guess
from bondgraph.fitting.growing import TOLERANCE, held_weakly, rescaled
from bondgraph.fitting.horizon import (
    SHORTEST,
    Horizon,
    WholeRecordings,
    Windows,
    cut,
)
from bondgraph.fitting.levenberg_marquardt import Optimum, minimise
from bondgraph.fitting.posing import pose
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.settings import FitSettings
from bondgraph.fitting.solving import solve
from bondgraph.numeric.model import NumericModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.shooting import shoot
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
GROWTH = 1.1
GROWING = 1.5
"""An effect that is so many times larger at the end than in the first half grows."""

DOUBLED = 16.0
"""An effect that grows by more than this over twice the time grows exponentially."""

STAYS = 0.5
"""An effect that keeps this share of the largest it has had to the end has stayed."""


def choose_horizon(
    graph: FinishedGraph,
    model: NumericModel,
    recordings: Sequence[BoundRecording],
    settings: FitSettings,
) -> Horizon:
    """Return whole recordings, or the window that suits an integrating plant."""
    return automatic_horizon(graph, model, recordings, settings)[0]


def automatic_horizon(
    graph: FinishedGraph,
    model: NumericModel,
    recordings: Sequence[BoundRecording],
    settings: FitSettings,
) -> tuple[Horizon, Optimum | None]:
    """Return the horizon that suits, and the optimum over it where it is known already.

    The window is doubled as long as the residual stays within a tenth of its
    level over short windows: while measurement noise dominates it is level, and it
    grows once what the model leaves out accumulates.
    """
    whole = WholeRecordings()
    if not accumulates(graph, model, recordings, settings):
        return whole, None
    problem = pose(graph, model, cut(recordings, whole), settings)
    longest = int(problem.shots.lengths.max())
    samples = max(SHORTEST, 6 * model.n_states)
    best: tuple[Horizon, Optimum | None] = Windows(samples), None
    lowest, states = math.inf, None
    theta = problem.start[problem.free]
    stage = held_weakly(problem, theta)
    while samples < 2 * longest:
        last = samples >= longest
        horizon = whole if last else Windows(samples)
        shots = problem.shots if last else cut(recordings, horizon)
        stage = replace(stage, shots=shots)
        initial = None if states is None else states[list(shots.edges[:-1])]
        optimum = solve(
            stage, theta=theta, initial=initial, iterations=15, tolerance=TOLERANCE
        )
        if states is None:
            # The first residual scale was a guess, against which a prior weighs much.
            stage = rescaled(stage, optimum)
            optimum = minimise(stage, optimum.theta, optimum.initial, iterations=15)
        size = _relative_size(stage, optimum, problem.sigma)
        lowest = min(lowest, size)
        if not size <= GROWTH * lowest:
            return best
        stage = rescaled(stage, optimum)
        theta, states = optimum.theta, optimum.linearisation.states
        best, samples = (horizon, optimum), 2 * samples
    return best


def _relative_size(problem: FitProblem, optimum: Optimum, sigma: Array) -> float:
    """Return the root mean square of the residuals over `sigma`."""
    if not np.isfinite(optimum.cost):
        return math.inf
    own = optimum.linearisation.residuals * problem.sigma / sigma
    return math.sqrt(float((own**2).sum()) / own.size)


def accumulates(
    graph: FinishedGraph,
    model: NumericModel,
    recordings: Sequence[BoundRecording],
    settings: FitSettings,
) -> bool:
    """Return whether the effect of an initial state on the outputs does not fade.

    True for integrators and unstable plants, judged by the sensitivity of the outputs
    to the initial state over the longest recording.
    """
    size = _effects(graph, model, max(recordings, key=len), settings)
    if not np.isfinite(size).all():
        return True
    tail = size[-max(len(size) // 10, 1) :].max(axis=0)
    peak = size.max(axis=0)
    # An oscillation decays; an integrator stays at its peak to the end.
    ends_level = (tail >= 0.999 * peak) & (peak > 0.0)
    return bool(ends_level.any())


def grows(
    graph: FinishedGraph,
    model: NumericModel,
    recordings: Sequence[BoundRecording],
    settings: FitSettings,
) -> bool:
    """Return whether the effect of an initial state on the outputs goes on growing.

    True for unstable plants and for what integrates twice: there the least disturbance
    is more than anything else in the end. One that has run away as far as it can go,
    a ball to the lowest end of its beam, goes on growing no more, and stays there.
    """
    size = _effects(graph, model, max(recordings, key=len), settings)
    if not np.isfinite(size).all():
        return True
    early, late = size[: len(size) // 2 + 1], size[-max(len(size) // 10, 1) :]
    if (late.max(axis=0) > GROWING * early.max(axis=0)).any():
        return True
    reached = np.maximum.accumulate(size, axis=0)
    half = reached[SHORTEST : len(size) // 2]
    whole = reached[2 * SHORTEST :][: 2 * len(half) : 2]
    exploded = (whole > DOUBLED * half) & (half > 0.0)
    stays = late.max(axis=0) > STAYS * reached[-1]
    return bool((exploded.any(axis=0) & stays).any())


def remembered(
    graph: FinishedGraph,
    model: NumericModel,
    recordings: Sequence[BoundRecording],
    settings: FitSettings,
    samples: int,
) -> int:
    """Return the length of a window, at most `samples`, that a fit can hold on to.

    On an unstable plant the effect of an initial state grows without measure, and no
    fit finds its way over a window in which it has grown by a million. It is halved
    until doubling it would not make the effect much larger: over twice the time an
    integrator's is twice as large, that of three after each other eight times.
    """
    size = _effects(graph, model, max(recordings, key=len), settings)
    reached = np.maximum.accumulate(np.where(np.isfinite(size), size, np.inf), axis=0)
    samples = min(samples, len(reached))
    while samples > SHORTEST:
        whole, half = reached[samples - 1], reached[samples // 2 - 1]
        # What has no effect yet by then is late, and not unstable.
        if np.all((whole <= DOUBLED * half) & np.isfinite(whole) | (half == 0.0)):
            break
        samples = max(samples // 2, SHORTEST)
    return samples


def _effects(
    graph: FinishedGraph,
    model: NumericModel,
    recording: BoundRecording,
    settings: FitSettings,
) -> Array:
    """Return the largest effect of each initial state on an output, sample by sample.

    Shape (samples, states). A machine with dry friction is judged where it moves: what
    sticks keeps its state for ever.
    """
    if model.n_states == 0:
        return np.zeros((len(recording), 0))
    shots = cut([recording], WholeRecordings())
    problem = pose(graph, model, shots, settings)
    initial = np.zeros((shots.n_windows, model.n_states))
    if model.set_valued is not None:
        initial = first_guess(problem, problem.start[problem.free])
    shot = shoot(
        model,
        shots,
        parameters=problem.start,
        initial=initial,
        directions=np.zeros(0, np.int64),
        solver=settings.solver,
        hold=settings.hold,
    )
    size: Array = np.abs(shot.sensitivities[shots.slices[0]]).max(axis=1)
    return size
