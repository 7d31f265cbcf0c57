"""Evidence as it is shown: every law that was judged, with what speaks for it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.evidence.leads import clearly_better
from bondgraph.diagnosis.records import Evidence, Support
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.round_found import Round
from bondgraph.fitting.long_runs import simulate_whole
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.spread import changes, spread


def shown(judged: Judged, held_out: Sequence[BoundRecording]) -> Evidence:
    """Return the evidence with its error on the held-out recordings, to show."""
    simulated = simulate_whole(judged.candidate.fitted, held_out)
    return replace(_as_evidence(judged), held_out_nrmse=simulated.score.nrmse)


def wider_than_chosen(found: Round, options: Options) -> list[Judged]:
    """Return judged laws that contain the chosen one and predict no better."""
    chosen = found.chosen
    return [
        j
        for j in found.judged
        if chosen is not None
        and j.candidate.hypothesis.contains(chosen.candidate.hypothesis)
        and (
            j.support is Support.REFUTED
            or j.open
            or not clearly_better(j, chosen, options.rule)
        )
    ]


def hardly_supported(
    found: Round, options: Options, held_out: Sequence[BoundRecording]
) -> list[Evidence]:
    """Return what contains the chosen law and predicts hardly better, and why."""
    assert found.chosen is not None
    reason = (
        "hardly supported: it does not predict left-out data better than "
        f"{found.chosen.name}, which it contains"
    )
    return [
        shown(j, held_out)
        if j.open
        else replace(shown(j, held_out), support=Support.REFUTED, reason=reason)
        for j in wider_than_chosen(found, options)
    ]


def _as_evidence(judged: Judged) -> Evidence:
    fitted = judged.candidate.fitted
    residuals = fitted.residuals()
    outputs = fitted.problem.shots.outputs
    moving = changes(outputs)
    relative = residuals[:, moving] / spread(outputs)[moving]
    nrmse = np.sqrt(np.nanmean(relative**2)) if moving.any() else np.nan
    return Evidence(
        physics=judged.physics,
        place=judged.place,
        law=str(judged.candidate.hypothesis.law),
        support=judged.support,
        gain=judged.gain.value,
        gain_std=judged.gain.std,
        train_nrmse=float(nrmse),
        reason=judged.reason,
        domain=judged.domain,
    )


def all_evidence(rounds: Sequence[Round]) -> tuple[Evidence, ...]:
    """Return all judged candidates of all rounds, best first within a round."""
    return tuple(
        _as_evidence(judged)
        for found in rounds
        # Rounded: equals stay in the order of the library, whatever names they have.
        for judged in sorted(found.judged, key=lambda j: -round(j.gain.value, 9))
    )
