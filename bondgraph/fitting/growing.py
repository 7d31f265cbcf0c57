"""Growing windows: the same recordings cut short first, then longer.

A longer window begins where a shorter one began, so the state simulated there is the
start value of its own. Short windows hardly tell what acts slowly, and a descent
would throw such a parameter far away; while windows grow, every parameter is held
weakly, to its own size, around its start.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.levenberg_marquardt import Optimum, minimise
from bondgraph.fitting.problem import FitProblem
from bondgraph.fitting.settling import settle
from bondgraph.fitting.strategy import GrowingWindows
from bondgraph.simulation.shooting import Shots

Array = NDArray[np.float64]
ITERATIONS = 12
TOLERANCE = 1e-3
SHORTEST_REST = 8
"""Samples; a rest shorter than this stays with the window before it."""


def cut_finer(shots: Shots, samples: int) -> Shots:
    """Return the same samples in windows of about `samples`, none across an edge."""
    edges = [shots.edges[0]]
    for start, stop in pairwise(shots.edges):
        cuts = [*range(start + samples, stop, samples)]
        if cuts and stop - cuts[-1] < SHORTEST_REST:
            cuts.pop()
        edges += [*cuts, stop]
    return Shots(shots.time, shots.inputs, shots.outputs, tuple(edges))


def grow(
    problem: FitProblem, theta: Array, initial: Array, strategy: GrowingWindows
) -> tuple[Array, Array]:
    """Return parameters and initial states of `problem` that growing windows lead to.

    Parameters
    ----------
    theta
        Where to start.
    initial
        States at the beginning of the shortest windows, `first_windows` of them.
    """
    longest = int(problem.shots.lengths.max())
    samples, states = strategy.shortest, np.zeros(0)
    stage = held_weakly(first_windows(problem, strategy), theta)
    # The first residual scale was a guess, against which the hold weighs much.
    first = minimise(stage, theta, initial, iterations=ITERATIONS, tolerance=TOLERANCE)
    if np.isfinite(first.cost):
        theta, initial, stage = first.theta, first.initial, rescaled(stage, first)
    while True:
        optimum = minimise(
            stage, theta, initial, iterations=ITERATIONS, tolerance=TOLERANCE
        )
        if np.isfinite(optimum.cost):
            theta, states = optimum.theta, optimum.linearisation.states
            stage = rescaled(stage, optimum)
        elif not len(states):
            return theta, initial[_begin(problem.shots, stage.shots)]
        samples *= strategy.factor
        if samples * strategy.factor > 2 * longest:
            return theta, states[list(problem.shots.edges[:-1])]
        stage = replace(stage, shots=cut_finer(problem.shots, samples))
        initial = states[list(stage.shots.edges[:-1])]
        initial, _ = settle(stage, theta, initial, iterations=3)


def first_windows(problem: FitProblem, strategy: GrowingWindows) -> FitProblem:
    """Return the problem over the shortest windows."""
    return replace(problem, shots=cut_finer(problem.shots, strategy.shortest))


def _begin(long: Shots, short: Shots) -> NDArray[np.int64]:
    """Return which short windows begin where the long ones do."""
    return np.searchsorted(short.edge_array, long.edge_array[:-1])


def held_weakly(problem: FitProblem, theta: Array) -> FitProblem:
    """Return the problem with every free parameter known to ± its own size."""
    std = problem.prior_std.copy()
    size = np.where(theta == 0.0, np.inf, np.abs(theta))
    std[problem.free] = np.minimum(std[problem.free], size)
    start = problem.start.copy()
    start[problem.free] = theta
    return replace(problem, prior_std=std, start=start)


def rescaled(problem: FitProblem, optimum: Optimum) -> FitProblem:
    """Return the problem with each output weighed by its residual there."""
    power = (optimum.linearisation.residuals**2).sum(axis=0) / problem.measured
    return replace(problem, sigma=problem.sigma * np.sqrt(np.maximum(power, 1e-24)))
