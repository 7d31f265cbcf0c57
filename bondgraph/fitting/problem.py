"""The least-squares problem of a simulation-error fit, with its bordered structure.

Unknowns are the free parameters θ, shared by all windows, and one initial state per
window, which only its own window sees. The residuals are

    r = (measured - simulated) / σ        per sample and output,
    (θ_0 - θ) / std                       for parameters that are known to ± std.

Each window's initial state is eliminated from the normal equations (Schur complement),
so the cost is linear in the number of windows.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.loss import Loss, SquaredError, cost_of, weight_of
from bondgraph.fitting.noise import whitened
from bondgraph.fitting.overflow import without_overflow
from bondgraph.fitting.truncated_inverse import truncated_inverse
from bondgraph.numeric.model import NumericModel
from bondgraph.simulation.engines import PAYING, Engine
from bondgraph.simulation.shooting import Shooting, Shots, shoot
from bondgraph.simulation.solvers import Hold, Solver

Array = NDArray[np.float64]
PART_NUMBERS = 4_000_000
"""Sensitivities held at a time: 32 megabytes, and as much again while they are used."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
    loss
        What a scaled residual costs.
    correlation
        φ per output of first-order coloured noise; zeros for white noise.
    engine
        How the equations are evaluated, a matter of time only.
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
    loss: Loss = field(default_factory=SquaredError)
    correlation: Array = field(default_factory=lambda: np.zeros(1))
    engine: Engine = PAYING

    @property
    def free_names(self) -> list[str]:
        """The names of the fitted parameters, in the order of their values."""
        return [self.model.parameter_names[i] for i in self.free]

    @property
    def measured(self) -> NDArray[np.int64]:
        """How many samples of each output were measured; at least one."""
        count: NDArray[np.int64] = self.shots.known.sum(axis=0)
        return np.maximum(count, 1)

    @property
    def unknowns(self) -> int:
        """How many numbers it fits: parameters, and where every window begins."""
        return len(self.free) + self.shots.n_windows * self.model.n_states

    def with_parameters(self, theta: Array) -> Array:
        """Return all parameter values with the free ones set to `theta`."""
        # A start given in whole numbers must not round what is fitted.
        values = self.start.astype(np.float64)
        values[self.free] = theta
        return values

    def fixed_at(self, theta: Array) -> "FitProblem":
        """Return the problem of the initial states alone, no parameter left free."""
        nothing = np.zeros(0, dtype=np.int64)
        return replace(self, start=self.with_parameters(theta), free=nothing)


