"""States that a law adds, where it begins without effect: settled, or at rest.

A sensor that lags by a tenth of a sample reads what is there: its state begins there
too. Were it fitted, it would begin wherever the first samples' noise likes, or, where
explicit steps do not follow it, anywhere; its slopes would tell of that and not of the
lag.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.base.begun import initial_states
from bondgraph.diagnosis.search.base.steps import is_fine
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.problem import FitProblem, linearise_windows
from bondgraph.fitting.settling import settle
from bondgraph.numeric.model import evaluate
from bondgraph.simulation.solvers import RungeKutta4, Sdirk2

Array = NDArray[np.float64]
SETTLE_ITERATIONS = 4
AT_REST = 1.05
"""A start without effect leaves at most so many times what the base model leaves."""


def settled(base: FittedModel, problem: FitProblem, theta: Array) -> Array:
    """Return the base model's initial states, with those of new states fitted."""
    initial = initial_states(base, problem.model.state_names)
    if not _new_states(base, problem).size:
        return initial
    states, there = settle(problem, theta, initial, SETTLE_ITERATIONS)
    explicit = isinstance(problem.solver, RungeKutta4)
    if explicit and not is_fine(problem, theta, states, there):
        # Steps that a stiff state outruns tell nothing of where it begins.
        implicit = replace(problem, solver=Sdirk2(problem.solver.substeps))
        return settle(implicit, theta, initial, SETTLE_ITERATIONS)[0]
    return states


def without_effect(base: FittedModel, problem: FitProblem, theta: Array) -> Array:
    """Return initial states at parameters that leave the base model as it is.

    The first that do, simulated by implicit steps: new states at rest, fitted, fitted
    by implicit steps.
    """
    new, fixed = _new_states(base, problem), replace(problem, solver=Sdirk2())
    if not new.size:
        return initial_states(base, problem.model.state_names)
    for states in (_resting(base, problem, theta, new), settled(base, problem, theta)):
        if states is not None:
            there = linearise_windows(fixed.fixed_at(theta), theta[:0], states)
            if float(np.sum(there.cost)) <= AT_REST * base.optimum.cost:
                return states
    return settled(base, fixed, theta)


def _new_states(base: FittedModel, problem: FitProblem) -> NDArray[np.int64]:
    """Return the indices of the states that the base model lacks."""
    known = base.problem.model.state_names
    names = enumerate(problem.model.state_names)
    return np.array([i for i, name in names if name not in known], dtype=np.int64)


def _resting(
    base: FittedModel, problem: FitProblem, theta: Array, new: NDArray[np.int64]
) -> Array | None:
    """Return initial states with new ones where they do not change; None where none do.

    One step of Newton, which is exact for signals that follow others.
    """
    model, shots = problem.model, problem.shots
    if model.n_unknowns:
        return None
    initial = initial_states(base, model.state_names)
    values, nu = problem.with_parameters(theta), len(model.input_names)
    directions = np.zeros((model.dynamics.n_variables, new.size))
    directions[new, np.arange(new.size)] = 1.0
    for window, part in enumerate(shots.slices):
        known = (shots.inputs[part.start], np.zeros(nu), values, shots.time[part][:1])
        point = np.concatenate([initial[window], np.zeros(model.n_states), *known])
        rates, slopes = evaluate(model.dynamics, point, directions)
        try:
            initial[window, new] -= np.linalg.solve(slopes[new], rates[new])
        except np.linalg.LinAlgError:
            return None
    return initial if np.isfinite(initial).all() else None
