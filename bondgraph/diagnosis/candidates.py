"""Candidates: every hypothesis inserted, refitted from the base optimum and ranked.

A hypothesis is nested in the base model, so its refit starts where the base fit ended,
with the new strength at zero; where that does not keep what the linearised problem
promises, also from its other starts. A short fit screens; only those that reduce the
training error materially are fitted to the end.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.probing import measure_scales
from bondgraph.errors import BondGraphError
from bondgraph.fitting.estimate import FittedModel, pose, prepare
from bondgraph.fitting.levenberg_marquardt import (
    Optimum,
    minimise,
    promised_reduction,
)
from bondgraph.fitting.problem import FitProblem
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis
from bondgraph.physics.places.everywhere import all_places
from bondgraph.structure.edits import InsertElement

Array = NDArray[np.float64]
SCREENING_ITERATIONS = 4
FULL_ITERATIONS = 30
TOLERANCE = 1e-4
KEPT_PROMISE = 0.8
RELATIVE_BETTER = 0.99


@dataclass(frozen=True, slots=True)
class Candidate:
    """A hypothesis with its fitted model."""

    hypothesis: Hypothesis
    fitted: FittedModel

    @property
    def complexity(self) -> int:
        """Number of parameters it adds."""
        return len(self.hypothesis.parameters)

    def reduction(self, base: FittedModel) -> float:
        """Return the relative reduction of the training error against `base`."""
        return 1.0 - self.fitted.optimum.cost / base.optimum.cost


@dataclass(frozen=True, slots=True)
class Rejected:
    """A hypothesis that cannot be tried, with the reason."""

    hypothesis: Hypothesis
    reason: str


def propose_all(
    base: FittedModel, library: Sequence[AbstractPhysics]
) -> tuple[Hypothesis, ...]:
    """Return every hypothesis of the library at every place."""
    scales = measure_scales(base)
    return tuple(
        hypothesis
        for place in all_places(base.graph, scales)
        for physics in library
        for hypothesis in physics.propose(place)
    )


def screen(
    base: FittedModel,
    hypotheses: Sequence[Hypothesis],
    worth: float,
    tick: Callable[[str], None] = lambda _: None,
) -> tuple[tuple[Candidate, ...], tuple[Rejected, ...]]:
    """Fit every hypothesis briefly; return them with the best first.

    Parameters
    ----------
    worth
        A hypothesis that promises less than this relative reduction is rejected.
    """
    candidates: list[Candidate] = []
    rejected: list[Rejected] = []
    for hypothesis in hypotheses:
        tick(f"{hypothesis.physics} at {hypothesis.place}")
        try:
            candidate = _best_start(base, hypothesis, worth, candidates)
        except BondGraphError as error:
            rejected.append(Rejected(hypothesis, str(error)))
            continue
        if candidate is not None:
            candidates.append(candidate)
    candidates.sort(key=lambda candidate: candidate.fitted.optimum.cost)
    return tuple(candidates), tuple(rejected)


def complete(candidate: Candidate) -> Candidate:
    """Return the candidate fitted to the end."""
    fitted = candidate.fitted
    if fitted.optimum.converged:
        return candidate
    optimum = minimise(
        fitted.problem,
        fitted.optimum.theta,
        fitted.optimum.initial,
        iterations=FULL_ITERATIONS,
        tolerance=TOLERANCE,
        settled=fitted.optimum.linearisation,
    )
    return replace(candidate, fitted=replace(fitted, optimum=optimum))


def nested(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return the candidates, each refitted from relatives that fit better.

    What seems a worse law may be a fit that ended too early. A wider law's values
    without its additions, and the same law's at another place, are better starts.
    """
    improved = list(candidates)
    for i, own in enumerate(candidates):
        for other in candidates:
            better = _cost(other) < RELATIVE_BETTER * _cost(improved[i])
            if better and _related(own, other):
                improved[i] = _refitted(improved[i], other)
    return improved


def _related(own: Candidate, other: Candidate) -> bool:
    """Return whether `other` is a wider law here, or the same law elsewhere."""
    a, b = own.hypothesis, other.hypothesis
    if a.place == b.place:
        return a.physics in b.extends
    return a.physics == b.physics and own.complexity == other.complexity


def _cost(candidate: Candidate) -> float:
    return candidate.fitted.optimum.cost


