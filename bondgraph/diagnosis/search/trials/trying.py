"""What is done with one hypothesis: a promise, a fit, its errors on left-out data.

Each is a pure function of the base model and one `Trial`, returns plain data, and can
be run anywhere (`workers`).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.evidence.left_out import left_out_errors
from bondgraph.diagnosis.search.base.begun import initial_states
from bondgraph.diagnosis.search.base.runaway import run_away
from bondgraph.diagnosis.search.base.steps import faithful
from bondgraph.diagnosis.search.trials.at_rest import (
    SETTLE_ITERATIONS,
    settled,
    without_effect,
)
from bondgraph.diagnosis.search.trials.posing import (
    added,
    pose_hypothesis,
    thetas,
)
from bondgraph.diagnosis.search.trials.score_test import Score, score_test
from bondgraph.diagnosis.search.trials.surrogates import Baseline
from bondgraph.diagnosis.work.journal import Plain
from bondgraph.errors import BondGraphError, EquationError
from bondgraph.fitting.estimate import FittedModel, first_guess
from bondgraph.fitting.levenberg_marquardt import Optimum, minimise
from bondgraph.fitting.problem import FitProblem, window_costs
from bondgraph.fitting.settling import settle
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.simulation.solvers import Solver
from bondgraph.structure.edits import ReplaceMeasurement, WrapInput

Array = NDArray[np.float64]
PROMISE_ITERATIONS = 5
SHORT_ITERATIONS = 5
LONGER = 15
"""A short fit that has not kept its promise, or is on its way, goes on for so many."""
FULL_ITERATIONS = 30
TOLERANCE = 1e-4
FORMS = 6
"""Of a law with more forms, a ripple's lengths, no more are fitted."""

SURE = 0.8
"""A form that promises this share of the error is the right one."""

UNSOLVED = "the model's equations have no unique solution with it there"


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """Where a fit starts: values by name before those of the base fit.

    Initial states are fitted anew where there are none, or none that fit. A solver is
    known where a fit has ended.
    """

    values: Mapping[str, float]
    initial: Array | None = None
    solver: Solver | None = None

    @classmethod
    def where_ended(cls, fitted: FittedModel) -> "Start":
        """Return a start where another fit has ended."""
        return cls(fitted.values, fitted.optimum.initial, fitted.problem.solver)


@dataclass(frozen=True, slots=True)
class Trial:
    """A hypothesis and where its fit starts.

    Parameters
    ----------
    starts
        Those of the hypothesis where there are none.
    enough
        A fit that takes away this share of the base's cost needs no other start.
    chunks
        Into how many the data are dealt, for errors on left-out data.
    """

    hypothesis: Hypothesis
    starts: tuple[Start, ...] = ()
    enough: float = 1.0
    chunks: int = 0


def promise(baseline: Baseline, trial: Trial) -> Plain:
    """Return the share of the base's cost that a hypothesis promises to take away.

    Where the base model is nested in it, by a score test: one simulation for each of
    the starts at which it has no effect (shape parameters are tried at several values:
    Davies, Biometrika 64, 1977), with what it promises of surrogates of the residual.
    A law that waits for something to be reached shows nothing there, and a storage of
    next to nothing is filled within a step; what their starts take away as they are
    counts as well. Else, what a few steps of a fit reach.
    ``order`` tells which of the starts promise most.
    """
    if trial.hypothesis.silent_starts:
        return _or_refused(lambda: _scored(baseline, trial))
    return _or_refused(lambda: _tried(baseline.fitted, trial))


def _scored(baseline: Baseline, trial: Trial) -> Plain:
    """Return what a hypothesis promises at its silent starts, and by chance."""
    hypothesis = trial.hypothesis
    scores = _scores(baseline, hypothesis)
    promised = [score.promised for score in scores]
    order = sorted(range(len(scores)), key=lambda i: -promised[i])
    near: dict[str, float] = {}
    turns = hypothesis.repeats or len(order) > FORMS
    if turns and max(promised) < SURE and baseline.near is not None:
        nearer = [score.promised for score in _scores(baseline.near, hypothesis)]
        own = sorted(range(len(scores)), key=lambda i: -nearer[i])
        pairs = zip(order, own, strict=True)
        order = list(dict.fromkeys(i for pair in pairs for i in pair))
        near = _fitted_near(baseline.near.quick, hypothesis, own[0])
    follows = _follows(hypothesis)
    if hypothesis.waits or (hypothesis.is_never_none and not follows):
        promised.append(_at_its_starts(baseline.fitted, trial))
    chance = np.max([score.by_chance for score in scores], axis=0)
    return {
        "promised": max(promised),
        "by_chance": [round(float(share), 6) for share in chance],
        "order": order,
        "near": near,
    }


