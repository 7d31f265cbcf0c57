"""The conclusion: one verdict with its sentence, from all that was found and checked.

Each check may only take confidence away from what the search has found.
"""

from collections.abc import Sequence

import numpy as np

from bondgraph.diagnosis.adequacy.adequacy import adequacy
from bondgraph.diagnosis.adequacy.records import Adequacy
from bondgraph.diagnosis.answer.carrying import Shown, worse_held_out
from bondgraph.diagnosis.answer.humming import with_hum
from bondgraph.diagnosis.answer.long_run import off_in_the_long_run
from bondgraph.diagnosis.answer.one_by_one import differs_between
from bondgraph.diagnosis.answer.verdict import (
    cut_short,
    hardly_believed,
    not_simulated,
    verdict_of,
    with_undecided,
    with_values,
    without_size,
)
from bondgraph.diagnosis.evidence.leftover import noise_floor
from bondgraph.diagnosis.records import Finding, Verdict
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.round_found import Round, accepted
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording


def concluded(
    rounds: Sequence[Round],
    final: FittedModel,
    findings: Sequence[Finding],
    wrong: Sequence[Finding],
    left: float,
    shown: Shown,
    recordings: Sequence[BoundRecording],
    options: Options,
) -> tuple[Verdict, str]:
    """Return the verdict and its sentence.

    Parameters
    ----------
    final
        The model with all findings.
    findings, wrong
        Laws that were found, and stated values that the fit has left.
    left
        The share of the error that the findings leave beyond noise.
    """
    base, made, floor = rounds[0].base, accepted(rounds), noise_floor(recordings)
    checked = _checked(base, recordings, made)
    verdict, statement = verdict_of(
        findings, base, floor, rounds[0], left, checked, options.rule
    )
    statement = with_undecided(verdict, statement, rounds[-1], options.rule)
    before, after = shown.held_out.before.nrmse, shown.held_out.after.nrmse
    if np.isfinite(before) and not np.isfinite(after):
        verdict, statement = not_simulated(verdict, statement)
    verdict, statement = worse_held_out(verdict, statement, shown)
    verdict, statement = without_size(verdict, statement, findings)
    verdict, statement = hardly_believed(verdict, statement, findings)
    verdict, statement = cut_short(verdict, statement, rounds)
    if verdict is Verdict.ADEQUATE:
        off = off_in_the_long_run(base, recordings, floor)
        if off is not None:
            verdict, statement = Verdict.CANNOT_TELL, off
    verdict, statement = with_hum(verdict, statement, final)
    if verdict in (Verdict.UNEXPLAINED, Verdict.CANNOT_TELL):
        differs = differs_between(base, recordings, floor)
        statement = f"{statement} {differs}".rstrip()
    return with_values(verdict, statement, wrong) if wrong else (verdict, statement)


def _checked(
    base: FittedModel, recordings: Sequence[BoundRecording], made: Sequence[Round]
) -> Adequacy | None:
    """Return whether the base model leaves more than noise, where nothing was found."""
    steady = any(recording.steady for recording in recordings)
    if made or steady or not base.problem.model.n_states:
        return None
    return adequacy(base, recordings)
