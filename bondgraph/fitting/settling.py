"""Initial states settled at fixed parameters, every window on its own.

Only the slopes along the states are simulated, so it costs far less than a step of the
whole fit where many parameters are free.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.problem import (
    FitProblem,
    Linearisation,
    linearise_windows,
    write_windows,
)
from bondgraph.fitting.steps import damped
from bondgraph.fitting.truncated_inverse import truncated_inverse

Array = NDArray[np.float64]
SETTLED = 1e-6
"""A window that promises or gains less than this share of its cost is settled."""

ROUNDING = 1e-10
"""An initial state whose effect is this part of what it can be is not told at all.

Where dry friction sticks at once, the momentum before has no effect but rounding, and a
step worth that would be an enormous one.
"""


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
    initial = initial.copy()
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
        at = np.flatnonzero(active)
        if not at.size:
            break
        trial = initial[at] + move[at]
        new = linearise_windows(_of_windows(fixed, at), nothing, trial)
        seen[at] = np.maximum(seen[at], _effects(new))
        better, old = new.cost < best.cost[at], best.cost[at]
        gained = np.where(better, old - np.where(better, new.cost, 0.0), 0.0)
        initial[at[better]] = trial[better]
        write_windows(best, problem.shots.edges, at, new, better)
        damping[at] = np.where(better, damping[at] / 10, damping[at] * 100)
        active[at] = (gained > SETTLED * best.cost[at]) | (
            ~better & (damping[at] < 1e2)
        )
        if not active.any():
            break
    return initial, best


def _of_windows(problem: FitProblem, at: NDArray[np.int64]) -> FitProblem:
    """Return the problem of those windows that are not settled yet."""
    shots = problem.shots
    if len(at) == shots.n_windows:
        return problem
    return replace(problem, shots=shots.subset(at))


def _effects(settling: Linearisation) -> Array:
    """Return the squared effect of each window's initial state on it, (n, nx)."""
    effects: Array = np.einsum("wii->wi", settling.hessian)
    return effects
