"""Findings, with what speaks for each and what cannot be told from it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bondgraph.diagnosis.answer.showing import simulate_whole
from bondgraph.diagnosis.answer.wording import finding_statement, hedged, name_of
from bondgraph.diagnosis.evidence.confidence import beyond_resampling
from bondgraph.diagnosis.evidence.decision import (
    Judged,
    alternatives_to,
    clearly_better,
)
from bondgraph.diagnosis.evidence.gain import MERE_SHAPE, beside_earlier
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Evidence, Finding, Support
from bondgraph.diagnosis.search.candidates import CURVE
from bondgraph.diagnosis.search.one_round import Round
from bondgraph.diagnosis.search.options import Options
from bondgraph.fitting.result import FitResult
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.spread import changes, spread

MUCH_REMAINING = 0.1
"""More than this share of the error is worth saying that it remains."""

ERRORS = 2.0
"""A number within so many standard errors of none is not told from it."""

EVEN = 0.5
"""What is less probable than not is told as what may be."""

HOLLOW = 0.5
"""What is left of a probability where nothing tells a number. A judgement: of 45 named
findings on concealed cases none was so; of those in recordings of strangers half were
wrong.
"""

MENDS_SHAPE = (
    " It takes away little beside what was found before, and may only mend its shape."
)


def findings_of(
    accepted: Sequence[Round],
    after: FitResult,
    held_out: Sequence[BoundRecording],
    options: Options,
) -> tuple[list[Finding], dict[str, Sequence[Judged]]]:
    """Return the findings, and for each element what the data do not tell from it."""
    findings: list[Finding] = []
    others: dict[str, Sequence[Judged]] = {}
    made = [one.chosen for one in accepted if one.chosen is not None]
    shares = beside_earlier([chosen.gain.value for chosen in made])
    # What was found as well is not what a finding may be instead.
    there = {(chosen.physics, chosen.place) for chosen in made}
    for found, share in zip(accepted, shares, strict=True):
        chosen = found.chosen
        assert chosen is not None
        close = [
            j
            for j in alternatives_to(chosen, found.judged, options.rule)
            if (j.physics, j.place) not in there - {(chosen.physics, chosen.place)}
        ]
        hypothesis = chosen.candidate.hypothesis
        same = [j.place for j in close if j.physics == chosen.physics]
        elsewhere = (p for p in (*same, *hypothesis.also) if p != chosen.place)
        places = tuple(dict.fromkeys(elsewhere))
        estimates = tuple(e for e in after.estimates if e.name in hypothesis.parameters)
        findings.append(
            Finding(
                physics=chosen.physics,
                place=chosen.place,
                element=hypothesis.element,
                statement=finding_statement(chosen, places, close, estimates)
                + nearest(found)
                + (MENDS_SHAPE if share < MERE_SHAPE else ""),
                law=str(hypothesis.law),
                indistinguishable_places=places,
                alternatives=(
                    *(_shown(j, held_out) for j in close),
                    *_hardly_supported(found, options, held_out),
                ),
                estimates=estimates,
                probability=(
                    None
                    if found.probability is None
                    else share * beyond_resampling(found.probability, chosen.errors)
                ),
            )
        )
        others[hypothesis.element] = close
    return findings, others


def nearest(found: Round) -> str:
    """Return which law with a name comes nearest to a curve, if one is supported."""
    curve = found.chosen
    assert curve is not None
    named = [
        j
        for j in found.judged
        if j.support is Support.SUPPORTED
        and j.physics != CURVE
        and j.place == curve.place
    ]
    if curve.physics != CURVE or not named:
        return ""
    best = max(named, key=lambda j: j.gain.value)
    return (
        f" Of the laws with a name {name_of(best.physics)} comes nearest: it takes "
        f"away {100 * best.gain.value:.0f} % of the error on left-out data, the curve "
        f"{100 * curve.gain.value:.0f} %."
    )


def _shown(judged: Judged, held_out: Sequence[BoundRecording]) -> Evidence:
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


def _hardly_supported(
    found: Round, options: Options, held_out: Sequence[BoundRecording]
) -> list[Evidence]:
    assert found.chosen is not None
    reason = (
        "hardly supported: it does not predict left-out data better than "
        f"{name_of(found.chosen.physics)}, which it contains"
    )
    return [
        _shown(j, held_out)
        if j.open
        else replace(_shown(j, held_out), support=Support.REFUTED, reason=reason)
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
    )


def all_evidence(rounds: Sequence[Round]) -> tuple[Evidence, ...]:
    """Return all judged candidates of all rounds, best first within a round."""
    return tuple(
        _as_evidence(judged)
        for found in rounds
        # Rounded: equals stay in the order of the library, whatever names they have.
        for judged in sorted(found.judged, key=lambda j: -round(j.gain.value, 9))
    )


def remaining(rounds: Sequence[Round], floor: Mapping[str, float]) -> float:
    """Return the share of the left-out error that the findings leave beyond noise.

    From the first model to the last one: what was found on the way may have been taken
    out again, and its gain with it.
    """
    made = [found.chosen for found in rounds if found.chosen is not None]
    if not made:
        return 1.0
    whole = _per_sample(made[0].errors) / max(1.0 - made[0].gain.value, 1e-12)
    share = _per_sample(made[-1].errors) / whole if whole > 0.0 else 1.0
    base = rounds[0].base
    scale = base.problem.sigma
    power = np.nanmean((base.residuals() / scale) ** 2, axis=0)
    noise = (np.array([floor[name] for name in floor]) / scale) ** 2
    # The gains are of the errors of all outputs together, weighted by these scales.
    beyond = 1.0 - float(np.sum(np.minimum(noise, power)) / np.sum(power))
    return max(share - (1.0 - beyond), 0.0) / max(beyond, 1e-12)


def doubted(findings: Sequence[Finding], left: float) -> list[Finding]:
    """Return the findings, less probable where much remains beside them.

    What remains may be the cause, and have bent a law of the library to it. And a law
    of which no number is told from none lends its form to something else.

    Parameters
    ----------
    left
        The share of the error that the findings leave beyond noise.
    """
    believed = 1.0 if left < MUCH_REMAINING else 1.0 - min(left, 1.0)
    told = []
    for finding in findings:
        if is_hollow(finding):
            believed *= HOLLOW  # What is found later is built on it.
        told.append(_less_probable(finding, believed))
    return told


def _less_probable(finding: Finding, share: float) -> Finding:
    """Return a finding of which only that share of its probability is left."""
    if finding.probability is None:
        return finding
    sure, said = share * finding.probability, finding.statement
    said = hedged(said) if sure < EVEN else said
    return replace(finding, probability=sure, statement=said)


def is_hollow(finding: Finding) -> bool:
    """Return whether nothing tells a single number of a law with a name from none."""
    numbers = [(one.value, one.std) for one in finding.estimates]
    return finding.physics != CURVE and none_told(numbers)


def none_told(numbers: Sequence[tuple[float, float | None]]) -> bool:
    """Return whether there are numbers, each with its error, and none is told from 0.

    An error that is not known, None or not a number, tells nothing.
    """
    return bool(numbers) and not any(
        std is not None and abs(value) > ERRORS * std for value, std in numbers
    )


def _per_sample(errors: LeftOutErrors) -> float:
    return float(errors.chunks.sum()) / max(errors.samples, 1)
