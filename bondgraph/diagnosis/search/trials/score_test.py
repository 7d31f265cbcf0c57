"""What added parameters promise: the score test, from one simulation.

At an optimum of the base model, with the added strengths zero, the linearised problem
tells by how much the error would fall if they were freed and everything else, initial
states included, were fitted anew: g' S⁻¹ g, where g is the slope of the error in the
added parameters and S their curvature once all others have been projected out (Rao,
Proceedings of the Cambridge Philosophical Society 44, 1948).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.base.steps import OF_CANDIDATE
from bondgraph.diagnosis.search.trials.surrogates import (
    Baseline,
    orthonormal,
    sensitivities,
)
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.steps import bounded_step
from bondgraph.simulation.solvers import Sdirk2

Array = NDArray[np.float64]
OWN = 1e-5
"""What is left of a parameter's effect beside the base model's own; less is nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Score:
    """The share of the error that is promised, and of each surrogate."""

    promised: float
    by_chance: Array


def score_test(
    baseline: Baseline,
    problem: FitProblem,
    theta: Array,
    initial: Array,
    added: NDArray[np.bool_],
) -> Score:
    """Return what the added parameters promise, and what they seem to by chance.

    Parameters
    ----------
    theta, initial
        The base model's optimum, with the added parameters where they have no effect.
    added
        Which of the free parameters are added; steps of these stay within bounds.
    """
    about = problem.free[added]
    jacobian, residuals = sensitivities(problem, theta, initial, about)
    if not _silent(baseline, residuals):
        # What has no effect but can be stiff needs the implicit method.
        implicit = replace(problem, solver=Sdirk2())
        jacobian, _ = sensitivities(implicit, theta, initial, about)
    whole = jacobian.reshape(-1, int(added.sum()))
    low = (problem.low[problem.free] - theta)[added]
    high = (problem.high[problem.free] - theta)[added]
    if not np.isfinite(whole).all():
        return Score(-np.inf, np.zeros(baseline.draws.shape[1]))
    columns = baseline.project(whole)
    there = np.linalg.norm(columns, axis=0) > OWN * np.linalg.norm(whole, axis=0)
    columns, low, high = columns[:, there], low[there], high[there]
    residual = baseline.residual
    step = bounded_step(columns.T @ columns, columns.T @ residual, low, high)
    left = residual - columns @ step
    power = max(float(residual @ residual), 1e-300)
    return Score(
        1.0 - float(left @ left) / power, _chance(baseline, columns, low, high)
    )


def _silent(baseline: Baseline, residuals: Array) -> bool:
    """Return whether an addition without effect leaves the base model's residual."""
    own = baseline.residuals
    change = np.linalg.norm(residuals - own, axis=0)
    return bool(np.all(change <= OF_CANDIDATE * np.linalg.norm(own, axis=0)))


def _chance(baseline: Baseline, columns: Array, low: Array, high: Array) -> Array:
    """Return the share of every surrogate that the columns explain.

    A single parameter at its bound may go one way only.
    """
    basis = orthonormal(columns)
    along = basis.T.astype(np.float32) @ baseline.draws
    if basis.shape[1] == 1 and columns.shape[1] == 1:
        along = along * np.sign(basis[:, 0] @ columns[:, 0])
        along = np.clip(along, -np.inf if low[0] < 0.0 else 0.0, None)
        along = np.clip(along, None, np.inf if high[0] > 0.0 else 0.0)
    shares: Array = (along.astype(np.float64) ** 2).sum(axis=0)
    return shares
