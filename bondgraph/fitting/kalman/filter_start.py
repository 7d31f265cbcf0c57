"""Where a fit by innovations starts: states, scales and noise from short windows."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import FitError, did_you_mean
from bondgraph.fitting.first_states import first_guess
from bondgraph.fitting.growing import cut_finer
from bondgraph.fitting.horizon import SHORTEST, WholeRecordings, cut
from bondgraph.fitting.kalman.filter_setting import Filtered, Setting, Unknowns
from bondgraph.fitting.kalman.filtering import filtered
from bondgraph.fitting.kalman.kalman_choices import KalmanFilter
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.fitting.posing import pose, prepare
from bondgraph.fitting.problem import FitProblem, Linearisation
from bondgraph.fitting.settings import FitSettings
from bondgraph.fitting.settling import settle
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.shooting import Shots
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
GRID = (1e-3, 1e-2, 1e-1, 1.0, 10.0)


def filter_starts(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    shaken: Sequence[str] | None,
    settings: FitSettings,
    kalman: KalmanFilter,
) -> tuple[Setting, Setting]:
    """Return two places to start: a fit of short windows, and the model's own values.

    Short windows of a machine that noise hides may run away to parameters that mean
    nothing; which of the two is likelier tells.

    Raises
    ------
    FitError, ParameterError
        If the model has no state or output, a parameter has no value, or a name in
        `shaken` is no state.
    """
    model = prepare(graph)
    names = model.state_names
    if not names:
        raise FitError(
            f"{graph.name!r} has no state to filter.", (graph.name,), "Use fit."
        )
    chosen = [n for n in names if n.startswith("p_")] or list(names)
    for name in shaken or ():
        if name not in names:
            raise FitError(
                f"{name!r} is no state of {graph.name!r}.",
                (name,),
                did_you_mean(name, names),
            )
    index = [names.index(name) for name in (shaken or chosen)]
    problem = pose(graph, model, cut(recordings, WholeRecordings()), settings)
    theta = problem.start[problem.free]
    short = replace(problem, shots=cut_finer(problem.shots, SHORTEST))
    warm = minimise(short, theta, first_guess(short, theta), iterations=15)
    own, at = settle(short, theta, first_guess(short, theta))
    shaken_states = np.array(index, dtype=np.int64)
    begun = (
        _setting(
            problem, short, warm.theta, warm.initial, warm.linearisation, shaken_states
        ),
        _setting(problem, short, theta, own, at, shaken_states),
    )
    return replace(begun[0], kalman=kalman), replace(begun[1], kalman=kalman)


def _setting(
    problem: FitProblem,
    short: FitProblem,
    theta: Array,
    initial: Array,
    at: Linearisation,
    shaken: NDArray[np.int64],
) -> Setting:
    """Take the scales and the first states from windows simulated at `theta`."""
    scale = np.std(at.states, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    rms = np.sqrt((at.residuals**2).sum(axis=0) / problem.measured)
    begins = np.searchsorted(short.shots.edge_array, problem.shots.edge_array[:-1])
    start = problem.start.astype(np.float64)
    start[problem.free] = theta
    return Setting(
        problem=replace(
            problem, start=start, sigma=np.maximum(rms, 1e-9) * problem.sigma
        ),
        pairs=_pairs(problem.shots),
        shaken=shaken,
        initial=initial[begins],
        spread=scale**2,
        scale=scale,
    )


def _pairs(shots: Shots) -> Shots:
    """Return every sample with the next one as a window, the last of each alone."""
    last = {stop - 1 for stop in shots.edges[1:]}
    rows = [(k,) if k in last else (k, k + 1) for k in range(shots.edges[-1])]
    index = np.array([k for pair in rows for k in pair], dtype=np.int64)
    edges = np.cumsum([0, *map(len, rows)])
    nothing = np.zeros((len(index), 0))
    return Shots(
        shots.time[index], shots.inputs[index], nothing, tuple(int(e) for e in edges)
    )


def best_noise(setting: Setting) -> tuple[Unknowns, Filtered] | None:
    """Return start values whose noise is the most likely on a coarse grid."""
    problem = setting.problem
    theta = problem.start[problem.free]
    found = []
    for share in GRID:
        at = Unknowns(
            theta,
            np.log(share * setting.scale[setting.shaken]),
            np.log(np.maximum(problem.sigma, 1e-300)),
        )
        tried = filtered(setting, at, None)
        if math.isfinite(tried.loss):
            found.append((at, tried))
    return min(found, key=lambda pair: pair[1].loss) if found else None
