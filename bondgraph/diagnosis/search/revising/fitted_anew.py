"""A model fitted anew with what was added to it, where that leaves far less.

A law is fitted from where the model without it has ended. That may be a valley of its
own: to make up for a reading that is off, a machine of many numbers bends all of them.
Where much is left beside the right law, the model is fitted once more from the
beginning, over the horizon of the final one, and what was chosen is judged by what it
leaves there.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.evidence.confidence import probability
from bondgraph.diagnosis.evidence.gain import compare
from bondgraph.diagnosis.evidence.left_out import left_out_errors
from bondgraph.diagnosis.search.base.beyond_noise import left_beside
from bondgraph.diagnosis.search.base.horizons import refitted, sharpened
from bondgraph.diagnosis.search.considered import Setting
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.diagnosis.search.trials.trying import Start, Trial, restored
from bondgraph.fitting.estimate import FittedModel

FAR_LESS = 0.5
"""A fit that leaves less than this share of the squared error is in another valley."""


def fitted_anew(
    made: Sequence[Round], fitted: FittedModel, setting: Setting
) -> tuple[tuple[Round, ...], FittedModel]:
    """Return the rounds made last and the model after them, as fitted anew if better.

    Only where a single law was added and nothing was taken out, and where more is left
    than what would matter.
    """
    found, rule = made[-1], setting.options.rule
    alone = len(made) == 1 and found.chosen is not None and not found.removed
    little = left_beside(setting.base, fitted, setting.noise) <= rule.materiality
    if not alone or little:
        return tuple(made), fitted
    settings = replace(
        setting.options.settings,
        horizon=fitted.horizon,
        solver=fitted.problem.solver,
        hold=fitted.problem.hold,
    )
    long = sharpened(fitted, setting.recordings, setting.options, setting.base)
    anew = refitted(long, setting.recordings, settings)
    told = _judged_there(found, anew, setting)
    return (tuple(made), fitted) if told is None else ((told,), anew)


def _judged_there(found: Round, anew: FittedModel, setting: Setting) -> Round | None:
    """Return the round with its choice judged at another fit; None if no better there.

    At the weights of the round, in which all of its candidates are judged.
    """
    chosen = found.chosen
    assert chosen is not None
    start = Start.where_ended(anew)
    there = restored(found.base, Trial(chosen.candidate.hypothesis, (start,)))
    if not _typical(there) < FAR_LESS * _typical(chosen.candidate.fitted):
        return None
    chunks = chosen.errors.chunks.size
    before = left_out_errors(found.base, chunks)
    errors = replace(left_out_errors(there, chunks), noise=chosen.errors.noise)
    gain = compare(before, errors)
    if not gain.value > chosen.gain.value:
        return None
    again = replace(
        chosen,
        candidate=replace(chosen.candidate, fitted=there),
        errors=errors,
        gain=gain,
        reason=f"reduces the left-out error by {gain}",
    )
    judged = tuple(again if one is chosen else one for one in found.judged)
    sure = probability(again, judged, before, setting.options.rule)
    return replace(found, chosen=again, judged=judged, probability=sure)


def _typical(fitted: FittedModel) -> float:
    """Return the squared error over all outputs, each by its size: a geometric mean."""
    power = np.nanmean(fitted.residuals() ** 2, axis=0)
    return float(np.exp(np.mean(np.log(np.maximum(power, 1e-300)))))
