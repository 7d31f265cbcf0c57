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

    @property
    def measured(self) -> NDArray[np.int64]:
        """How many samples of each output were measured; at least one."""
        count: NDArray[np.int64] = np.isfinite(self.shots.outputs).sum(axis=0)
        return np.maximum(count, 1)

    def with_parameters(self, theta: Array) -> Array:
        """Return all parameter values with the free ones set to `theta`."""
        values = self.start.copy()
        values[self.free] = theta
        return values


@dataclass(frozen=True, slots=True)
class Linearisation:
    """Residuals and the derivatives of the simulation at one point.

    Parameters
    ----------
    residuals, jacobian
        Scaled; (n, ny) and (n, ny, nq + nx), zero where nothing was measured. The
        derivatives are those of the *simulation*, so a step solves ``J step = r``.
    hessian, slope, cost
        JᵀJ, Jᵀr and rᵀr per window; the cost is inf where the simulation failed.
    states
        Simulated states, (n, nx).
    """

    residuals: Array
    jacobian: Array
    hessian: Array
    slope: Array
    cost: Array
    states: Array


def linearise_windows(
    problem: FitProblem, theta: Array, initial: Array
) -> Linearisation:
    """Simulate all windows with sensitivities and form the weighted residuals."""
    from bondgraph.numeric.kernel import normal_blocks  # noqa: PLC0415  (loads numba)

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
    measured = np.isfinite(shots.outputs)
    error = (shots.outputs - shot.outputs) / problem.sigma
    residuals = np.where(measured, error, 0.0)
    jacobian = shot.sensitivities / problem.sigma[:, None]
    if not measured.all():
        jacobian = np.where(measured[..., None], jacobian, 0.0)
    windows, nd = shots.n_windows, jacobian.shape[2]
    hessian, slope = np.zeros((windows, nd, nd)), np.zeros((windows, nd))
    cost = np.zeros(windows)
    edges = np.array(shots.edges, dtype=np.int64)
    normal_blocks(jacobian, residuals, edges, hessian, slope, cost)
    fine = shot.completed & np.isfinite(cost) & np.isfinite(hessian).all(axis=(1, 2))
    return Linearisation(
        residuals,
        jacobian,
        hessian,
        slope,
        np.where(fine, cost, np.inf),
        shot.states,
    )


def prior_residuals(problem: FitProblem, theta: Array) -> tuple[Array, Array]:
    """Return the residuals of the prior knowledge and their weights 1/std."""
    weight = 1.0 / problem.prior_std[problem.free]
    return (problem.start[problem.free] - theta) * weight, weight


def truncated_inverse(matrix: Array, tolerance: float = 1e-13) -> Array:
    """Return the pseudo-inverse of symmetric matrices (…, n, n), diagonals scaled.

    Directions whose scaled eigenvalue is below `tolerance` of the largest are left out,
    so that what the data do not determine is not moved.
    """
    if matrix.shape[-1] == 0:
        return matrix
    diagonal = np.einsum("...ii->...i", matrix)
    scale = np.sqrt(np.maximum(diagonal, 0.0))
    scale = np.where(scale == 0.0, 1.0, scale)
    outer = scale[..., :, None] * scale[..., None, :]
    values, vectors = np.linalg.eigh(matrix / outer)
    keep = values > tolerance * np.maximum(values[..., -1:], 1e-300)
    inverse_values = np.where(keep, 1.0 / np.where(keep, values, 1.0), 0.0)
    inverse = (vectors * inverse_values[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    result: Array = inverse / outer
    return result
