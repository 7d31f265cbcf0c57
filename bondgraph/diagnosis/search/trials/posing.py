"""A hypothesis as a fit to the base model's data: where it starts, and on how much."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.base.steps import coarser
from bondgraph.errors import BondGraphError
from bondgraph.fitting.estimate import FittedModel, pose, prepare
from bondgraph.fitting.horizon import SHORTEST
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.fitting.problem import FitProblem, Linearisation, linearise_windows
from bondgraph.numeric.model import NumericModel
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.simulation.native_shooting import suits_explicit
from bondgraph.simulation.shooting import Shots
from bondgraph.simulation.solvers import RungeKutta4, Sdirk2, Solver

Array = NDArray[np.float64]
SCREENED = 20_000
"""Samples that screening reads at most; what matters shows in so many."""

PIECES = 10
NO_TIME = "a table without time shows nothing that remembers"
THINNED_ITERATIONS = 5


def suited(solver: Solver, model: NumericModel) -> Solver:
    """Return the solver, or an implicit one where a model's rates need it."""
    if isinstance(solver, RungeKutta4) and not suits_explicit(model):
        return Sdirk2()
    return solver


def pose_hypothesis(
    base: FittedModel, hypothesis: Hypothesis, solver: Solver | None = None
) -> FitProblem:
    """Return the fit of the model with the hypothesis to the base model's data.

    The prior keeps its centre at the values before the base fit.

    Parameters
    ----------
    solver
        The base model's, where it suits, when None.

    Raises
    ------
    BondGraphError
        If it adds a state and the data are a steady table: a state of its own in every
        row would explain anything.
    """
    graph = hypothesis.apply(base.graph)
    model = prepare(graph)
    old = base.problem
    if old.shots.timeless and model.n_states > old.model.n_states:
        raise BondGraphError(NO_TIME, (hypothesis.place,))
    problem = pose(graph, model, old.shots, base.settings, old.sigma)
    start = dict(zip(old.model.parameter_names, old.start, strict=True))
    centre = [
        start.get(name, value)
        for name, value in zip(model.parameter_names, problem.start, strict=True)
    ]
    chosen = suited(old.solver if solver is None else solver, model)
    return replace(problem, start=np.array(centre), solver=chosen)


def thetas(
    base: FittedModel,
    hypothesis: Hypothesis,
    problem: FitProblem,
    starts: Sequence[Mapping[str, float]],
) -> list[Array]:
    """Return the free parameters at each of `starts`: theirs before the base fit's."""
    added = {p.name: p.value or 0.0 for p in hypothesis.edit.parameters}
    free = problem.free_names
    known = {**base.values, **added}
    return [np.array([{**known, **start}[name] for name in free]) for start in starts]


def added(base: FittedModel, problem: FitProblem) -> NDArray[np.bool_]:
    """Return which free parameters of a posed hypothesis the base model lacks."""
    names = problem.model.parameter_names
    return np.array([names[i] not in base.values for i in problem.free], dtype=bool)


def light(fitted: FittedModel) -> FittedModel:
    """Return a fitted model without what can be simulated again, to be sent away."""
    empty = {field.name: np.zeros(0) for field in fields(Linearisation)}
    optimum = replace(fitted.optimum, linearisation=Linearisation(**empty))
    return replace(fitted, optimum=optimum)


def coarse(fitted: FittedModel) -> FittedModel:
    """Return the model fitted with as few steps as tell hypotheses apart."""
    problem, optimum = fitted.problem, fitted.optimum
    solver = coarser(problem, optimum)
    if solver == problem.solver:
        return fitted
    problem = replace(problem, solver=solver)
    optimum = minimise(
        problem, optimum.theta, optimum.initial, iterations=THINNED_ITERATIONS
    )
    return replace(fitted, problem=problem, optimum=optimum)


def divided(fitted: FittedModel, pieces: int) -> FittedModel | None:
    """Return the model fitted to windows that are divided, each piece on its own.

    Short ones into fewer pieces; None where there are none that can be divided.
    """
    problem, optimum = fitted.problem, fitted.optimum
    ends: list[int] = [0]
    for part in problem.shots.slices:
        count = min(pieces, max((part.stop - part.start) // SHORTEST, 1))
        cuts = np.linspace(part.start, part.stop, count + 1).astype(int)
        ends += map(int, cuts[1:])
    if len(ends) == len(problem.shots.edges):
        return None
    passed = linearise_windows(problem, optimum.theta, optimum.initial).states
    problem = replace(problem, shots=replace(problem.shots, edges=tuple(ends)))
    there = minimise(
        problem, optimum.theta, passed[ends[:-1]], iterations=THINNED_ITERATIONS
    )
    return replace(fitted, problem=problem, optimum=there)


def thinned(fitted: FittedModel, most: int = SCREENED) -> FittedModel:
    """Return the model fitted to evenly spread pieces of its data, `most` samples.

    A piece starts from the states that the whole fit passes there.
    """
    shots = fitted.problem.shots
    if len(shots.time) <= most:
        return fitted
    length = most // PIECES
    pieces = [
        (start, min(start + length, part.stop))
        for part in shots.slices
        for start in range(part.start, part.stop, length)
    ]
    sizes = np.array([stop - start for start, stop in pieces])
    count = max(int(most / sizes.mean()), 1)
    chosen = np.unique(np.linspace(0, len(pieces) - 1, count).astype(int))
    kept = [pieces[i] for i in chosen]
    rows = np.concatenate([np.arange(*piece) for piece in kept])
    edges = np.cumsum([0, *(stop - start for start, stop in kept)])
    problem = replace(
        fitted.problem,
        shots=Shots(
            shots.time[rows],
            shots.inputs[rows],
            shots.outputs[rows],
            tuple(map(int, edges)),
        ),
    )
    initial = fitted.optimum.linearisation.states[rows[edges[:-1]]]
    optimum = minimise(
        problem, fitted.optimum.theta, initial, iterations=THINNED_ITERATIONS
    )
    return replace(fitted, problem=problem, optimum=optimum)
