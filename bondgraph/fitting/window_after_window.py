"""Windows that settled badly begin anew where the window before them ended.

The first samples tell a velocity poorly, and where dry friction decides whether a part
slides or sticks, a window that begins on the wrong side of that stays there. The window
before it knows better: the machine went on.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.levenberg_marquardt import Optimum, minimise
from bondgraph.fitting.problem import FitProblem, Linearisation, write_windows
from bondgraph.fitting.settling import settle
from bondgraph.fitting.steps import total_cost
from bondgraph.simulation.shooting import Shots

Array = NDArray[np.float64]

BAD = 10.0
"""A window that costs so many times what half of them cost is settled anew."""

WORTH = 0.99
"""Of the cost: windows that save less are not worth another descent."""

PASSES = 4
"""A window that was mended may mend the one after it; so often at most."""


def settled_on(
    problem: FitProblem, theta: Array, initial: Array, here: Linearisation
) -> Array:
    """Return initial states, those of bad windows carried on where that costs less.

    Parameters
    ----------
    initial, here
        States that each window has settled at, and the problem there; its linearisation
        is written over where a window is mended.
    """
    shots = problem.shots
    initial = initial.copy()
    tried = np.full_like(initial, np.nan)  # Which nothing is equal to.
    for _ in range(PASSES):
        ends = here.states[shots.edge_array[:-1] - 1]
        bad = _bad(problem, here) & (ends != tried).any(axis=1)
        at = np.flatnonzero(bad & np.isfinite(ends).all(axis=1))
        if not at.size:
            break
        tried[at] = ends[at]
        part = replace(problem, shots=shots.subset(at))
        settled, there = settle(part, theta, ends[at])
        better = there.cost < here.cost[at]
        if not better.any():
            break
        initial[at[better]] = settled[better]
        write_windows(here, shots.edges, at, there, better)
    return initial


def descend(
    problem: FitProblem,
    theta: Array,
    initial: Array,
    *,
    iterations: int,
    tolerance: float | None,
) -> Optimum:
    """Fit parameters and initial states; go on where a bad window can be mended."""
    found = minimise(
        problem, theta, initial, iterations=iterations, tolerance=tolerance
    )
    for _ in range(PASSES):
        if not problem.model.n_states or not _bad(problem, found.linearisation).any():
            break
        states, here = settle(problem, found.theta, found.initial)
        states = settled_on(problem, found.theta, states, here)
        mended = total_cost(problem, here.cost, found.theta)
        if not mended < WORTH * found.cost:
            break
        found = minimise(
            problem, found.theta, states, iterations=iterations, tolerance=tolerance
        )
    return found


def _bad(problem: FitProblem, at: Linearisation) -> NDArray[np.bool_]:
    """Return which windows cost far more than others, and have one before them."""
    costly = ~(at.cost <= BAD * np.median(at.cost))
    return costly & follows(problem.shots)


def follows(shots: Shots) -> NDArray[np.bool_]:
    """Return which windows go on a sample after another one's last."""
    begin = shots.edge_array[1:-1]
    gap = shots.time[begin] - shots.time[begin - 1]
    usual = np.median(np.diff(shots.time)) if len(shots.time) > 1 else 0.0
    return np.concatenate([[False], (gap > 0.0) & (gap < 2.0 * usual)])
