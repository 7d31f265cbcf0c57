"""The answer: what the search found, told in records, numbers and sentences."""

import platform
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np

from bondgraph.diagnosis.adequacy.adequacy import adequacy
from bondgraph.diagnosis.adequacy.records import Adequacy
from bondgraph.diagnosis.answer.showing import recovered_law, simulate_whole, traces
from bondgraph.diagnosis.answer.stated import contradicted
from bondgraph.diagnosis.answer.verdict import (
    noise_floor,
    not_simulated,
    verdict_of,
    with_values,
)
from bondgraph.diagnosis.answer.wording import (
    finding_statement,
    name_of,
    next_experiment,
)
from bondgraph.diagnosis.evidence.decision import (
    Judged,
    alternatives_to,
    clearly_better,
)
from bondgraph.diagnosis.records import (
    Comparison,
    Diagnosis,
    Evidence,
    Finding,
    Support,
)
from bondgraph.diagnosis.search.candidates import Candidate
from bondgraph.diagnosis.search.rounds import Options, Round
from bondgraph.fitting.estimate import FittedModel, fit_model, report
from bondgraph.fitting.result import FitResult
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

DRAWN_RIVALS = 4
"""How many other laws are drawn over the cloud of a recovered one."""


def answer(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    held_out: Sequence[BoundRecording],
    rounds: Sequence[Round],
    final: FittedModel,
    options: Options,
) -> Diagnosis:
    """Return the diagnosis that the rounds of a search amount to."""
    base, floor = rounds[0].base, noise_floor(recordings)
    before, after = report(base, graph, recordings), report(final, graph, recordings)
    accepted = _accepted(rounds)
    findings, others = _findings(accepted, after, held_out, options)
    trained = _comparison(base, final, recordings)
    remaining = _remaining(accepted, floor)
    if not trained.after.nrmse < trained.before.nrmse:
        remaining = max(remaining, 1.0)
    verdict, statement = verdict_of(
        findings,
        base,
        floor,
        rounds[0],
        remaining,
        _checked(base, recordings, accepted),
    )
    shown = _comparison(base, final, held_out)
    if not np.isfinite(shown.after.nrmse) and np.isfinite(shown.before.nrmse):
        verdict, statement = not_simulated(verdict, statement)
    wrong = contradicted(graph, after.estimates)
    if wrong:
        verdict, statement = with_values(verdict, statement, wrong)
    candidates = _evidence(rounds)
    laws = [
        recovered_law(r.base, r.chosen.candidate, final, recordings, _rivals(r))
        for r in accepted
        if r.chosen is not None
    ]
    return Diagnosis(
        verdict=verdict,
        statement=statement,
        findings=(*findings, *wrong),
        train=trained,
        held_out=shown,
        noise_floor=floor,
        false_alarm_probability=options.rule.false_alarm_probability,
        next_experiment=next_experiment(findings, others, base),
        candidates=candidates,
        blame=_blame(rounds[0]),
        fit_before=before,
        fit_after=after,
        fit_all=_delivered(graph, final, (*recordings, *held_out), options),
        traces=traces(base, final, held_out),
        recovered=tuple(law for law in laws if law is not None),
        notes=_notes(rounds, after, options),
        provenance=_provenance(recordings, held_out, options, final),
    )


def _accepted(rounds: Sequence[Round]) -> list[Round]:
    """Return the rounds whose addition was made and stayed."""
    removed = {id(h) for found in rounds for h in found.removed}
    return [
        found
        for found in rounds
        if found.chosen is not None
        and id(found.chosen.candidate.hypothesis) not in removed
    ]


def _rivals(found: Round) -> list[Candidate]:
    """Return the best of each other physics judged at the chosen place."""
    chosen = found.chosen
    assert chosen is not None
    best: dict[str, Judged] = {}
    for judged in sorted(found.judged, key=lambda j: -j.gain.value):
        if judged.place == chosen.place and judged.physics != chosen.physics:
            best.setdefault(judged.physics, judged)
    return [judged.candidate for judged in list(best.values())[:DRAWN_RIVALS]]


def _checked(
    base: FittedModel, recordings: Sequence[BoundRecording], accepted: Sequence[Round]
) -> Adequacy | None:
    """Return whether the base model leaves more than noise, where nothing was found."""
    steady = any(recording.steady for recording in recordings)
    if accepted or steady or not base.problem.model.n_states:
        return None
    return adequacy(base, recordings)


def _delivered(
    start: FinishedGraph,
    final: FittedModel,
    everything: Sequence[BoundRecording],
    options: Options,
) -> FitResult:
    """Return the final model refitted on everything recorded, to be used from here.

    Its estimates tell the user's own start values, where the user's model has them.
    """
    settings = replace(
        options.settings,
        horizon=final.horizon,
        solver=final.problem.solver,
        hold=final.problem.hold,
    )
    graph = final.graph.with_parameters(final.values)
    return report(fit_model(graph, everything, settings), start, everything)


