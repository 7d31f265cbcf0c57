"""What a fitted model says over longer than its windows, from one initial state each.

Of whole recordings, or stretches of them, only the initial states are estimated.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bondgraph.fitting.automatic import grows
from bondgraph.fitting.estimate import FittedModel, first_guess, pose
from bondgraph.fitting.horizon import Horizon, WholeRecordings, Windows, cut
from bondgraph.fitting.problem import FitProblem, Linearisation, write_windows
from bondgraph.fitting.result import Score
from bondgraph.fitting.settling import settle
from bondgraph.fitting.told import score
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.solvers import implicit

Array = NDArray[np.float64]
FINER = (1, 4, 16)
"""How many times finer the steps are, in turn, until a simulation ends."""

FAR = 10.0
"""A stretch that costs so many times more a sample than the fit's windows did may have
begun in states that are far from the machine's.
"""


@dataclass(frozen=True, slots=True, eq=False)
class WholeSimulation:
    """A model run through recordings, each from one estimated initial state.

    ``outputs`` is (n, ny) over all samples kept; ``whole`` is False where the model is
    so unstable that windows were used instead.
    """

    score: Score
    time: Array
    measured: Array
    outputs: Array
    edges: tuple[int, ...]
    whole: bool


def simulate_whole(
    fitted: FittedModel, recordings: Sequence[BoundRecording]
) -> WholeSimulation:
    """Simulate whole recordings with the fitted parameters.

    Where a step fails, with finer ones, and implicit ones at last: another recording
    may be rougher.
    """
    own = fitted.problem.solver
    stable = () if implicit(own) == own else (implicit(own),)
    for solver, finer in product((own, *stable), FINER):
        steps = replace(solver, substeps=finer * solver.substeps)
        problem = replace(fitted.problem, solver=steps)
        stepped = replace(fitted, problem=problem)
        simulated = _simulate(stepped, recordings, WholeRecordings())
        if np.isfinite(simulated.outputs[np.isfinite(simulated.measured)]).all():
            return simulated
    return replace(_simulate(fitted, recordings, fitted.horizon), whole=False)


def simulate_stretches(
    fitted: FittedModel, recordings: Sequence[BoundRecording], samples: int
) -> WholeSimulation:
    """Simulate stretches of so many samples, each from one estimated initial state."""
    return _simulate(fitted, recordings, Windows(samples))


def _simulate(
    fitted: FittedModel, recordings: Sequence[BoundRecording], horizon: Horizon
) -> WholeSimulation:
    problem = posed_over(fitted, recordings, horizon)
    shots, old = problem.shots, fitted.problem
    _, at = settled_over(problem, fitted)
    residuals = at.residuals * old.sigma
    residuals = np.where(np.isfinite(shots.outputs), residuals, np.nan)
    return WholeSimulation(
        score=score(old.model, shots, residuals),
        time=shots.time,
        measured=shots.outputs,
        outputs=shots.outputs - residuals,
        edges=shots.edges,
        whole=True,
    )


def posed_over(
    fitted: FittedModel, recordings: Sequence[BoundRecording], horizon: Horizon
) -> FitProblem:
    """Return the problem of other recordings, with the values of a fit."""
    old, shots = fitted.problem, cut(recordings, horizon)
    problem = pose(fitted.graph, old.model, shots, fitted.settings, old.sigma)
    return replace(problem, start=fitted.parameters)


def settled_over(
    problem: FitProblem, fitted: FittedModel
) -> tuple[Array, Linearisation]:
    """Return the initial states that suit every window best, and the residuals there.

    Where what the first samples suggest runs away, or leaves far more than the fit
    did (a machine begun in motion looks from rest as if dry friction held it), also
    from the states that the fit knows there, from rest and from what is usual.
    """
    theta = problem.start[problem.free]
    states, at = settle(problem, theta, first_guess(problem, theta), iterations=25)
    samples = problem.shots.lengths
    usual = np.median(fitted.optimum.initial, axis=0)
    for other in (_known(problem, fitted), np.zeros_like(usual), usual):
        lost = ~(at.cost <= FAR * _left_per_sample(fitted) * samples)
        if not lost.any():
            break
        begin = np.where(lost[:, None], other, states)
        moved, there = settle(problem, theta, begin, iterations=25)
        better = there.cost < np.where(np.isfinite(at.cost), at.cost, np.inf)
        states = np.where(better[:, None], moved, states)
        write_windows(at, problem.shots.edges, np.arange(len(lost)), there, better)
    return states, at


def _known(problem: FitProblem, fitted: FittedModel) -> Array:
    """Return the states in which the fit passes the windows' begins; else zeros.

    It knows them where it has seen the same samples.
    """
    shots, seen = problem.shots, fitted.problem.shots
    along = fitted.optimum.linearisation.states
    same = np.array_equal(shots.time, seen.time) and np.array_equal(
        shots.outputs, seen.outputs, equal_nan=True
    )
    begins = along[list(shots.edges[:-1])] if same else along[:0]
    if len(begins) and np.isfinite(begins).all():
        return begins
    return np.zeros((shots.n_windows, problem.model.n_states))


def _left_per_sample(fitted: FittedModel) -> float:
    """Return what the fit leaves of its cost in each sample."""
    left = fitted.optimum.linearisation.cost
    return float(np.sum(left)) / fitted.problem.shots.edges[-1]


def goes_on_growing(fitted: FittedModel, recordings: Sequence[BoundRecording]) -> bool:
    """Return whether the least disturbance goes on growing with the fitted values."""
    graph = fitted.graph.with_parameters(fitted.values)
    return grows(graph, fitted.problem.model, recordings, fitted.settings)
