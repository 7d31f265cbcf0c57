"""Initial states settled at fixed parameters, every window on its own.

Only the slopes along the states are simulated, so it costs far less than a step of the
whole fit where many parameters are free.
"""

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.problem import (
    FitProblem,
    Linearisation,
    linearise_windows,
    truncated_inverse,
)
from bondgraph.fitting.steps import damped

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
