"""What a fit by innovations climbs: all samples filtered at given parameters and noise.

The transitions between samples and their exact slopes come from all samples simulated
at once, each from the state that the filter last estimated there; filter and simulation
take turns until these states stand still (the iterated extended Kalman filter, Bell and
Cathey, IEEE Trans. Autom. Control 38, 1993). The unscented one is in `point_filter`.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.first_states import first_guess
from bondgraph.fitting.growing import cut_finer
from bondgraph.fitting.horizon import SHORTEST
from bondgraph.fitting.kalman.filter_setting import (
    Filtered,
    Setting,
    Unknowns,
    process_of,
    starts_of,
)
from bondgraph.fitting.kalman.kalman_choices import Extended, Unscented
from bondgraph.fitting.kalman.point_filter import filtered_by_points
from bondgraph.fitting.settling import settle
from bondgraph.numeric.states_read import with_states_read
from bondgraph.simulation.shooting import shoot

Array = NDArray[np.float64]
TURNS = 6
STILL = 1e-6


def filtered(setting: Setting, at: Unknowns, near: Filtered | None) -> Filtered:
    """Filter and simulate by turns until the states stand still.

    Parameters
    ----------
    near
        What was found at unknowns close by.
    """
    if isinstance(setting.kalman, Unscented):
        begun = near
        if begun is None or begun.beliefs is None:
            begun = filtered(replace(setting, kalman=Extended()), at, near)
        if not math.isfinite(begun.loss):
            return begun
        return filtered_by_points(setting, setting.kalman, at, begun)
    states = _first_states(setting) if near is None else near.states
    for _ in range(TURNS):
        found = _once(setting, at, states)
        if not math.isfinite(found.loss):
            return found
        change = np.abs(found.states - states) / setting.scale
        states = found.states
        if change.max() <= STILL:
            break
    return found


def _first_states(setting: Setting) -> Array:
    """Return the states at every sample of short windows, each settled."""
    shots = cut_finer(setting.problem.shots, SHORTEST)
    short = replace(setting.problem, shots=shots)
    theta = setting.problem.start[setting.problem.free]
    _, at = settle(short, theta, first_guess(short, theta))
    return at.states


def _once(setting: Setting, at: Unknowns, around: Array) -> Filtered:
    """Simulate from the points `around` and filter along these transitions."""
    from bondgraph.fitting.kalman.kalman_filter import run_filter  # noqa: PLC0415  (numba)

    problem, pairs = setting.problem, setting.pairs
    shot = shoot(
        with_states_read(problem.model),
        pairs,
        parameters=problem.with_parameters(at.theta),
        initial=around,
        directions=np.zeros(0, np.int64),
        solver=problem.solver,
        hold=problem.hold,
    )
    ny, nx = len(problem.sigma), problem.model.n_states
    first, after = pairs.edge_array[:-1], pairs.edge_array[1:] - 1
    n = len(first)
    innovations, variances = np.zeros((n, ny)), np.ones((n, ny))
    states = np.zeros((n, nx))
    run_filter(
        np.ascontiguousarray(problem.shots.outputs),
        np.ascontiguousarray(shot.outputs[first, :ny]),
        np.ascontiguousarray(shot.sensitivities[first, :ny]),
        np.ascontiguousarray(shot.outputs[after, ny:]),
        np.ascontiguousarray(shot.sensitivities[after, ny:]),
        np.ascontiguousarray(around),
        pairs.time[after] - pairs.time[first],
        starts_of(setting),
        setting.initial,
        setting.spread,
        process_of(setting, at),
        np.exp(2.0 * at.noise),
        innovations,
        variances,
        states,
    )
    return Filtered(innovations, variances, states)
