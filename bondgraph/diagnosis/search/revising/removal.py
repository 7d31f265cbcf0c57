"""Removal: what was added early may be needless once something else has been added.

The first law found stands in for all that is missing; when the right one has been
added, the first may have nothing left to explain. Every earlier addition is taken out
again, the rest is refitted, and the two models are compared on left-out data.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bondgraph.diagnosis.evidence.gain import compare
from bondgraph.diagnosis.evidence.judged import Rule
from bondgraph.diagnosis.evidence.left_out import chunk_count, left_out_errors
from bondgraph.diagnosis.search.base.begun import initial_states
from bondgraph.diagnosis.search.trials.posing import suited
from bondgraph.errors import BondGraphError
from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.estimate import FittedModel, pose, prepare
from bondgraph.fitting.levenberg_marquardt import minimise
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.structure.parameters import Parameter

ITERATIONS = 30
TOLERANCE = 1e-4


SWALLOWED = 0.1
"""A law with less than this share of its strength left is not there any more."""

FADED, ERRORS = 0.5, 2.0
"""Nor one with less than this share left that so many standard errors do not tell from
none.
"""


@dataclass(frozen=True, slots=True)
class Pruned:
    """The model after removal, with the hypotheses kept and those taken out."""

    fitted: FittedModel
    kept: tuple[Hypothesis, ...]
    removed: tuple[Hypothesis, ...] = ()


def pruned(
    first: FittedModel,
    before: FittedModel,
    fitted: FittedModel,
    added: Sequence[Hypothesis],
    rule: Rule,
) -> Pruned:
    """Return the model without what left-out data do not support any more.

    What was found is only taken out where that leaves no more parameters than there
    were before the last addition, or where the last addition contains it: else a wider
    law has merely swallowed a plainer one of another kind.

    Parameters
    ----------
    first
        The model before any addition.
    before
        The model before the last addition.
    fitted
        The model with all of `added`, in their order; the last one stays.
    """
    kept, removed = list(added), []
    for hypothesis in added[:-1]:
        rest = [one for one in kept if one is not hypothesis]
        try:
            without = fitted_with(first, fitted, rest, {})
        except BondGraphError:
            continue  # A later addition changes what this one has added.
        plainer = len(without.problem.free) <= len(before.problem.free)
        within = added[-1].contains(hypothesis)
        if (plainer or within) and not _needed(without, fitted, rule):
            fitted, kept = without, rest
            removed.append(hypothesis)
    return Pruned(fitted, tuple(kept), tuple(removed))


def swallowed(
    before: FittedModel,
    after: FittedModel,
    earlier: Sequence[Hypothesis],
    nominal: Mapping[str, Parameter],
) -> str | None:
    """Return what was there of which an addition leaves nothing, if there is such.

    The addition is then no further physics but a rival, and has lost: against what was
    found before it, or against a law that the model has from the start.

    Parameters
    ----------
    before, after
        The model without the addition and with it.
    earlier
        What was found before it.
    nominal
        The parameters as the model's author gives them.
    """
    problem = after.problem
    free = problem.free_names
    stds = dict(zip(free, uncertainty(problem, after.optimum).std, strict=True))
    return gone_from(before.values, after.values, stds, earlier, nominal)


def gone_from(
    before: Mapping[str, float],
    after: Mapping[str, float],
    stds: Mapping[str, float],
    earlier: Sequence[Hypothesis],
    nominal: Mapping[str, Parameter],
) -> str | None:
    """Return what `swallowed` returns, from values and their standard errors."""

    def gone(name: str) -> bool:
        was, left = abs(before[name]), abs(after[name])
        in_doubt = left < ERRORS * stds.get(name, 0.0) and left < FADED * was
        return left < SWALLOWED * was or in_doubt

    for hypothesis in earlier:
        names = [n for n in hypothesis.strengths if n in after and n in before]
        if names and all(map(gone, names)):
            return f"{hypothesis.physics} at {hypothesis.place}"
    for name in stds:
        given = nominal.get(name)
        if given is None or not given.value or given.bounds[0] < 0.0:
            continue
        was, least = before.get(name, 0.0), SWALLOWED * given.value
        # A value that a lack had made too large, and that falls, is not gone, nor one
        # of which these recordings do not tell that it is.
        there = min(was, given.value)
        may_be = after[name] + ERRORS * stds[name] >= FADED * there
        if was >= least and after[name] < SWALLOWED * there and not may_be:
            return f"parameter {name}"
    return None


def fitted_with(
    first: FittedModel,
    fitted: FittedModel,
    hypotheses: Sequence[Hypothesis],
    values: Mapping[str, float],
) -> FittedModel:
    """Return the first model with the hypotheses, fitted from the other's values.

    Parameters
    ----------
    values
        Start values of what neither of the two models has.
    """
    graph = first.graph
    for hypothesis in hypotheses:
        graph = hypothesis.apply(graph)
    model, old = prepare(graph), fitted.problem
    problem = pose(graph, model, old.shots, fitted.settings, old.sigma)
    centre = dict(zip(old.model.parameter_names, old.start, strict=True))
    names = model.parameter_names
    start = [centre.get(n, v) for n, v in zip(names, problem.start, strict=True)]
    solver = suited(old.solver, model)
    problem = replace(problem, start=np.array(start), solver=solver)
    # What the additions had replaced has its value in the first model only.
    known = {**values, **first.values, **fitted.values}
    theta = np.array([known[names[i]] for i in problem.free])
    initial = initial_states(fitted, model.state_names)
    optimum = minimise(
        problem, theta, initial, iterations=ITERATIONS, tolerance=TOLERANCE
    )
    return replace(fitted, graph=graph, problem=problem, optimum=optimum)


def _needed(without: FittedModel, fitted: FittedModel, rule: Rule) -> bool:
    """Return whether left-out data are predicted clearly worse without it."""
    chunks = chunk_count(fitted)
    gain = compare(left_out_errors(without, chunks), left_out_errors(fitted, chunks))
    return gain.value > max(2.0 * gain.std, rule.materiality / 2)
