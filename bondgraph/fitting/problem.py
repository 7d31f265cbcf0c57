"""The least-squares problem of a simulation-error fit, with its bordered structure.

Unknowns are the free parameters θ, shared by all windows, and one initial state per
window, which only its own window sees. The residuals are

    r = (measured - simulated) / σ        per sample and output,
    (θ_0 - θ) / std                       for parameters that are known to ± std.

Each window's initial state is eliminated from the normal equations (Schur complement),
so the cost is linear in the number of windows.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.model import NumericModel
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Solver

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class FitProblem:
    """Everything a fit is made of; arrays in the model's parameter order.

    Parameters
    ----------
    start
        Values of all parameters; those not in `free` stay.
    free
        Indices of the fitted parameters.
    low, high
        Bounds of all parameters.
    prior_std
        Standard deviation of what is known beforehand; inf where nothing is.
    sigma
        Residual scale per output.
    """

    model: NumericModel
    shots: Shots
    start: Array
    free: NDArray[np.int64]
    low: Array
    high: Array
    prior_std: Array
    sigma: Array
    solver: Solver
    hold: Hold

    def with_parameters(self, theta: Array) -> Array:
        """Return all parameter values with the free ones set to `theta`."""
        values = self.start.copy()
        values[self.free] = theta
        return values


@dataclass(frozen=True, slots=True)
class Linearisation:
    """Residuals and their derivatives at one point; one entry per window.

    ``cost`` is the sum of squared residuals per window (inf where the simulation
    failed); ``parameters`` and ``initial`` are the derivatives of the *simulation*
    (so a step solves ``J step = r``), flattened over samples and outputs.
    """

    residuals: tuple[Array, ...]
    parameters: tuple[Array, ...]
    initial: tuple[Array, ...]
    cost: Array


def linearise_windows(
    problem: FitProblem, theta: Array, initial: Array
) -> Linearisation:
    """Simulate all windows with sensitivities and form the weighted residuals."""
    shots, model = problem.shots, problem.model
    shot = shoot(
        model,
        shots,
        parameters=problem.with_parameters(theta),
        initial=initial,
        directions=problem.free,
        solver=problem.solver,
        hold=problem.hold,
    )
    nq = len(problem.free)
    error = (shots.outputs - shot.outputs) / problem.sigma
    measured = np.isfinite(shots.outputs)
    error = np.where(measured, error, 0.0)
    slopes = shot.sensitivities / problem.sigma[:, None]
    slopes = np.where(measured[..., None], slopes, 0.0)
    cost = np.empty(shots.n_windows)
    residuals, by_parameter, by_initial = [], [], []
    for window, part in enumerate(shots.slices):
        r = error[part].ravel()
        jacobian = slopes[part].reshape(r.size, -1)
        fine = shot.completed[window] and bool(np.isfinite(r).all())
        fine = fine and bool(np.isfinite(jacobian).all())
        cost[window] = r @ r if fine else np.inf
        residuals.append(r)
        by_parameter.append(jacobian[:, :nq])
        by_initial.append(jacobian[:, nq:])
    return Linearisation(tuple(residuals), tuple(by_parameter), tuple(by_initial), cost)


def prior_residuals(problem: FitProblem, theta: Array) -> tuple[Array, Array]:
    """Return the residuals of the prior knowledge and their weights 1/std."""
    weight = 1.0 / problem.prior_std[problem.free]
    return (problem.start[problem.free] - theta) * weight, weight


def truncated_inverse(matrix: Array, tolerance: float = 1e-13) -> Array:
    """Return the pseudo-inverse of a symmetric matrix after scaling its diagonal.

    Directions whose scaled eigenvalue is below `tolerance` of the largest are left out,
    so that what the data do not determine is not moved.
    """
    scale = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    scale[scale == 0.0] = 1.0
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    keep = values > tolerance * max(values[-1], 1e-300) if len(values) else values > 0
    inverse = (vectors[:, keep] / values[keep]) @ vectors[:, keep].T
    result: Array = inverse / np.outer(scale, scale)
    return result