def _follows(hypothesis: Hypothesis) -> bool:
    """Return whether all it does is to follow a signal."""
    return isinstance(hypothesis.edit, ReplaceMeasurement | WrapInput)


def _scores(baseline: Baseline, hypothesis: Hypothesis) -> list[Score]:
    """Return the score test at each of the silent starts."""
    quick = baseline.quick
    problem = pose_hypothesis(quick, hypothesis)
    new = added(quick, problem)
    # What only follows a signal begins where that is, other memories anywhere.
    begun = without_effect if _follows(hypothesis) else settled
    return [
        score_test(baseline, problem, theta, begun(quick, problem, theta), new)
        for theta in thetas(quick, hypothesis, problem, hypothesis.silent_starts)
    ]


def _fitted_near(
    near: FittedModel, hypothesis: Hypothesis, form: int
) -> dict[str, float]:
    """Return all values of a fit over short windows from one of the silent starts."""
    problem = pose_hypothesis(near, hypothesis)
    (theta,) = thetas(
        near, hypothesis, problem, hypothesis.silent_starts[form : form + 1]
    )
    initial = settled(near, problem, theta)
    found = minimise(problem, theta, initial, iterations=LONGER)
    return dict(zip(problem.free_names, map(float, found.theta), strict=True))


def _tried(base: FittedModel, trial: Trial) -> Plain:
    """Return what a few steps of a fit take away."""
    problem = pose_hypothesis(base, trial.hypothesis)
    best, _ = _best(base, trial, problem, _few(trial, PROMISE_ITERATIONS))
    return {"promised": float(1.0 - best.cost / base.optimum.cost)}


def fit_briefly(base: FittedModel, trial: Trial) -> Plain:
    """Return the best of short fits from every start of the trial."""
    return _or_refused(lambda: _fitted(base, trial, _few(trial, SHORT_ITERATIONS)))


def fit_what_remembers(base: FittedModel, trial: Trial) -> Plain:
    """Return a short fit of a hypothesis that adds a state; others are refused."""
    return _or_refused(lambda: _fitted_if(base, trial, remembers=True))


def fit_what_forgets(base: FittedModel, trial: Trial) -> Plain:
    """Return a short fit of a hypothesis that adds no state; others are refused."""
    return _or_refused(lambda: _fitted_if(base, trial, remembers=False))


def _fitted_if(base: FittedModel, trial: Trial, *, remembers: bool) -> Plain:
    problem = pose_hypothesis(base, trial.hypothesis)
    if (problem.model.n_states > base.problem.model.n_states) is not remembers:
        words = "It remembers nothing." if remembers else "It remembers something."
        raise BondGraphError(words, (trial.hypothesis.place,))
    return _fitted(base, trial, _few(trial, SHORT_ITERATIONS))


def _few(trial: Trial, usual: int) -> int:
    """Return the iterations of a fit that need not end.

    What is plugged right starts from what is stated: the base model ends elsewhere.
    """
    return LONGER if trial.hypothesis.is_slip else usual


def fit_on(base: FittedModel, trial: Trial) -> Plain:
    """Return a fit that goes on where a short one of the trial has stopped."""
    return _or_refused(lambda: _fitted(base, trial, LONGER))


def fit_fully(base: FittedModel, trial: Trial) -> Plain:
    """Return the best of fits to the end from every start of the trial."""
    return _or_refused(lambda: _fitted(base, trial, FULL_ITERATIONS))


def _or_refused(work: Any) -> Plain:
    """Return what the work gives, or why it is refused: one of many may fail.

    The law is not the user's: neither its formula nor a way to write it better helps.
    """
    try:
        result: Plain = work()
    except EquationError:
        return {"refused": UNSOLVED}
    except BondGraphError as error:
        return {"refused": error.problem}
    return result


def _fitted(base: FittedModel, trial: Trial, iterations: int) -> Plain:
    known = next((start.solver for start in trial.starts), None)
    problem = pose_hypothesis(base, trial.hypothesis, known)
    best, solver = _best(base, trial, problem, iterations)
    names = problem.free_names
    return {
        "values": dict(zip(names, map(float, best.theta), strict=True)),
        "initial": best.initial.tolist(),
        "cost": best.cost,
        "converged": best.converged,
        "solver": [type(solver).__name__, solver.substeps],
    }


