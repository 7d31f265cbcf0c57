"""Damped Gauss-Newton for windowed fits, with bounds and eliminated initial states.

The damping is Marquardt's (relative to the diagonal), so the units of parameters do not
matter; bounds are kept by holding a parameter that pushes against its bound.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.problem import (
    FitProblem,
    Linearisation,
    linearise_windows,
    window_costs,
)
from bondgraph.fitting.settling import settle
from bondgraph.fitting.steps import Step, next_step, total_cost

Array = NDArray[np.float64]
RELATIVE_DECREASE = 1e-6
LARGEST_DAMPING = 1e9
WORSE = 1.01
UNFORESEEN = 1.2
GAUSS_NEWTON = 1e-3
"""Damping below which a step is the undamped one, and its promise the whole one."""

EXACT = 1e-4
"""A promise of this part of a decrease worth taking ends the iteration at once."""

TOLD_STD = 0.1
"""No step shorter than this, in standard deviations of a white fit, is worth taking."""

REPAIR_ITERATIONS = 4


@dataclass(frozen=True, slots=True, eq=False)
class Optimum:
    """Where the iteration ended.

    ``linearisation`` is at the optimum; ``cost`` includes the prior; ``converged`` is
    False at the iteration limit; ``lost`` counts the steps refused because nothing
    could be simulated there.
    """

    theta: Array
    initial: Array
    linearisation: Linearisation
    cost: float
    iterations: int
    converged: bool
    lost: int = 0


def _repair(
    problem: FitProblem,
    step: Step,
    costs: Array,
    before: tuple[Array, Linearisation, float],
) -> tuple[Step, Array]:
    """Settle the windows that a step made worse than promised, from where they were.

    One window in which friction sticks where it slid would otherwise refuse a step that
    is right for all others. A window that ends as the linearised problem says is none
    of these, even if the others gain at its cost. Where all this does not save the
    step, it is returned as it was.

    Parameters
    ----------
    costs
        Of every window after the step; what they are then is returned.
    before
        Initial states, linearisation and whole cost where the step was taken from.
    """
    initial, here, cost = before
    old = here.cost
    worse = np.flatnonzero(
        ~(costs <= np.maximum(WORSE * old, UNFORESEEN * step.promised))
    )
    if len(worse) == 0 or problem.model.n_states == 0:
        return step, costs
    part = replace(problem, shots=problem.shots.subset(worse))
    settled, at = settle(part, step.theta, initial[worse], REPAIR_ITERATIONS)
    better = at.cost < costs[worse]
    if not better.any():
        return step, costs
    windows = worse[better]
    take = np.zeros(len(old), dtype=bool)
    take[windows] = True
    told = _put(costs, take, at.cost[better])
    if not total_cost(problem, told, step.theta) < cost:
        return step, told
    return replace(step, initial=_put(step.initial, take, settled[better])), told


def _put(whole: Array, where: NDArray[np.bool_], values: Array) -> Array:
    """Return a copy of `whole` with `values` at the chosen rows."""
    copy = whole.copy()
    copy[where] = values
    return copy


def minimise(
    problem: FitProblem,
    theta: Array,
    initial: Array,
    *,
    iterations: int = 40,
    tolerance: float | None = None,
    settled: Linearisation | None = None,
) -> Optimum:
    """Fit the free parameters and all initial states.

    Parameters
    ----------
    theta, initial
        Where to start; values beyond their bounds, as those of a law with other ones
        may be, start at the bound.
    tolerance
        Two decreases of the cost below this share of it end the iteration, or an
        undamped step that promises next to nothing; where None, the share that
        `TOLD_STD` is worth among so many samples, and at most 1e-6.
    settled
        The linearisation there, when it is known already.
    """
    given = theta
    theta = np.clip(theta, problem.low[problem.free], problem.high[problem.free])
    if settled is None or not np.array_equal(given, theta):
        settled = linearise_windows(problem, theta, initial)
    here = settled
    cost = total_cost(problem, here.cost, theta)
    told = TOLD_STD**2 / int(problem.measured.sum())
    share = min(RELATIVE_DECREASE, told) if tolerance is None else tolerance
    damping, small, done, lost = 1e-4, 0, 0, 0
    for done in range(1, iterations + 1):
        step = next_step(problem, here, theta, initial, damping)
        near = 0.0 <= step.decrease <= EXACT * share * cost
        if near and damping <= GAUSS_NEWTON and np.isfinite(cost):
            return Optimum(theta, initial, here, cost, done, True, lost)
        # Most of the work is in the slopes, and a step that is refused needs none.
        costs = window_costs(problem, step.theta, step.initial)
        step, costs = _repair(problem, step, costs, (initial, here, cost))
        new_cost = total_cost(problem, costs, step.theta)
        if new_cost < cost:
            new = linearise_windows(problem, step.theta, step.initial)
            new_cost = total_cost(problem, new.cost, step.theta)
        if new_cost < cost:
            # The first step out of where nothing could be simulated is not a small one.
            tiny = np.isfinite(cost) and cost - new_cost <= share * cost
            small = small + 1 if tiny else 0
            theta, initial, here, cost = step.theta, step.initial, new, new_cost
            damping = max(damping / 8, 1e-12)
            if small >= 2 or cost == 0.0:
                return Optimum(theta, initial, here, cost, done, True, lost)
        else:
            lost += not np.isfinite(new_cost)
            if new_cost <= cost * (1 + 1e-9):
                small += 1
            damping *= 10
            if small >= 2 or damping > LARGEST_DAMPING:
                finite = bool(np.isfinite(cost))
                return Optimum(theta, initial, here, cost, done, finite, lost)
    return Optimum(theta, initial, here, cost, done, False, lost)
