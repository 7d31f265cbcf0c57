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
    truncated_inverse,
)
from bondgraph.fitting.steps import Step, damped, next_step, total_cost

Array = NDArray[np.float64]
RELATIVE_DECREASE = 1e-6
LARGEST_DAMPING = 1e9
SETTLED = 1e-6
WORSE = 1.01
UNFORESEEN = 1.2
GAUSS_NEWTON = 1e-3
"""Damping below which a step is the undamped one, and its promise the whole one."""

EXACT = 1e-4
"""A promise of this part of a decrease worth taking ends the iteration at once."""

TOLD_STD = 0.1
"""No step shorter than this, in standard deviations of a white fit, is worth taking."""

REPAIR_ITERATIONS = 4
ROUNDING = 1e-10
"""An initial state whose effect is this part of what it can be is not told at all.

Where dry friction sticks at once, the momentum before has no effect but rounding, and a
step worth that would be an enormous one.
"""


@dataclass(frozen=True, slots=True)
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


def settle(
    problem: FitProblem, theta: Array, initial: Array, iterations: int = 12
) -> tuple[Array, Linearisation]:
    """Fit only the initial states, each window on its own, at fixed parameters.

    Returns
    -------
    initial, linearisation
        The settled states (n_windows, nx) and the problem there, linearised in the
        initial states alone.
    """
    fixed, nothing = problem.fixed_at(theta), theta[:0]
    best = linearise_windows(fixed, nothing, initial)
    if problem.model.n_states == 0:
        return initial, best
    damping = np.full(len(best.cost), 1e-6)
    active = np.isfinite(best.cost)
    seen = _effects(best)
    for _ in range(iterations):
        told = _effects(best) > ROUNDING**2 * seen.max(axis=0)
        own = best.hessian * (told[:, :, None] & told[:, None, :])
        inverse = truncated_inverse(damped(own, damping))
        move = np.einsum("wij,wj->wi", inverse, best.slope)
        promised = np.einsum("wi,wi->w", best.slope, move)
        active &= promised > SETTLED * best.cost
        if not active.any():
            break
        trial = np.where(active[:, None], initial + move, initial)
        new = linearise_windows(fixed, nothing, trial)
        seen = np.maximum(seen, _effects(new))
        better = active & (new.cost < best.cost)
        old = np.where(better, best.cost, 0.0)
        gained = np.where(better, old - np.where(better, new.cost, 0.0), 0.0)
        initial = np.where(better[:, None], trial, initial)
        best = by_window(problem, better, new, best)
        damping = np.where(better, damping / 10, damping * 100)
        active &= (gained > SETTLED * best.cost) | (~better & (damping < 1e2))
        if not active.any():
            break
    return initial, best


def _effects(settling: Linearisation) -> Array:
    """Return the squared effect of each window's initial state on it, (n, nx)."""
    effects: Array = np.einsum("wii->wi", settling.hessian)
    return effects


def by_window(
    problem: FitProblem,
    take: NDArray[np.bool_],
    new: Linearisation,
    old: Linearisation,
) -> Linearisation:
    """Return, window by window, the new linearisation where `take`, else the old.

    Parameters
    ----------
    take
        Whether to take the new one, (n_windows,).
    """
    rows = np.repeat(take, np.diff(problem.shots.edges))
    return Linearisation(
        np.where(rows[:, None], new.residuals, old.residuals),
        np.where(take[:, None, None], new.hessian, old.hessian),
        np.where(take[:, None], new.slope, old.slope),
        np.where(take, new.cost, old.cost),
        np.where(rows[:, None], new.states, old.states),
    )


def _repair(
    problem: FitProblem,
    step: Step,
    new: Linearisation,
    before: tuple[Array, Linearisation, float],
) -> tuple[Step, Linearisation]:
    """Settle the windows that a step made worse than promised, from where they were.

    One window in which friction sticks where it slid would otherwise refuse a step that
    is right for all others. A window that ends as the linearised problem says is none
    of these, even if the others gain at its cost. Where all this does not save the
    step, only the costs of what is returned are those of the settled windows.

    Parameters
    ----------
    before
        Initial states, linearisation and whole cost where the step was taken from.
    """
    initial, here, cost = before
    old = here.cost
    worse = np.flatnonzero(
        ~(new.cost <= np.maximum(WORSE * old, UNFORESEEN * step.promised))
    )
    if len(worse) == 0 or problem.model.n_states == 0:
        return step, new
    part = replace(problem, shots=problem.shots.subset(worse))
    settled, at = settle(part, step.theta, initial[worse], REPAIR_ITERATIONS)
    better = at.cost < new.cost[worse]
    if not better.any():
        return step, new
    windows = worse[better]
    take = np.zeros(len(old), dtype=bool)
    take[windows] = True
    told = replace(new, cost=_put(new.cost, take, at.cost[better]))
    if not total_cost(problem, told, step.theta) < cost:
        return step, told
    part = replace(problem, shots=problem.shots.subset(windows))
    mended = linearise_windows(part, step.theta, settled[better])
    rows = np.repeat(take, np.diff(problem.shots.edges))
    merged = Linearisation(
        _put(new.residuals, rows, mended.residuals),
        _put(new.hessian, take, mended.hessian),
        _put(new.slope, take, mended.slope),
        _put(new.cost, take, mended.cost),
        _put(new.states, rows, mended.states),
    )
    chosen = _put(step.initial, take, settled[better])
    return replace(step, initial=chosen), merged


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
        Where to start.
    tolerance
        Two decreases of the cost below this share of it end the iteration, or an
        undamped step that promises next to nothing; where None, the share that
        `TOLD_STD` is worth among so many samples, and at most 1e-6.
    settled
        The linearisation there, when it is known already.
    """
    here = linearise_windows(problem, theta, initial) if settled is None else settled
    cost = total_cost(problem, here, theta)
    told = TOLD_STD**2 / int(problem.measured.sum())
    share = min(RELATIVE_DECREASE, told) if tolerance is None else tolerance
    damping, small, done, lost = 1e-4, 0, 0, 0
    for done in range(1, iterations + 1):
        step = next_step(problem, here, theta, initial, damping)
        near = 0.0 <= step.decrease <= EXACT * share * cost
        if near and damping <= GAUSS_NEWTON and np.isfinite(cost):
            return Optimum(theta, initial, here, cost, done, True, lost)
        new = linearise_windows(problem, step.theta, step.initial)
        step, new = _repair(problem, step, new, (initial, here, cost))
        new_cost = total_cost(problem, new, step.theta)
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
