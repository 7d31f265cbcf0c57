"""Whether the data determine what a hypothesis adds.

A law whose own numbers nothing determines explains the data by something else that it
can also be: hysteresis over a distance never travelled is a spring. It is left aside in
favour of what it stands for. That beside it less is known of the model's own numbers is
nothing against it; that no number is left of it, nor of what was found before, is. A
strength of its own is another matter: that nothing
tells how steep an edge or how rigid a stop is says only that it is as steep as can be.

Two equal times look undetermined: near there only their sum shows, to first order. But
neither can be none. So a time that its standard error does not tell from none is set to
none, and the rest fitted: where that does clearly worse the time is there. Not where
the model's own fit has run away, unless the law brings it back: from there that says
nothing. Nor may it do as well at the longest that it may be: a state that never fades
is a constant of each recording.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.candidates import CURVE, Candidate, Rejected
from bondgraph.diagnosis.search.base.runaway import is_far, run_away
from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.physics.places.base import PROPOSED

AT_ONCE = "the time it would take to answer is not told from none"

LEAST = 1.05
"""A time within this factor of its lower bound is at it."""

CLEARLY = 1.5
"""A fit whose cost is larger by this factor is clearly worse. By less a second delay of
the same way is: few states draw a delay, and two of half the time do so more exactly.
"""

SURELY = 3.0
"""Standard errors: a time that is fewer of them long may be much longer."""

ITERATIONS = 12
"""Enough to see whether a model without a time does nearly as well."""

TRACE = 1e-3
"""A smaller share in a direction is none."""

REASON = "these recordings do not determine its parameters"


def undetermined_directions(fitted: FittedModel) -> int:
    """Return how many combinations of the parameters the recordings say nothing of."""
    return len(uncertainty(fitted.problem, fitted.optimum).null)


def determined(
    base: FittedModel, candidates: Sequence[Candidate]
) -> tuple[list[Candidate], tuple[Rejected, ...]]:
    """Return the candidates that add nothing undetermined, and the others.

    What was plugged wrong has no number of its own to be determined: that plugged right
    the recordings tell the model's own less well is how they were made.
    """
    if not candidates:
        return [], ()
    known = undetermined_directions(base)
    kept: list[Candidate] = []
    others: list[Rejected] = []
    for candidate in candidates:
        slip = candidate.hypothesis.is_slip
        told = _undetermined(candidate) <= known or _is_told(candidate, base)
        told |= _remembers(candidate) and not _stays_away(candidate, base)
        hollow = _is_too_late(candidate) or _leaves_nothing_told(candidate, base)
        if not (slip or told) or hollow:
            others.append(Rejected(candidate.hypothesis, REASON))
        elif _without_memory(candidate, base):
            others.append(Rejected(candidate.hypothesis, AT_ONCE))
        else:
            kept.append(candidate)
    return kept, tuple(others)


def _undetermined(candidate: Candidate) -> int:
    """Return how many directions nothing determines, own strengths left aside.

    A free curve may share its slope with a law that is there already: what counts is
    what both give together, though it may have taken all and left the other nothing.
    """
    problem, hypothesis = candidate.fitted.problem, candidate.hypothesis
    names, optimum = problem.free_names, candidate.fitted.optimum
    own = np.isin(names, hypothesis.strengths)
    others = np.abs(uncertainty(problem, optimum).null)
    if hypothesis.physics == CURVE:
        none = optimum.theta <= LEAST * problem.low[problem.free]
        own |= none & (problem.low[problem.free] >= 0.0)
    alone = others[:, own].max(axis=1, initial=0.0) <= TRACE
    mixed = others[:, ~own].max(axis=1, initial=0.0) > TRACE
    return int((alone if hypothesis.physics == CURVE else mixed).sum())


def _is_told(candidate: Candidate, base: FittedModel) -> bool:
    """Return whether nothing undetermined has a trace of the law's own numbers.

    Nor of a number that the model without it told from none, or left open: a law does
    not take the place of those. What stands for a law that is missing only seems to be
    told: a belt that gives way for a mast that sways. Beside the mast nothing is known
    of the belt. Nor is what has run away without the law a number that was told.
    """
    fitted = candidate.fitted
    null = np.abs(uncertainty(fitted.problem, fitted.optimum).null)
    most = null.max(axis=0, initial=0.0)
    names = np.array(fitted.problem.free_names)
    known = _told(base) - set(run_away(base))
    return not set(names[most > TRACE]) & (known | set(candidate.hypothesis.parameters))


def _told(fitted: FittedModel) -> set[str]:
    """Return the free parameters that are larger than their standard errors."""
    std = uncertainty(fitted.problem, fitted.optimum).std
    return {
        name
        for name, value, error in zip(
            fitted.problem.free_names, fitted.optimum.theta, std, strict=True
        )
        if not abs(value) <= error  # Of what is not told at all there is none.
    }


def _leaves_nothing_told(candidate: Candidate, base: FittedModel) -> bool:
    """Return whether no number of the law is told, nor any more of what was found."""
    parameters, names = base.graph.parameters, base.problem.free_names
    found = {name for name in names if parameters[name].source == PROPOSED}
    if not found:
        return False
    before, after = found & _told(base), _told(candidate.fitted)
    own = set(candidate.hypothesis.parameters)
    return bool(before) and not after & (before | own)


def _is_too_late(candidate: Candidate) -> bool:
    """Return whether a time of the law is as long as it may be, or as well were."""
    fitted = candidate.fitted
    problem, theta = fitted.problem, fitted.optimum.theta
    high = problem.high[problem.free]
    stds = uncertainty(problem, fitted.optimum).std
    for k in _times(candidate):
        known = SURELY * stds[k] <= theta[k] or not np.isfinite(high[k])
        if LEAST * theta[k] >= high[k] or not (known or _worse_at(fitted, k, high[k])):
            return True
    return False


def _without_memory(candidate: Candidate, base: FittedModel) -> bool:
    """Return whether a time of the law is as short as it may be, or hardly known.

    A law that answers at once is another law, for which memory is only a disguise.
    """
    fitted = candidate.fitted
    problem, stds = fitted.problem, uncertainty(fitted.problem, fitted.optimum).std
    for k in _times(candidate):
        value = float(fitted.optimum.theta[k])
        if value <= LEAST * float(problem.low[problem.free[k]]):
            return True
        known = stds[k] <= abs(value)
        away = not known and _stays_away(candidate, base)
        if not known and (away or not _worse_without(fitted, k)):
            return True
    return False


def _stays_away(candidate: Candidate, base: FittedModel) -> bool:
    """Return whether what has run away without the law is as far with it."""
    values = candidate.fitted.values
    return any(
        is_far(values[name], stated)
        for name, stated in run_away(base).items()
        if name in values
    )


def _remembers(candidate: Candidate) -> bool:
    """Return whether all that is undetermined are times, none of which can be none."""
    fitted, times = candidate.fitted, _times(candidate)
    null = np.abs(uncertainty(fitted.problem, fitted.optimum).null)
    own = np.isin(fitted.problem.free_names, list(candidate.hypothesis.parameters))
    own[list(times)] = False
    if not times or null[:, own].max(initial=0.0) > TRACE:
        return False
    return all(_worse_without(fitted, k) for k in times)


def _times(candidate: Candidate) -> tuple[int, ...]:
    """Return the positions, among what is free, of the law's own times."""
    fitted, own = candidate.fitted, candidate.hypothesis.parameters
    parameters = fitted.graph.parameters
    return tuple(
        k
        for k, name in enumerate(fitted.problem.free_names)
        if name in own and parameters[name].unit == "s"
    )


def _worse_without(fitted: FittedModel, k: int) -> bool:
    """Return whether the model does clearly worse where a time of it is none.

    As short as it may be, but no shorter than a sample: steps do not follow what is.
    """
    problem = fitted.problem
    low = float(problem.low[problem.free[k]])
    return _worse_at(fitted, k, max(low, problem.shots.interval))


def _worse_at(fitted: FittedModel, k: int, time: float) -> bool:
    """Return whether the model does clearly worse where a time of it is `time`."""
    problem, optimum = fitted.problem, fitted.optimum
    start = problem.start.copy()
    start[problem.free[k]] = time
    held = replace(problem, start=start, free=np.delete(problem.free, k))
    found = minimise(
        held, np.delete(optimum.theta, k), optimum.initial, iterations=ITERATIONS
    )
    return bool(np.isfinite(found.cost) and found.cost > CLEARLY * optimum.cost)
