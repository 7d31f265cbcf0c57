"""From start values to an optimum: settle the initial states, approach, descend."""

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.first_states import first_guess
from bondgraph.fitting.growing import first_windows, grow
from bondgraph.fitting.levenberg_marquardt import Optimum
from bondgraph.fitting.multiple_shooting import shoot_multiply
from bondgraph.fitting.problem import FitProblem, Linearisation, write_windows
from bondgraph.fitting.settling import settle
from bondgraph.fitting.starts import Starts, start_values
from bondgraph.fitting.steps import total_cost
from bondgraph.fitting.strategy import (
    Direct,
    GrowingWindows,
    MultipleShooting,
    Strategy,
)
from bondgraph.fitting.window_after_window import descend, settled_on

Array = NDArray[np.float64]


def solve(
    problem: FitProblem,
    *,
    theta: Array | None = None,
    initial: Array | None = None,
    iterations: int = 60,
    tolerance: float | None = None,
    strategy: Strategy | None = None,
) -> Optimum:
    """Settle the initial states, approach as the strategy says, then fit everything.

    Parameters
    ----------
    theta, initial
        Where to start; the problem's values, and states settled on the first samples.
    strategy
        How to come near; at once where None.
    """
    start = problem.start[problem.free] if theta is None else theta
    states = initial if initial is not None else first_guess(problem, start)
    states, here = settle(problem, start, states)
    if not np.isfinite(here.cost).all():
        states, here = _from_rest_where_lost(problem, start, states, here)
    states = settled_on(problem, start, states, here)
    warm = None if strategy is None else approach(problem, start, strategy)
    if warm is not None:
        warm_states, there = settle(problem, *warm)
        warm_states = settled_on(problem, warm[0], warm_states, there)
        ahead = total_cost(problem, there.cost, warm[0])
        if not total_cost(problem, here.cost, start) <= ahead:
            start, states = warm[0], warm_states
    return descend(problem, start, states, iterations=iterations, tolerance=tolerance)


def _from_rest_where_lost(
    problem: FitProblem, theta: Array, states: Array, here: Linearisation
) -> tuple[Array, Linearisation]:
    """Return states and costs with the windows that cannot be simulated begun at rest.

    What the first samples hardly show (how warm a wire is, before any current flows)
    they may suggest to be anything, and from there the whole window runs away.
    """
    lost = ~np.isfinite(here.cost)
    at_rest, there = settle(problem, theta, np.where(lost[:, None], 0.0, states))
    write_windows(here, problem.shots.edges, np.arange(len(lost)), there, lost)
    return np.where(lost[:, None], at_rest, states), here


def solve_from(
    problem: FitProblem, starts: Starts, strategy: Strategy, iterations: int
) -> Optimum:
    """Return the best optimum over all starts."""
    found = [
        solve(problem, theta=theta, iterations=iterations, strategy=strategy)
        for theta in start_values(starts, problem)
    ]
    return min(found, key=lambda optimum: optimum.cost)


def approach(
    problem: FitProblem, theta: Array, strategy: Strategy
) -> tuple[Array, Array] | None:
    """Return parameters and initial states near the optimum; None for no advice."""
    longest = problem.shots.lengths.max()
    if not len(problem.free) or problem.model.n_states == 0:
        return None
    match strategy:
        case Direct():
            return None
        case GrowingWindows():
            if longest <= 2 * strategy.shortest:
                return None
            first = first_windows(problem, strategy)
            return grow(problem, theta, first_guess(first, theta), strategy)
        case MultipleShooting():
            return shoot_multiply(problem, theta, strategy)
