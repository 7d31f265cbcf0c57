"""The answer: what the search found, told in records, numbers and sentences."""

import platform
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.decision import Judged, alternatives_to, clearly_better
from bondgraph.diagnosis.records import (
    Comparison,
    Diagnosis,
    Evidence,
    Finding,
    Verdict,
)
from bondgraph.diagnosis.search import Options, Round
from bondgraph.diagnosis.showing import recovered_law, simulate_whole, traces
from bondgraph.diagnosis.wording import finding_statement, name_of, next_experiment
from bondgraph.fitting.estimate import FittedModel, fit_model, report
from bondgraph.fitting.result import FitResult
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.noise import estimate_noise
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
ADEQUATE_RATIO = 3.0
"""A residual below this many times the noise floor needs no more explanation."""


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
    accepted = [r for r in rounds if r.chosen is not None]
    findings, others = _findings(accepted, after, options)
    verdict, statement = _verdict(findings, base, floor, rounds[0])
    candidates = _evidence(rounds)
    shown = [
        recovered_law(r.base, r.chosen.candidate, final, recordings)
        for r in accepted
        if r.chosen is not None
    ]
    return Diagnosis(
        verdict=verdict,
        statement=statement,
        findings=tuple(findings),
        train=_comparison(base, final, recordings),
        held_out=_comparison(base, final, held_out),
        noise_floor=floor,
        false_alarm_probability=options.rule.false_alarm_probability,
        next_experiment=next_experiment(findings, others, base),
        candidates=candidates,
        blame=_blame(rounds[0]),
        fit_before=before,
        fit_after=after,
        fit_all=_delivered(final, recordings, held_out, options),
        traces=traces(base, final, held_out),
        recovered=tuple(law for law in shown if law is not None),
        notes=_notes(rounds, after, options),
        provenance=_provenance(recordings, held_out, options, final),
    )


def _delivered(
    final: FittedModel,
    recordings: Sequence[BoundRecording],
    held_out: Sequence[BoundRecording],
    options: Options,
) -> FitResult:
    """Return the final model refitted on everything recorded, to be used from here."""
    everything = (*recordings, *held_out)
    settings = replace(options.settings, horizon=final.horizon)
    graph = final.graph.with_parameters(final.values)
    return report(fit_model(graph, everything, settings), final.graph, everything)


def _findings(
    accepted: Sequence[Round], after: FitResult, options: Options
) -> tuple[list[Finding], Mapping[str, Sequence[Judged]]]:
    findings, others = [], {}
    for found in accepted:
        chosen = found.chosen
        assert chosen is not None
        close = alternatives_to(chosen, found.judged, options.rule)
        places = tuple(
            dict.fromkeys(
                j.place
                for j in close
                if j.physics == chosen.physics and j.place != chosen.place
            )
        )
        hypothesis = chosen.candidate.hypothesis
        estimates = tuple(e for e in after.estimates if e.name in hypothesis.parameters)
        findings.append(
            Finding(
                physics=chosen.physics,
                place=chosen.place,
                element=hypothesis.element,
                statement=finding_statement(chosen, places, close, estimates),
                law=str(hypothesis.law),
                indistinguishable_places=places,
                alternatives=tuple(_as_evidence(j, found.base) for j in close),
                estimates=estimates,
            )
        )
        others[hypothesis.element] = close
    return findings, others


def _as_evidence(judged: Judged, base: FittedModel) -> Evidence:
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
        _as_evidence(judged, found.base)
        for found in rounds
        for judged in sorted(found.judged, key=lambda j: -j.gain.value)
    )


def noise_floor(recordings: Sequence[BoundRecording]) -> dict[str, float]:
    """Return the measurement noise of each output, the largest over recordings."""
    return {
        name: max((std for std, _ in _noise(recordings, i)), default=0.0)
        for i, name in enumerate(recordings[0].output_names)
    }


def white_noise(recordings: Sequence[BoundRecording]) -> Array:
    """Return the noise of each output where it is certain: 0 unless it looks white.

    Fast motion looks like noise to an estimate that sees one channel; only where the
    estimate agrees with itself may it excuse a residual.
    """
    certain = [
        [std if white else 0.0 for std, white in _noise(recordings, output)]
        for output in range(len(recordings[0].output_names))
    ]
    return np.array([min(stds, default=0.0) for stds in certain])


def _noise(
    recordings: Sequence[BoundRecording], output: int
) -> list[tuple[float, bool]]:
    estimates = [
        estimate_noise(r.time, r.outputs[:, output]) for r in recordings if not r.steady
    ]
    return [(estimate.std, estimate.white) for estimate in estimates]


def _verdict(
    findings: Sequence[Finding],
    base: FittedModel,
    floor: Mapping[str, float],
    first: Round,
) -> tuple[Verdict, str]:
    if any(f.physics != "unknown_relation" for f in findings):
        return Verdict.PHYSICS_MISSING, " ".join(f.statement for f in findings)
    if findings:
        return Verdict.UNEXPLAINED, " ".join(f.statement for f in findings)
    undecided = [j for j in first.judged if j.support.value == "undecided"]
    ratios = residual_over_noise(base, floor)
    worst = max(ratios.values(), default=0.0)
    tried = first.tried
    if undecided and worst > ADEQUATE_RATIO:
        names = ", ".join(
            dict.fromkeys(f"{name_of(j.physics)} at {j.place}" for j in undecided[:3])
        )
        return Verdict.CANNOT_TELL, (
            f"These recordings do not decide: {names} would help, but not reliably on "
            "data that were left out."
        )
    if worst > ADEQUATE_RATIO:
        return Verdict.UNEXPLAINED, (
            f"The residual is {worst:.1f} times the measurement noise, and none of the "
            f"{tried} candidates explains it on data that were left out."
        )
    return Verdict.ADEQUATE, (
        "Nothing is missing that these recordings could show: the residual is "
        f"{worst:.1f} times the measurement noise, and none of {tried} candidates "
        "improves the prediction of data that were left out."
    )


def residual_over_noise(
    fitted: FittedModel, floor: Mapping[str, float]
) -> dict[str, float]:
    """Return per output how many times the residual exceeds the noise floor."""
    rms = np.sqrt(np.nanmean(fitted.residuals() ** 2, axis=0))
    names = fitted.problem.model.output_names
    return {
        name: float(size / floor[name])
        for name, size in zip(names, rms, strict=True)
        if floor[name] > 0.0
    }


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
    for candidate in first.screened:
        place = candidate.hypothesis.place
        blame[place] = max(blame[place], candidate.reduction(first.base))
    return blame


def _notes(
    rounds: Sequence[Round], after: FitResult, options: Options
) -> tuple[str, ...]:
    notes = [f"Not identifiable: {sentence}." for sentence in after.unidentifiable]
    for found in rounds:
        for rejected in found.rejected:
            hypothesis = rejected.hypothesis
            notes.append(
                f"{hypothesis.physics} at {hypothesis.place} was not tried: "
                f"{rejected.reason}"
            )
        for judged in found.judged:
            chosen = found.chosen
            if chosen is None or judged is chosen:
                continue
            wider = chosen.physics in judged.candidate.hypothesis.extends
            if wider and not clearly_better(judged, chosen, options.rule):
                notes.append(
                    f"{_sentence_start(judged)} instead is hardly supported: it does "
                    f"not predict left-out data better than {name_of(chosen.physics)}."
                )
    return tuple(dict.fromkeys(notes))


def _sentence_start(judged: Judged) -> str:
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
        "solver": str(options.settings.solver),
        "inputs": options.settings.hold.value,
        "materiality": options.rule.materiality,
    }
