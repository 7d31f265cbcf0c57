"""Findings without a number are taken out, where what was found beside them suffices.

A law that came first may have lent its form to what a later one explains, and ends as
nothing: a spring too stiff to give way. Where the final fit tells none of its numbers
from none and fits as well without it, it is told as taken out again.
"""

from collections.abc import Sequence
from dataclasses import replace

from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.evidence.numbers import none_told
from bondgraph.diagnosis.search.base.horizons import sharpened
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.revising.plainer import as_good
from bondgraph.diagnosis.search.revising.removal import fitted_with, gone_from
from bondgraph.diagnosis.search.round_found import Round, chosen_in
from bondgraph.diagnosis.search.trials.vanished import is_nothing
from bondgraph.diagnosis.work.limit import Limit
from bondgraph.errors import BondGraphError
from bondgraph.fitting.certainty.uncertainty import uncertainty
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording


def without_hollow(
    rounds: Sequence[Round],
    final: FittedModel,
    recordings: Sequence[BoundRecording],
    options: Options,
    limit: Limit,
) -> tuple[list[Round], FittedModel]:
    """Return the rounds and the final model without findings that are nothing in it.

    The last finding stays: that it has no number is told.
    """
    left = list(rounds)
    for one in chosen_in(rounds):
        if limit.passed:
            break
        law = one.hypothesis
        others = [c.hypothesis for c in chosen_in(left) if c.hypothesis is not law]
        if not others or law.physics == CURVE or not ends_as_nothing(final, one):
            continue
        try:
            plain = fitted_with(rounds[0].base, final, others, {})
        except BondGraphError:
            continue  # A later law sits on it.
        plain = sharpened(plain, recordings, options, rounds[0].base)
        if as_good(plain, final, options.rule):
            last, final = left[-1], plain
            left[-1] = replace(last, removed=(*last.removed, law))
    return left, final


def ends_as_nothing(final: FittedModel, found: Candidate) -> bool:
    """Return whether a law has no number in the final fit, or no strength left there.

    A form that stays, the share of a hysteresis that is none, is not a number of it. A
    law that a later one has given another form has no number, and is there.
    """
    if not final.values.keys() >= set(found.hypothesis.parameters):
        return False
    if is_nothing(found.hypothesis, final.values):
        return True
    problem, theta = final.problem, final.optimum.theta
    stds = dict(
        zip(problem.free_names, uncertainty(problem, final.optimum).std, strict=True)
    )
    fits = zip(problem.free_names, map(float, theta), strict=True)
    own = found.hypothesis.parameters
    if none_told([(name, x, float(stds[name])) for name, x in fits if name in own]):
        return True
    was, now = found.fitted.values, final.values
    return gone_from(was, now, stds, [found.hypothesis], {}) is not None
