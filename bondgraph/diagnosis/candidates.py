"""Candidates: every hypothesis inserted, refitted from the base optimum and ranked.

A hypothesis is nested in the base model, so its refit starts where the base fit ended,
with the new strength at zero, and once more from each of its own start values. A short
fit screens; only those that reduce the training error materially are fitted to the end.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.probing import measure_scales
from bondgraph.errors import BondGraphError
from bondgraph.fitting.estimate import FittedModel, pose, prepare
from bondgraph.fitting.levenberg_marquardt import Optimum, minimise
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Place

Array = NDArray[np.float64]
SCREENING_ITERATIONS = 5
FULL_ITERATIONS = 40


@dataclass(frozen=True, slots=True)
class Candidate:
    """A hypothesis with its fitted model."""

    hypothesis: Hypothesis
    fitted: FittedModel

    @property
    def complexity(self) -> float:
        """Number of parameters it adds, and half as much for each variable it reads."""
        own = self.hypothesis
        return len(own.parameters) + 0.5 * len(own.depends_on)

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
    """Return every hypothesis of the library at every junction."""
    scales = measure_scales(base)
    places = [Place(base.graph, j.name, scales) for j in base.graph.junctions]
    return tuple(
        hypothesis
        for place in places
        for physics in library
        for hypothesis in physics.propose(place)
    )


def screen(
    base: FittedModel,
    hypotheses: Sequence[Hypothesis],
    tick: Callable[[str], None] = lambda _: None,
) -> tuple[tuple[Candidate, ...], tuple[Rejected, ...]]:
    """Fit every hypothesis briefly; return them with the best first."""
    candidates, rejected = [], []
    for hypothesis in hypotheses:
        tick(f"{hypothesis.physics} at {hypothesis.place}")
        try:
            candidates.append(_best_start(base, hypothesis))
        except BondGraphError as error:
            rejected.append(Rejected(hypothesis, str(error)))
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
        settled=fitted.optimum.linearisation,
    )
    return replace(candidate, fitted=replace(fitted, optimum=optimum))


def _best_start(base: FittedModel, hypothesis: Hypothesis) -> Candidate:
    """Return the best of short fits from all starts of the hypothesis."""
    graph = hypothesis.apply(base.graph)
    model = prepare(graph)
    problem = pose(graph, model, base.problem.shots, base.settings, base.problem.sigma)
    problem = _with_prior_of(problem, base)
    initial = _initial_states(base, model.state_names)
    best: Optimum | None = None
    for start in _start_values(base, hypothesis):
        theta = np.array(
            [start[model.parameter_names[i]] for i in problem.free], dtype=float
        )
        found = minimise(problem, theta, initial, iterations=SCREENING_ITERATIONS)
        if best is None or found.cost < best.cost:
            best = found
    assert best is not None
    if not math.isfinite(best.cost):
        raise BondGraphError(
            f"{hypothesis.physics} at {hypothesis.place} could not be simulated.",
            (hypothesis.physics, hypothesis.place),
        )
    return Candidate(
        hypothesis,
        FittedModel(graph=graph, problem=problem, optimum=best, horizon=base.horizon),
    )


def _with_prior_of(problem, base):  # type: ignore[no-untyped-def]
    """Keep the prior's centre at the values before the base fit."""
    start = dict(
        zip(base.problem.model.parameter_names, base.problem.start, strict=True)
    )
    names = problem.model.parameter_names
    centre = [start.get(n, v) for n, v in zip(names, problem.start, strict=True)]
    return replace(problem, start=np.array(centre))


def _start_values(
    base: FittedModel, hypothesis: Hypothesis
) -> Iterator[dict[str, float]]:
    """Yield all parameter values for each start of the hypothesis."""
    added = {p.name: p.value or 0.0 for p in hypothesis.edit.parameters}
    for start in hypothesis.starts:
        yield {**base.values, **added, **start}


def _initial_states(base: FittedModel, names: Sequence[str]) -> Array:
    """Return the base model's initial states, with zeros for new states.

    A displacement that a new C brings along is the one the base model integrated.
    """
    known = dict(
        zip(base.problem.model.state_names, base.optimum.initial.T, strict=True)
    )
    n = base.problem.shots.n_windows
    integrators = [
        name for name in known if name not in names and name.startswith("q_")
    ]
    columns = []
    for name in names:
        if name in known:
            columns.append(known[name])
        elif name.startswith("q_") and len(integrators) == 1:
            columns.append(known[integrators[0]])
        else:
            columns.append(np.zeros(n))
    return np.column_stack(columns) if columns else np.zeros((n, 0))
