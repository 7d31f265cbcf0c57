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
    prior_residuals,
    truncated_inverse,
)

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


@dataclass(frozen=True, slots=True)
class Optimum:
    """Where the iteration ended.

    ``linearisation`` is at the optimum; ``cost`` includes the prior; ``converged`` is
    False at the iteration limit.
    """

    theta: Array
    initial: Array
    linearisation: Linearisation
    cost: float
    iterations: int
    converged: bool


@dataclass(frozen=True, slots=True)
class _Step:
    """A step with the cost of every window, and the decrease of the sum, it promises.

    Both are those of the linearised problem.
    """

    theta: Array
    initial: Array
    promised: Array
    decrease: float


def settle(
    problem: FitProblem, theta: Array, initial: Array, iterations: int = 12
) -> tuple[Array, Linearisation]:
    """Fit only the initial states, each window on its own, at fixed parameters.

    Returns
    -------
    initial, linearisation
        The settled states (n_windows, nx) and the residuals there.
    """
    best = linearise_windows(problem, theta, initial)
    if problem.model.n_states == 0:
        return initial, best
    nq = len(theta)
    damping = np.full(len(best.cost), 1e-6)
    active = np.isfinite(best.cost)
    for _ in range(iterations):
        inverse = truncated_inverse(_damped(best.hessian[:, nq:, nq:], damping))
        move = np.einsum("wij,wj->wi", inverse, best.slope[:, nq:])
        promised = np.einsum("wi,wi->w", best.slope[:, nq:], move)
        active &= promised > SETTLED * best.cost
        if not active.any():
            break
        trial = np.where(active[:, None], initial + move, initial)
        new = linearise_windows(problem, theta, trial)
        better = active & (new.cost < best.cost)
        old = np.where(better, best.cost, 0.0)
        gained = np.where(better, old - np.where(better, new.cost, 0.0), 0.0)
        initial = np.where(better[:, None], trial, initial)
        best = _choose(problem, better, new, best)
        damping = np.where(better, damping / 10, damping * 100)
        active &= (gained > SETTLED * best.cost) | (~better & (damping < 1e2))
        if not active.any():
            break
    return initial, best


def _damped(hessian: Array, damping: Array | float) -> Array:
    """Return the matrices with their diagonals raised by the factor 1 + damping."""
    diagonal = np.einsum("wii->wi", hessian) * np.reshape(damping, (-1, 1))
    raised: Array = hessian + diagonal[:, :, None] * np.eye(hessian.shape[-1])
    return raised


def _choose(
    problem: FitProblem,
    take: NDArray[np.bool_],
    new: Linearisation,
    old: Linearisation,
) -> Linearisation:
    """Return, window by window, the new linearisation where `take`, else the old."""
    rows = np.repeat(take, np.diff(problem.shots.edges))
    return Linearisation(
        np.where(rows[:, None], new.residuals, old.residuals),
        np.where(take[:, None, None], new.hessian, old.hessian),
        np.where(take[:, None], new.slope, old.slope),
        np.where(take, new.cost, old.cost),
        np.where(rows[:, None], new.states, old.states),
    )


def _repair(
    problem: FitProblem, step: _Step, new: Linearisation, initial: Array, old: Array
) -> tuple[_Step, Linearisation]:
    """Settle the windows that a step made worse than promised, from where they were.

    One window in which friction sticks where it slid would otherwise refuse a step that
    is right for all others. A window that ends as the linearised problem says is none
    of these, even if the others gain at its cost.
    """
    worse = np.flatnonzero(
        ~(new.cost <= np.maximum(WORSE * old, UNFORESEEN * step.promised))
    )
    if len(worse) == 0 or problem.model.n_states == 0:
        return step, new
    part = replace(problem, shots=problem.shots.subset(worse))
    settled, at = settle(part, step.theta, initial[worse], REPAIR_ITERATIONS)
    better = at.cost < new.cost[worse]
    windows = worse[better]
    chosen = step.initial.copy()
    chosen[windows] = settled[better]
    sizes = np.diff(problem.shots.edges)
    take = np.zeros(len(sizes), dtype=bool)
    take[windows] = True
    rows, part_rows = np.repeat(take, sizes), np.repeat(better, sizes[worse])
    merged = Linearisation(
        _put(new.residuals, rows, at.residuals[part_rows]),
        _put(new.hessian, take, at.hessian[better]),
        _put(new.slope, take, at.slope[better]),
        _put(new.cost, take, at.cost[better]),
        _put(new.states, rows, at.states[part_rows]),
    )
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
    damping, small, done = 1e-4, 0, 0
    for done in range(1, iterations + 1):
        step = _step(problem, here, theta, initial, damping)
        near = 0.0 <= step.decrease <= EXACT * share * cost
        if near and damping <= GAUSS_NEWTON and np.isfinite(cost):
            return Optimum(theta, initial, here, cost, done, converged=True)
        new = linearise_windows(problem, step.theta, step.initial)
        step, new = _repair(problem, step, new, initial, here.cost)
        new_cost = total_cost(problem, new, step.theta)
        if new_cost < cost:
            # The first step out of where nothing could be simulated is not a small one.
            tiny = np.isfinite(cost) and cost - new_cost <= share * cost
            small = small + 1 if tiny else 0
            theta, initial, here, cost = step.theta, step.initial, new, new_cost
            damping = max(damping / 8, 1e-12)
            if small >= 2 or cost == 0.0:
                return Optimum(theta, initial, here, cost, done, converged=True)
        else:
            if new_cost <= cost * (1 + 1e-9):
                small += 1
            damping *= 10
            if small >= 2 or damping > LARGEST_DAMPING:
                finite = bool(np.isfinite(cost))
                return Optimum(theta, initial, here, cost, done, converged=finite)
    return Optimum(theta, initial, here, cost, done, converged=False)


