"""Damped Gauss-Newton for windowed fits, with bounds and eliminated initial states.

The damping is Marquardt's (relative to the diagonal), so the units of parameters do not
matter; bounds are kept by holding a parameter that pushes against its bound.
"""

from dataclasses import dataclass

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
RELATIVE_DECREASE = 1e-7
LARGEST_DAMPING = 1e9
SETTLED = 1e-6


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
    theta: Array
    initial: Array


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
        trial = np.where(active[:, None], initial + move, initial)
        new = linearise_windows(problem, theta, trial)
        better = active & (new.cost < best.cost)
        gained = np.where(better, best.cost - new.cost, 0.0)
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
        np.where(rows[:, None, None], new.jacobian, old.jacobian),
        np.where(take[:, None, None], new.hessian, old.hessian),
        np.where(take[:, None], new.slope, old.slope),
        np.where(take, new.cost, old.cost),
    )


def minimise(
    problem: FitProblem,
    theta: Array,
    initial: Array,
    *,
    iterations: int = 40,
    settled: Linearisation | None = None,
) -> Optimum:
    """Fit the free parameters and all initial states.

    Parameters
    ----------
    theta, initial
        Where to start.
    settled
        The linearisation there, when it is known already.
    """
    here = linearise_windows(problem, theta, initial) if settled is None else settled
    cost = _total(problem, here, theta)
    damping, small, done = 1e-4, 0, 0
    for done in range(1, iterations + 1):
        step = _step(problem, here, theta, initial, damping)
        new = linearise_windows(problem, step.theta, step.initial)
        new_cost = _total(problem, new, step.theta)
        if new_cost < cost:
            small = small + 1 if cost - new_cost <= RELATIVE_DECREASE * cost else 0
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


def _total(problem: FitProblem, at: Linearisation, theta: Array) -> float:
    prior, _ = prior_residuals(problem, theta)
    return float(at.cost.sum() + prior @ prior)


def _step(
    problem: FitProblem, at: Linearisation, theta: Array, initial: Array, damping: float
) -> _Step:
    """Solve the damped normal equations, eliminating each window's initial state."""
    nq = len(theta)
    prior, weight = prior_residuals(problem, theta)
    own = at.hessian[:, nq:, nq:]
    inverse = truncated_inverse(_damped(own, damping))
    cross = at.hessian[:, nq:, :nq]
    gain = inverse @ cross
    offset = np.einsum("wij,wj->wi", inverse, at.slope[:, nq:])
    full = at.hessian[:, :nq, :nq]
    hessian = (full - np.swapaxes(cross, 1, 2) @ gain).sum(axis=0)
    slope = (at.slope[:, :nq] - np.einsum("wij,wi->wj", cross, offset)).sum(axis=0)
    hessian += np.diag(weight**2)
    slope += weight * prior
    diagonal = np.einsum("wii->i", full)
    reduced = np.maximum(np.diag(hessian), 1e-12 * diagonal)
    hessian[np.diag_indices(nq)] += damping * reduced
    move = _bounded(problem, hessian, slope, theta)
    return _Step(theta + move, initial + offset - gain @ move)


def _bounded(problem: FitProblem, hessian: Array, slope: Array, theta: Array) -> Array:
    """Solve for a step within bounds, holding parameters that would leave them."""
    low, high = problem.low[problem.free], problem.high[problem.free]
    held = ((theta <= low) & (slope < 0)) | ((theta >= high) & (slope > 0))
    free = np.flatnonzero(~held)
    move = np.zeros(len(theta))
    if len(free):
        move[free] = truncated_inverse(hessian[np.ix_(free, free)]) @ slope[free]
    clipped: Array = np.clip(theta + move, low, high) - theta
    return clipped
