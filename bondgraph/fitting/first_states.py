"""Initial states to start from: those that fit the first samples of every window.

From zero, over a short stretch, the fit is nearly linear; from there the long one
starts close enough. A ball at no distance from its magnet is nowhere near: where that
misses by more than all that was measured varies, the states are also sought from what
the very first sample reads, and taken from there where that does not miss so far.

Where dry friction sticks the fit is not linear: at rest no state moves the outputs by
its flow, and a machine that was let go, or pushed, looks as if it had always stood
where it stands on average. So the states are also sought in the same machine with its
frictions let go of, in which every flow shows, and taken from there where they fit
better in the machine itself.

At zero a root has no finite slope (an empty tank above its outlet), and an explicit
method looks at that very point. There an implicit one, which looks beside it, goes
first.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.horizon import SHORTEST
from bondgraph.fitting.problem import FitProblem, Linearisation, write_windows
from bondgraph.fitting.settling import settle
from bondgraph.numeric.held_modes import with_modes_given
from bondgraph.recordings.spread import spread
from bondgraph.simulation.solvers import Sdirk2

Array = NDArray[np.float64]
Settled = tuple[Array, Linearisation]
ITERATIONS = 12


def first_guess(problem: FitProblem, theta: Array) -> Array:
    """Return initial states that fit the first samples of every window, (n, nx)."""
    shots = problem.shots
    varies = float(np.sum((spread(shots.outputs) / problem.sigma) ** 2))
    zeros = np.zeros((shots.n_windows, problem.model.n_states))
    iterations = ITERATIONS
    if shots.lengths.max() > 2 * SHORTEST:
        problem = replace(
            problem, shots=shots.subset(np.arange(shots.n_windows), SHORTEST)
        )
    elif problem.model.set_valued is None:
        iterations = 0
    initial, here = settle(problem, theta, zeros, iterations)
    near = varies * problem.shots.lengths
    if not (here.cost <= near).all():
        states = _read_at_once(problem, theta, zeros)
        states, there = settle(problem, theta, states, iterations)
        there = replace(there, cost=np.where(there.cost <= near, there.cost, np.inf))
        initial, here = _better(problem, (initial, here), (states, there))
    lost = ~np.isfinite(here.cost)
    if lost.any():
        beside, _ = settle(replace(problem, solver=Sdirk2()), theta, zeros)
        initial = np.where(lost[:, None], beside, initial)
        initial, here = settle(problem, theta, initial, iterations)
    moving = states_in_motion(problem, theta)
    if moving is None:
        return initial
    return _better(problem, (initial, here), settle(problem, theta, moving))[0]


def _read_at_once(problem: FitProblem, theta: Array, zeros: Array) -> Array:
    """Return states that fit the first sample of every window; no step is taken."""
    shots = problem.shots.subset(np.arange(problem.shots.n_windows), 1)
    return settle(replace(problem, shots=shots), theta, zeros)[0]


def _better(problem: FitProblem, one: Settled, other: Settled) -> Settled:
    """Return, window by window, the states that fit better, with how they do."""
    (initial, here), (states, there) = one, other
    is_better = there.cost < here.cost
    every = np.arange(len(is_better))
    write_windows(here, problem.shots.edges, every, there, is_better)
    return np.where(is_better[:, None], states, initial), here


def states_in_motion(problem: FitProblem, theta: Array) -> Array | None:
    """Return initial states that fit without dry friction; None where nothing is dry.

    Whole windows are fitted, so they should be short.
    """
    free = with_modes_given(problem.model)
    if free is None:
        return None
    more = len(free.parameter_names) - len(problem.model.parameter_names)
    loose = replace(
        problem,
        model=free,
        start=np.append(problem.start, np.zeros(more)),
        low=np.append(problem.low, np.full(more, -np.inf)),
        high=np.append(problem.high, np.full(more, np.inf)),
        prior_std=np.append(problem.prior_std, np.full(more, np.inf)),
    )
    zeros = np.zeros((problem.shots.n_windows, free.n_states))
    return settle(loose, theta, zeros)[0]
