"""Whether the data determine what a hypothesis adds.

A law whose own numbers nothing determines explains the data by something else that it
can also be: hysteresis over a distance never travelled is a spring. It is left aside in
favour of what it stands for. A strength of its own is another matter: that nothing
tells how steep an edge or how rigid a stop is says only that it is as steep as can be.
"""

from collections.abc import Sequence

import numpy as np

from bondgraph.diagnosis.candidates import CURVE, Candidate, Rejected
from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.estimate import FittedModel

AT_ONCE = "the time it would take to answer is not told from none"

LEAST = 1.05
"""A time within this factor of its lower bound is at it."""

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
        if not slip and _undetermined(candidate) > known:
            others.append(Rejected(candidate.hypothesis, REASON))
        elif _without_memory(candidate):
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


def _without_memory(candidate: Candidate) -> bool:
    """Return whether a time of the law is as short as it may be, or hardly known.

    A law that answers at once is another law, for which memory is only a disguise.
    """
    fitted, own = candidate.fitted, candidate.hypothesis.parameters
    problem, stds = fitted.problem, uncertainty(fitted.problem, fitted.optimum).std
    for k, i in enumerate(problem.free):
        name = problem.model.parameter_names[i]
        if name in own and fitted.graph.parameters[name].unit == "s":
            value = float(fitted.optimum.theta[k])
            short = value <= LEAST * float(problem.low[i])
            if short or not stds[k] <= abs(value):
                return True
    return False
