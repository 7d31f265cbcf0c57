"""One step of a fit: the damped normal equations, within bounds.

Each window's initial state is eliminated, so that the equations are as many as the
free parameters, however many windows there are.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.problem import FitProblem, Linearisation, prior_residuals
from bondgraph.fitting.truncated_inverse import truncated_inverse

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """A step with the cost of every window, and the decrease of the sum, it promises.

    Both are those of the linearised problem.
    """

    theta: Array
    initial: Array
    promised: Array
    decrease: float


def total_cost(problem: FitProblem, costs: Array, theta: Array) -> float:
    """Return the cost of all windows and of what is known beforehand."""
    prior, _ = prior_residuals(problem, theta)
    return float(costs.sum() + prior @ prior)


def next_step(
    problem: FitProblem, at: Linearisation, theta: Array, initial: Array, damping: float
) -> Step:
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
    return Step(theta + move, initial + shift, at.cost - gained, decrease)


def _gained(at: Linearisation, move: Array, shift: Array) -> Array:
    """Return by how much a step lowers each window's cost in the linearised problem."""
    whole = np.column_stack([np.broadcast_to(move, (len(shift), len(move))), shift])
    bent = (whole[:, None, :] @ at.hessian)[:, 0, :]
    gained: Array = ((2.0 * at.slope - bent) * whole).sum(axis=1)
    return gained


@dataclass(frozen=True, slots=True, eq=False)
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
    inverse = truncated_inverse(damped(at.hessian[:, nq:, nq:], damping))
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
        if free.all():  # nearly always
            step = truncated_inverse(hessian) @ slope
        else:
            inner = hessian[np.ix_(free, free)]
            rest = slope[free] - hessian[np.ix_(free, ~free)] @ step[~free]
            step[free] = truncated_inverse(inner) @ rest
        outside = free & ((step < low) | (step > high))
        step = np.clip(step, low, high)
        if not outside.any():
            break
        free &= ~outside
    return step


def damped(hessian: Array, damping: Array | float) -> Array:
    """Return the matrices with their diagonals raised by the factor 1 + damping."""
    raised = hessian.copy()
    diagonal = np.einsum("wii->wi", raised)  # which writes into it
    diagonal += diagonal * np.reshape(damping, (-1, 1))
    return raised