def _best(
    base: FittedModel, trial: Trial, problem: FitProblem, iterations: int
) -> tuple[Optimum, Solver]:
    """Return the best of fits from every start, or the first that is good enough.

    And the solver that it took.
    """
    best: Optimum | None = None
    # From a model that has run away the promise of a law says little.
    enough = 1.0 if run_away(base) else trial.enough
    solver = problem.solver
    begun = _begin(base, trial, problem)
    if trial.hypothesis.is_never_none and len(begun) > 1:
        # The promise of its weakest start is no bound of what the others keep.
        begun.sort(key=lambda start: _cost_at(problem, start))
    for theta, initial in begun:
        found = faithful(problem, theta, initial, iterations, TOLERANCE)
        if best is None or found.optimum.cost < best.cost:
            best, solver = found.optimum, found.solver
        if best.cost <= (1.0 - enough) * base.optimum.cost:
            break
    else:
        if best is not None and trial.enough < 1.0 and not best.converged:
            last = replace(problem, solver=solver)
            found = faithful(last, best.theta, best.initial, LONGER, TOLERANCE)
            best, solver = found.optimum, found.solver
    if best is None or not np.isfinite(best.cost):
        name = f"{trial.hypothesis.physics} at {trial.hypothesis.place}"
        raise BondGraphError(f"{name} could not be simulated.", (name,))
    return best, solver


def _begin(
    base: FittedModel, trial: Trial, problem: FitProblem
) -> list[tuple[Array, Array]]:
    hypothesis = trial.hypothesis
    own = initial_states(base, problem.model.state_names)
    if not trial.starts:
        starts = thetas(base, hypothesis, problem, _own_starts(base, hypothesis))
        begun = [(theta, settled(base, problem, theta)) for theta in starts]
        # A slip begins with the model's own values as stated: so do its states.
        stated = any(name in base.values for name in hypothesis.starts[0])
        far = hypothesis.waits or hypothesis.repeats or stated
        if not far or not problem.model.n_states:
            return begun
        return [(theta, _or_early(problem, theta, states)) for theta, states in begun]
    begin = []
    for start in trial.starts:
        (theta,) = thetas(base, hypothesis, problem, (start.values,))
        states = start.initial
        if states is None or states.shape != own.shape:
            states, _ = settle(problem, theta, own, SETTLE_ITERATIONS)
        begin.append((theta, states))
    return begin


def _own_starts(
    base: FittedModel, hypothesis: Hypothesis
) -> tuple[Mapping[str, float], ...]:
    """Return a law's own starts, with an effect also from what is stated of the model.

    Where parameters of that have run away.
    """
    stated = run_away(base)
    if not stated:
        return hypothesis.starts
    silent = [dict(start) for start in hypothesis.silent_starts]
    some = [start for start in hypothesis.starts if dict(start) not in silent]
    return (*hypothesis.starts, *({**stated, **start} for start in some))


def _or_early(problem: FitProblem, theta: Array, states: Array) -> Array:
    """Return initial states by window: those given, or what the first samples say.

    The base model's are bent over the whole window by what it leaves out. From them a
    stop is never reached that was hit, for its motion ends before, and a weight that
    goes round is now ahead and now behind.
    """
    here = window_costs(problem, theta, states)
    early = first_guess(problem, theta)
    early, there = settle(problem, theta, early, SETTLE_ITERATIONS)
    return np.where((there.cost < here)[:, None], early, states)


def _at_its_starts(base: FittedModel, trial: Trial) -> float:
    """Return the share of the base's cost that the best start takes away as it is."""
    problem = pose_hypothesis(base, trial.hypothesis)
    costs = (_cost_at(problem, start) for start in _begin(base, trial, problem))
    return float(1.0 - min(costs) / base.optimum.cost)


def _cost_at(problem: FitProblem, start: tuple[Array, Array]) -> float:
    """Return the cost of a start as it is; infinite where it cannot be simulated."""
    cost = float(np.sum(window_costs(problem, *start)))
    return cost if np.isfinite(cost) else np.inf


def restored(base: FittedModel, trial: Trial) -> FittedModel:
    """Return the fitted model whose optimum is the trial's one start.

    One simulation: a fit is told by its parameters and initial states alone.
    """
    (start,) = trial.starts
    problem = pose_hypothesis(base, trial.hypothesis, start.solver)
    ((theta, initial),) = _begin(base, trial, problem)
    optimum = replace(
        minimise(problem, theta, initial, iterations=0), iterations=1, converged=True
    )
    graph = trial.hypothesis.apply(base.graph)
    return replace(base, graph=graph, problem=problem, optimum=optimum)


def errors_left_out(base: FittedModel, trial: Trial) -> Plain:
    """Return the errors, chunk by chunk, on data that the model was not fitted to."""
    fitted = restored(base, trial)
    errors = left_out_errors(fitted, trial.chunks)
    return {
        "chunks": errors.chunks.tolist(),
        "surprise": errors.surprise.tolist(),
        "samples": errors.samples,
    }