def _findings(
    accepted: Sequence[Round],
    after: FitResult,
    held_out: Sequence[BoundRecording],
    options: Options,
) -> tuple[list[Finding], dict[str, Sequence[Judged]]]:
    """Return the findings, and for each element what the data do not tell from it."""
    findings: list[Finding] = []
    others: dict[str, Sequence[Judged]] = {}
    for found in accepted:
        chosen = found.chosen
        assert chosen is not None
        close = alternatives_to(chosen, found.judged, options.rule)
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
                statement=finding_statement(chosen, places, close, estimates),
                law=str(hypothesis.law),
                indistinguishable_places=places,
                alternatives=(
                    *(_shown(j, held_out) for j in close),
                    *_hardly_supported(found, options, held_out),
                ),
                estimates=estimates,
                probability=found.probability,
            )
        )
        others[hypothesis.element] = close
    return findings, others


def _shown(judged: Judged, held_out: Sequence[BoundRecording]) -> Evidence:
    """Return the evidence with its error on the held-out recordings, to show."""
    simulated = simulate_whole(judged.candidate.fitted, held_out)
    return replace(_as_evidence(judged), held_out_nrmse=simulated.score.nrmse)


def _wider(found: Round, options: Options) -> list[Judged]:
    """Return judged laws that contain the chosen one and predict no better."""
    chosen = found.chosen
    return [
        j
        for j in found.judged
        if chosen is not None
        and j.place == chosen.place
        and chosen.physics in j.candidate.hypothesis.extends
        and (
            j.support is Support.REFUTED or not clearly_better(j, chosen, options.rule)
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
        replace(_shown(j, held_out), support=Support.REFUTED, reason=reason)
        for j in _wider(found, options)
    ]


def _as_evidence(judged: Judged) -> Evidence:
    fitted = judged.candidate.fitted
    residuals = fitted.residuals()
    spread = np.nanstd(fitted.problem.shots.outputs, axis=0)
    nrmse = np.sqrt(np.nanmean((residuals / np.where(spread > 0, spread, 1.0)) ** 2))
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


def _evidence(rounds: Sequence[Round]) -> tuple[Evidence, ...]:
    """Return all judged candidates of all rounds, best first within a round."""
    return tuple(
        _as_evidence(judged)
        for found in rounds
        for judged in sorted(found.judged, key=lambda j: -j.gain.value)
    )


def _remaining(accepted: Sequence[Round], floor: Mapping[str, float]) -> float:
    """Return the share of the left-out error that the findings leave beyond noise."""
    share = 1.0
    for found in accepted:
        assert found.chosen is not None
        share *= 1.0 - found.chosen.gain.value
    if not accepted:
        return share
    base = accepted[0].base
    scale = base.problem.sigma
    power = np.nanmean((base.residuals() / scale) ** 2, axis=0)
    noise = (np.array([floor[name] for name in floor]) / scale) ** 2
    # The gains are of the errors of all outputs together, weighted by these scales.
    beyond = 1.0 - float(np.sum(np.minimum(noise, power)) / np.sum(power))
    return max(share - (1.0 - beyond), 0.0) / max(beyond, 1e-12)


def _comparison(
    base: FittedModel, final: FittedModel, recordings: Sequence[BoundRecording]
) -> Comparison:
    return Comparison(
        before=simulate_whole(base, recordings).score,
        after=simulate_whole(final, recordings).score,
    )


def _blame(first: Round) -> dict[str, float]:
    """Return for each junction the best training improvement a law there gives."""
    blame = {junction.name: 0.0 for junction in first.base.graph.junctions}
    for promised in first.promised:
        place = promised.hypothesis.place
        if place not in first.base.graph.by_name:
            continue  # An input channel or a sensor is no place of the picture.
        share = min(max(promised.reduction, 0.0), 1.0)
        blame[place] = max(blame.get(place, 0.0), share)
    return blame


def _notes(
    rounds: Sequence[Round], after: FitResult, options: Options
) -> tuple[str, ...]:
    notes = [f"Not identifiable: {sentence}." for sentence in after.unidentifiable]
    for found in rounds:
        for rejected in found.rejected:
            hypothesis = rejected.hypothesis
            notes.append(
                f"{_sentence_start(hypothesis)} was left aside: {rejected.reason}"
            )
        notes += [
            f"{h.physics} at {h.place} was added first and taken out again: beside "
            "what was added later it does not predict left-out data better."
            for h in found.removed
        ]
        for judged in _wider(found, options):
            assert found.chosen is not None
            notes.append(
                f"{_sentence_start(judged)} instead is hardly supported: it does not "
                f"predict left-out data better than {name_of(found.chosen.physics)}."
            )
    return tuple(dict.fromkeys(notes))


def _sentence_start(judged: Judged | Hypothesis) -> str:
    name = name_of(judged.physics)
    return f"{name[:1].upper()}{name[1:]} at {judged.place}"


def _provenance(
    recordings: Sequence[BoundRecording],
    held_out: Sequence[BoundRecording],
    options: Options,
    final: FittedModel,
) -> dict[str, Any]:
    packages = ("bondgraph-workbench", "numpy", "scipy", "sympy", "numba")
    return {
        "versions": {name: version(name) for name in packages}
        | {"python": platform.python_version()},
        "training": [{"name": r.name, "sha256": r.sha256} for r in recordings],
        "held_out": [{"name": r.name, "sha256": r.sha256} for r in held_out],
        "horizon": str(final.horizon),
        "solver": str(final.problem.solver),
        "inputs": final.problem.hold.value,
        "materiality": options.rule.materiality,
    }