@dataclass(frozen=True, slots=True, eq=False)
class Linearisation:
    """Residuals and the normal equations of the simulation at one point.

    Parameters
    ----------
    residuals
        Measured minus simulated over σ, (n, ny); zero where nothing was measured, nan
        in a window that could not be simulated.
    hessian, slope, cost
        JᵀWJ, JᵀWr and Σρ per window, of whitened residuals with the loss's weights; J
        is the derivative of the *simulation*, so a step solves ``JᵀWJ step = JᵀWr``.
        The cost is inf where the simulation failed.
    states
        Simulated states, (n, nx).
    """

    residuals: Array
    hessian: Array
    slope: Array
    cost: Array
    states: Array


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A run of windows, simulated with sensitivities.

    Parameters
    ----------
    windows, rows
        Which windows, and their samples.
    residuals
        Scaled, not whitened; (m, ny); nan in a window that could not be simulated.
    errors, jacobian
        Scaled and whitened, (m, ny) and (m, ny, nq + nx), or one
        column for each parameter asked about; zero where not measured and
        in a window that could not be simulated.
    """

    windows: slice
    rows: slice
    shots: Shots
    shot: Shooting
    residuals: Array
    errors: Array
    jacobian: Array


def parts(
    problem: FitProblem,
    theta: Array,
    initial: Array,
    about: NDArray[np.int64] | None = None,
) -> Iterator[Part]:
    """Yield all windows, simulated, so many at a time that memory stays small.

    The sensitivities of a million samples are never held together.

    Parameters
    ----------
    about
        Parameters, by index, to which alone sensitivities are wanted; by default all
        free ones and the initial states.
    """
    shots = problem.shots
    nd = len(problem.free) + problem.model.n_states
    most = max(PART_NUMBERS // max(nd * len(problem.sigma), 1), 1)
    edges, first = shots.edge_array, 0
    while first < shots.n_windows:
        last = int(np.searchsorted(edges, edges[first] + most, side="right")) - 1
        last = min(max(last, first + 1), shots.n_windows)
        yield _part(problem, theta, initial, slice(first, last), about)
        first = last


def _part(
    problem: FitProblem,
    theta: Array,
    initial: Array,
    windows: slice,
    about: NDArray[np.int64] | None,
) -> Part:
    shots, rows = _windows_of(problem.shots, windows)
    shot = shoot(
        problem.model,
        shots,
        parameters=problem.with_parameters(theta),
        initial=initial[windows],
        directions=problem.free if about is None else about,
        solver=problem.solver,
        hold=problem.hold,
        engine=problem.engine,
        of_initial=about is None,
        reasons=False,
    )
    shot = without_overflow(shot, shots.edges)
    known = shots.known
    measured = known
    if not shot.completed.all():
        measured = known & np.repeat(shot.completed, shots.lengths)[:, None]
    residuals = (shots.outputs - shot.outputs) / problem.sigma
    jacobian = shot.sensitivities / problem.sigma[:, None]
    errors = residuals
    if not measured.all():
        errors = np.where(measured, residuals, 0.0)
        residuals = np.where(known, residuals, 0.0)
        jacobian = np.where(measured[..., None], jacobian, 0.0)
    phi = problem.correlation
    return Part(
        windows,
        rows,
        shots,
        shot,
        residuals,
        whitened(errors, phi, shots.edges, measured),
        whitened(jacobian, phi, shots.edges, measured),
    )


def _windows_of(shots: Shots, windows: slice) -> tuple[Shots, slice]:
    """Return a run of the windows and their rows; nearly always all there are."""
    edges = shots.edges[windows.start : windows.stop + 1]
    rows = slice(edges[0], edges[-1])
    if len(edges) == len(shots.edges):
        return shots, rows
    begun = tuple(edge - edges[0] for edge in edges)
    cut = (shots.time[rows], shots.inputs[rows], shots.outputs[rows])
    return Shots(*cut, begun), rows


def linearise_windows(
    problem: FitProblem, theta: Array, initial: Array
) -> Linearisation:
    """Simulate all windows with sensitivities and form the normal equations."""
    from bondgraph.numeric.compiled.normal_equations import (  # noqa: PLC0415  (numba)
        normal_blocks,
    )

    shots, model = problem.shots, problem.model
    count, nd = shots.n_windows, len(problem.free) + model.n_states
    residuals, states = [], []
    hessian, slope = np.zeros((count, nd, nd)), np.zeros((count, nd))
    cost = np.zeros(count)
    for part in parts(problem, theta, initial):
        at = part.windows
        residuals.append(part.residuals)
        states.append(part.shot.states)
        errors, jacobian = part.errors, part.jacobian
        if not isinstance(problem.loss, SquaredError):
            root = np.sqrt(weight_of(problem.loss, errors**2))
            errors, jacobian = errors * root, jacobian * root[..., None]
        edges = part.shots.edge_array
        normal_blocks(jacobian, errors, edges, hessian[at], slope[at], cost[at])
        if not isinstance(problem.loss, SquaredError):
            own = cost_of(problem.loss, part.errors**2).sum(axis=1)
            cost[at] = np.add.reduceat(own, edges[:-1])
        cost[at] = np.where(part.shot.completed, cost[at], np.inf)
    fine = np.isfinite(cost) & np.isfinite(hessian).all(axis=(1, 2))
    hessian[~fine], slope[~fine], cost[~fine] = 0.0, 0.0, np.inf
    return Linearisation(_joined(residuals), hessian, slope, cost, _joined(states))


def _joined(parts: Sequence[Array]) -> Array:
    """Return the rows of all parts; nearly always there is one."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def window_costs(problem: FitProblem, theta: Array, initial: Array) -> Array:
    """Simulate all windows without sensitivities and return what each costs.

    The same as the cost of `linearise_windows`, for a fraction of the work; inf where a
    window could not be simulated.
    """
    found = np.zeros(problem.shots.n_windows)
    for part in parts(problem, theta, initial, np.zeros(0, dtype=np.int64)):
        each = cost_of(problem.loss, part.errors**2).sum(axis=1)
        summed = np.add.reduceat(each, part.shots.edge_array[:-1])
        found[part.windows] = np.where(part.shot.completed, summed, np.inf)
    return np.where(np.isfinite(found), found, np.inf)


def write_windows(
    into: Linearisation,
    edges: Sequence[int],
    at: NDArray[np.int64],
    new: Linearisation,
    better: NDArray[np.bool_],
) -> None:
    """Write windows of a new linearisation over those of an old one, in place.

    Parameters
    ----------
    edges
        Of all windows of the old one.
    at
        Which of these the new one consists of, in rising order.
    better
        Which of those are written, (n_windows of the new one,).
    """
    lengths = np.diff(edges)
    written = np.zeros(len(lengths), dtype=bool)
    written[at[better]] = True
    here, there = np.repeat(written, lengths), np.repeat(better, lengths[at])
    into.residuals[here], into.states[here] = new.residuals[there], new.states[there]
    into.hessian[written], into.slope[written] = new.hessian[better], new.slope[better]
    into.cost[written] = new.cost[better]


def reduced_hessian(at: Linearisation, n_parameters: int) -> Array:
    """Return the Hessian of the data in θ, every window's initial state left free."""
    nq = n_parameters
    cross = at.hessian[:, nq:, :nq]
    gain = truncated_inverse(at.hessian[:, nq:, nq:]) @ cross
    hessian: Array = (at.hessian[:, :nq, :nq] - np.swapaxes(cross, 1, 2) @ gain).sum(
        axis=0
    )
    return hessian


def prior_residuals(problem: FitProblem, theta: Array) -> tuple[Array, Array]:
    """Return the residuals of the prior knowledge and their weights 1/std."""
    weight = 1.0 / problem.prior_std[problem.free]
    return (problem.start[problem.free] - theta) * weight, weight
