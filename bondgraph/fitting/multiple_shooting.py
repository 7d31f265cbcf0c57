"""Multiple shooting: windows from states of their own, drawn together into one run.

The unknowns are θ and the state x_w at the start of every window. With e_w(x_w, θ) the
simulated state at its end, the rounds minimise

    Σ r² + μ Σ_w |(e_w - x_{w+1}) / s|²

by damped Gauss-Newton while μ rises until the gaps are closed (H. G. Bock and K. J.
Plitt, IFAC World Congress 1984). Each gap joins two neighbours only, so the normal
equations are sparse: a border for θ and a band for the states. What is returned is a
start for the fit of the whole, in which nothing is left of the penalty.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.first_states import first_guess
from bondgraph.fitting.growing import cut_finer, held_weakly
from bondgraph.fitting.problem import FitProblem, parts, prior_residuals
from bondgraph.fitting.settling import settle
from bondgraph.fitting.strategy import MultipleShooting
from bondgraph.numeric.states_read import with_states_read
from bondgraph.simulation.shooting import Shots

Array = NDArray[np.float64]
FIRST_PENALTY, LAST_PENALTY = 1.0, 1e12
DESCENTS = 3
ATTEMPTS = 6
SETTLES = 20


@dataclass(frozen=True, slots=True, eq=False)
class _Point:
    """θ and states, with the normal equations of data and gaps there.

    ``hessian``, ``slope`` and ``cost`` per window are those of the data; ``gap`` is
    (e_w - x_{w+1}) / s and ``ends`` its derivative along (θ, x_w), zero where window w
    is the last of its recording.
    """

    theta: Array
    states: Array
    hessian: Array
    slope: Array
    cost: float
    gap: Array
    ends: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Joined:
    """The problem cut into windows that share their border samples."""

    problem: FitProblem
    scale: Array
    follows: NDArray[np.bool_]


def shoot_multiply(
    problem: FitProblem, theta: Array, strategy: MultipleShooting
) -> tuple[Array, Array]:
    """Return parameters and initial states of `problem` near its optimum."""
    longest = int(problem.shots.lengths.max())
    short = cut_finer(problem.shots, max(longest // strategy.windows, 2))
    cut = held_weakly(replace(problem, shots=short), theta)
    origin = np.zeros((short.n_windows, problem.model.n_states))
    if problem.model.set_valued is not None:
        origin = first_guess(cut, theta)
    states, at = settle(cut, theta, origin, SETTLES)
    scale = np.std(at.states, axis=0)
    joined = _join(cut, problem.shots, np.where(scale > 0.0, scale, 1.0))
    here = _point(joined, theta, states)
    penalty = FIRST_PENALTY
    while penalty <= LAST_PENALTY:
        here = _descend(joined, here, penalty)
        weighed = _weighed(joined, here)
        joined, here = weighed, _point(weighed, here.theta, here.states)
        penalty *= strategy.rise
    begins = np.searchsorted(short.edge_array, problem.shots.edge_array[:-1])
    return here.theta, here.states[begins]


def _join(cut: FitProblem, whole: Shots, scale: Array) -> _Joined:
    """Let every window but the last of a recording end where the next begins."""
    shots = cut.shots
    last = set(whole.edges)
    follows = np.array([stop not in last for stop in shots.edges[1:]])
    rows = [
        np.arange(a, b + int(more))
        for (a, b), more in zip(pairwise(shots.edges), follows, strict=True)
    ]
    index = np.concatenate(rows)
    edges = np.cumsum([0, *map(len, rows)])
    nx = cut.model.n_states
    outputs = np.column_stack([shots.outputs[index], np.zeros((len(index), nx))])
    # The shared sample is data of the window that it begins.
    outputs[edges[1:][follows] - 1, : shots.outputs.shape[1]] = np.nan
    longer = Shots(
        shots.time[index],
        shots.inputs[index],
        outputs,
        tuple(int(edge) for edge in edges),
    )
    read = with_states_read(cut.model)
    sigma = np.concatenate([cut.sigma, scale])
    phi = np.zeros(len(sigma))
    problem = replace(cut, model=read, shots=longer, sigma=sigma, correlation=phi)
    return _Joined(problem, scale, follows)


def _weighed(joined: _Joined, here: _Point) -> _Joined:
    """Return the problem with each output weighed by its residual."""
    problem, ny = joined.problem, len(joined.problem.sigma) - len(joined.scale)
    squared, count = np.zeros(ny), np.zeros(ny)
    for part in parts(problem, here.theta, here.states):
        squared += (part.residuals[:, :ny] ** 2).sum(axis=0)
        count += np.isfinite(part.shots.outputs[:, :ny]).sum(axis=0)
    size = np.sqrt(squared / np.maximum(count, 1))
    sigma = problem.sigma.copy()
    sigma[:ny] *= np.where(np.isfinite(size) & (size > 0.0), size, 1.0)
    return replace(joined, problem=replace(problem, sigma=sigma))


def _point(joined: _Joined, theta: Array, states: Array) -> _Point:
    """Simulate all windows and form the normal equations and the gaps."""
    from bondgraph.numeric.compiled.normal_equations import (  # noqa: PLC0415  (numba)
        normal_blocks,
    )

    problem, nx = joined.problem, len(joined.scale)
    ny = len(problem.sigma) - nx
    count, nd = problem.shots.n_windows, len(theta) + nx
    hessian, slope = np.zeros((count, nd, nd)), np.zeros((count, nd))
    cost, gap, ends = np.zeros(count), np.zeros((count, nx)), np.zeros((count, nx, nd))
    for part in parts(problem, theta, states):
        at, edges = part.windows, part.shots.edge_array
        own = np.ascontiguousarray(part.jacobian[:, :ny])
        errors = np.ascontiguousarray(part.errors[:, :ny])
        normal_blocks(own, errors, edges, hessian[at], slope[at], cost[at])
        # Measured as zero: what is simulated, over its scale, is minus the residual.
        gap[at] = -part.residuals[edges[1:] - 1, ny:]
        ends[at] = part.jacobian[edges[1:] - 1, ny:]
        cost[at] = np.where(part.shot.completed, cost[at], np.inf)
    gap[:-1] -= states[1:] / joined.scale
    gap[~joined.follows] = 0.0
    ends[~joined.follows] = 0.0
    return _Point(theta, states, hessian, slope, float(cost.sum()), gap, ends)


def _merit(problem: FitProblem, here: _Point, penalty: float) -> float:
    prior, _ = prior_residuals(problem, here.theta)
    return here.cost + penalty * float((here.gap**2).sum()) + float(prior @ prior)


def _descend(joined: _Joined, here: _Point, penalty: float) -> _Point:
    """Take a few damped Gauss-Newton steps at one penalty."""
    damping = 1e-3
    merit = _merit(joined.problem, here, penalty)
    for _ in range(DESCENTS):
        for _ in range(ATTEMPTS):
            trial = _step(joined, here, penalty, damping)
            new = _merit(joined.problem, trial, penalty)
            if new < merit:
                break
            damping *= 10.0
        else:
            return here
        here, merit, damping = trial, new, damping / 10.0
    return here


def _step(joined: _Joined, here: _Point, penalty: float, damping: float) -> _Point:
    """Solve the sparse damped normal equations."""
    from scipy.sparse import csc_array, diags_array  # noqa: PLC0415
    from scipy.sparse.linalg import spsolve  # noqa: PLC0415  (slow to import)

    problem, nq = joined.problem, len(here.theta)
    count, nx = here.states.shape
    prior, weight = prior_residuals(problem, here.theta)
    own = np.arange(nq + nx)
    columns = own + np.where(own < nq, 0, nx * np.arange(count)[:, None])
    # A gap depends on θ, on its window's state and, by minus one, on the next one's.
    next_state = np.broadcast_to(-np.diag(1.0 / joined.scale), (count, nx, nx))
    slopes = np.concatenate([here.ends, next_state], axis=2)
    slopes = slopes * joined.follows[:, None, None]
    following = nq + nx * (np.arange(count)[:, None] + 1) + np.arange(nx)
    reach = np.concatenate(
        [columns, np.minimum(following, nq + count * nx - 1)], axis=1
    )
    squared = penalty * np.swapaxes(slopes, 1, 2) @ slopes
    size = nq + count * nx
    hessian = _scattered(columns, here.hessian, size) + _scattered(reach, squared, size)
    slope = np.zeros(size)
    np.add.at(slope, columns, here.slope)
    np.add.at(slope, reach, -penalty * np.einsum("wiq,wi->wq", slopes, here.gap))
    slope[:nq] += weight * prior
    diagonal = hessian.diagonal()
    diagonal[:nq] += weight**2
    raised = np.maximum(damping * diagonal, 1e-12 * max(diagonal.max(), 1e-300))
    raised[:nq] += weight**2
    move = spsolve(csc_array(hessian + diags_array(raised)), slope)
    low, high = problem.low[problem.free], problem.high[problem.free]
    theta = np.clip(here.theta + move[:nq], low, high)
    return _point(joined, theta, here.states + move[nq:].reshape(count, nx))


def _scattered(columns: NDArray[np.int64], blocks: Array, size: int):  # type: ignore[no-untyped-def]
    """Return the sparse sum of dense blocks at their rows and columns."""
    from scipy.sparse import coo_array  # noqa: PLC0415  (slow to import)

    n = columns.shape[1]
    rows = np.repeat(columns, n, axis=1).ravel()
    across = np.tile(columns, (1, n)).ravel()
    return coo_array((blocks.ravel(), (rows, across)), shape=(size, size)).tocsr()