def _refitted(own: Candidate, other: Candidate) -> Candidate:
    """Return `own` fitted from the other's shared values, if that is better."""
    problem, values = own.fitted.problem, {**other.fitted.values}
    twins = zip(own.hypothesis.parameters, other.hypothesis.parameters, strict=False)
    for name, twin in twins:
        # A coefficient without a unit is the same seen from either side of a gear.
        if own.fitted.graph.parameters[name].unit == "1":
            values.setdefault(name, values[twin])
    names = [problem.model.parameter_names[i] for i in problem.free]
    pairs = zip(names, own.fitted.optimum.theta, strict=True)
    theta = np.array([values.get(name, value) for name, value in pairs])
    optimum = minimise(
        problem,
        theta,
        other.fitted.optimum.initial,
        iterations=FULL_ITERATIONS,
        tolerance=TOLERANCE,
    )
    if optimum.cost >= _cost(own):
        return own
    return replace(own, fitted=replace(own.fitted, optimum=optimum))


def _best_start(
    base: FittedModel, hypothesis: Hypothesis, worth: float, known: Sequence[Candidate]
) -> Candidate | None:
    """Return the best of short fits from the hypothesis' starts.

    A law that extends one already fitted at its place starts from there as well. None
    where even the linearised problem at the weakest start promises a relative
    reduction below `worth`.
    """
    problem = _problem_of(base, hypothesis)
    initial = _initial_states(base, problem.model.state_names)
    starts = _start_values(base, hypothesis, problem)
    promise = promised_reduction(problem, starts[0], initial)
    nested_in_base = isinstance(hypothesis.edit, InsertElement)
    if nested_in_base and promise < worth:
        return None
    begin = [
        *_from_narrower(hypothesis, problem, starts[0], known),
        *((theta, initial) for theta in starts),
    ]
    best: Optimum | None = None
    for theta, states in begin:
        found = minimise(
            problem,
            theta,
            states,
            iterations=SCREENING_ITERATIONS,
            tolerance=TOLERANCE,
        )
        if best is None or found.cost < best.cost:
            best = found
        if 1.0 - best.cost / base.optimum.cost > KEPT_PROMISE * promise:
            break
    assert best is not None
    if not math.isfinite(best.cost):
        raise BondGraphError(
            f"{hypothesis.physics} at {hypothesis.place} could not be simulated.",
            (hypothesis.physics, hypothesis.place),
        )
    graph = hypothesis.apply(base.graph)
    return Candidate(
        hypothesis, replace(base, graph=graph, problem=problem, optimum=best)
    )


def _from_narrower(
    hypothesis: Hypothesis,
    problem: FitProblem,
    weakest: Array,
    known: Sequence[Candidate],
) -> list[tuple[Array, Array]]:
    """Return the optima of fitted laws that the hypothesis extends at its place.

    Parameters they share by name take the fitted values, the others the weakest start.
    """
    names = [problem.model.parameter_names[i] for i in problem.free]
    found = []
    for candidate in known:
        narrower = candidate.hypothesis
        if narrower.place != hypothesis.place:
            continue
        if narrower.physics in hypothesis.extends:
            values = candidate.fitted.values
            pairs = zip(names, weakest, strict=True)
            theta = np.array([values.get(name, value) for name, value in pairs])
            found.append((theta, candidate.fitted.optimum.initial))
    return found


def _problem_of(base: FittedModel, hypothesis: Hypothesis) -> FitProblem:
    graph = hypothesis.apply(base.graph)
    model = prepare(graph)
    problem = pose(graph, model, base.problem.shots, base.settings, base.problem.sigma)
    return _with_prior_of(problem, base)


def _with_prior_of(problem: FitProblem, base: FittedModel) -> FitProblem:
    """Keep the prior's centre at the values before the base fit."""
    start = dict(
        zip(base.problem.model.parameter_names, base.problem.start, strict=True)
    )
    names = problem.model.parameter_names
    centre = [start.get(n, v) for n, v in zip(names, problem.start, strict=True)]
    return replace(problem, start=np.array(centre))


def _start_values(
    base: FittedModel, hypothesis: Hypothesis, problem: FitProblem
) -> tuple[Array, ...]:
    """Return the free parameters at each start of the hypothesis."""
    added = {p.name: p.value or 0.0 for p in hypothesis.edit.parameters}
    free = [problem.model.parameter_names[i] for i in problem.free]
    return tuple(
        np.array([{**base.values, **added, **start}[name] for name in free])
        for start in hypothesis.starts
    )


def _initial_states(base: FittedModel, names: Sequence[str]) -> Array:
    """Return the base model's initial states, with zeros for new states."""
    known = dict(
        zip(base.problem.model.state_names, base.optimum.initial.T, strict=True)
    )
    zeros = np.zeros(base.problem.shots.n_windows)
    columns = [known.get(name, zeros) for name in names]
    return np.column_stack(columns) if columns else zeros[:, None][:, :0]