def total_cost(problem: FitProblem, at: Linearisation, theta: Array) -> float:
    """Return the cost of all windows and of what is known beforehand."""
    prior, _ = prior_residuals(problem, theta)
    return float(at.cost.sum() + prior @ prior)


def _step(
    problem: FitProblem, at: Linearisation, theta: Array, initial: Array, damping: float
) -> _Step:
    """Solve the damped normal equations, eliminating each window's initial state."""
    normal = _reduced(problem, at, theta, damping)
    reduced = np.maximum(np.diag(normal.hessian), 1e-12 * normal.diagonal)
    hessian = normal.hessian + damping * np.diag(reduced)
    move = _bounded(problem, hessian, normal.slope, theta)
    shift = normal.offset - normal.gain @ move
    gained = _gained(at, move, shift)
    before, _ = prior_residuals(problem, theta)
    after, _ = prior_residuals(problem, theta + move)
    decrease = float(gained.sum() + before @ before - after @ after)
    return _Step(theta + move, initial + shift, at.cost - gained, decrease)


def _gained(at: Linearisation, move: Array, shift: Array) -> Array:
    """Return by how much a step lowers each window's cost in the linearised problem."""
    whole = np.column_stack([np.broadcast_to(move, (len(shift), len(move))), shift])
    curved = np.einsum("wi,wij,wj->w", whole, at.hessian, whole)
    gained: Array = 2.0 * (at.slope * whole).sum(axis=1) - curved
    return gained


@dataclass(frozen=True, slots=True)
class _Normal:
    """Normal equations of θ, and how each window's initial state follows a step."""

    hessian: Array
    slope: Array
    diagonal: Array
    gain: Array
    offset: Array


def _reduced(
    problem: FitProblem, at: Linearisation, theta: Array, damping: float
) -> _Normal:
    """Eliminate every window's initial state (Schur complement)."""
    nq = len(theta)
    prior, weight = prior_residuals(problem, theta)
    inverse = truncated_inverse(_damped(at.hessian[:, nq:, nq:], damping))
    cross = at.hessian[:, nq:, :nq]
    gain = inverse @ cross
    offset = np.einsum("wij,wj->wi", inverse, at.slope[:, nq:])
    full = at.hessian[:, :nq, :nq]
    hessian = (full - np.swapaxes(cross, 1, 2) @ gain).sum(axis=0)
    slope = (at.slope[:, :nq] - np.einsum("wij,wi->wj", cross, offset)).sum(axis=0)
    return _Normal(
        hessian + np.diag(weight**2),
        slope + weight * prior,
        np.einsum("wii->i", full),
        gain,
        offset,
    )


def promised_reduction(problem: FitProblem, theta: Array, initial: Array) -> float:
    """Return the relative decrease of the cost that the linearised problem promises.

    One simulation; what a score test would use. Negative where it cannot be simulated.
    """
    at = linearise_windows(problem, theta, initial)
    cost = total_cost(problem, at, theta)
    if not np.isfinite(cost) or cost <= 0.0:
        return -1.0
    normal = _reduced(problem, at, theta, 1e-9)
    move = _bounded(problem, normal.hessian, normal.slope, theta)
    own = float((at.slope[:, len(theta) :] * normal.offset).sum())
    gained = 2 * normal.slope @ move - move @ normal.hessian @ move + own
    return float(gained / cost)


def _bounded(problem: FitProblem, hessian: Array, slope: Array, theta: Array) -> Array:
    """Solve for a step within bounds, holding parameters that would leave them."""
    low, high = problem.low[problem.free], problem.high[problem.free]
    held = ((theta <= low) & (slope < 0)) | ((theta >= high) & (slope > 0))
    return bounded_step(hessian, slope, low - theta, high - theta, held)


def bounded_step(
    hessian: Array,
    slope: Array,
    low: Array,
    high: Array,
    held: NDArray[np.bool_] | None = None,
) -> Array:
    """Return the step to the least of a quadratic form, within bounds.

    What would leave its bounds is held there and the rest solved for anew: a direction
    that hardly matters would else carry everything away with the one that is clipped.

    Parameters
    ----------
    low, high
        Of the step.
    held
        What does not move at all.
    """
    step = np.zeros(len(slope))
    free = np.ones(len(slope), dtype=bool) if held is None else ~held
    while free.any():
        inner = hessian[np.ix_(free, free)]
        rest = slope[free] - hessian[np.ix_(free, ~free)] @ step[~free]
        step[free] = truncated_inverse(inner) @ rest
        outside = free & ((step < low) | (step > high))
        step = np.clip(step, low, high)
        if not outside.any():
            break
        free &= ~outside
    return step
