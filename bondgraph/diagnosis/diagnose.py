"""`diagnose`: from a model and recordings to a ranked, calibrated answer.

1. Fit the base model: wrong parameters are fitted away, what remains is structure.
2. Propose every hypothesis of the library at every junction; screen by short refits.
3. Judge the best by left-out chunks of the *training* recordings; accept the simplest
   that is supported; repeat on the improved model until nothing more is.
4. Open the held-out recordings once, to show. No choice has seen them.
"""

import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from typing import Any

import numpy as np

from bondgraph.diagnosis.candidates import (
    Candidate,
    Rejected,
    complete,
    propose_all,
    screen,
)
from bondgraph.diagnosis.decision import (
    Judged,
    Rule,
    alternatives_to,
    best_supported,
    clearly_better,
    judge,
)
from bondgraph.diagnosis.evidence import left_out_errors
from bondgraph.diagnosis.records import (
    Comparison,
    Diagnosis,
    Evidence,
    Finding,
    Verdict,
)
from bondgraph.diagnosis.showing import recovered_law, simulate_whole, traces
from bondgraph.diagnosis.wording import finding_statement, name_of, next_experiment
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import (
    FittedModel,
    Settings,
    choose_horizon,
    fit_model,
    report,
)
from bondgraph.fitting.horizon import Automatic
from bondgraph.fitting.result import FitResult
from bondgraph.physics.hypothesis import AbstractPhysics
from bondgraph.physics.library import LIBRARY
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.noise import noise_std
from bondgraph.structure.graph import FinishedGraph

ADEQUATE_RATIO = 3.0
"""A residual below this many times the noise floor needs no more explanation."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """Choices of a diagnosis.

    Parameters
    ----------
    settings
        Of the fits.
    rule
        When a candidate counts.
    library
        The physics considered.
    judged
        How many candidates per round are judged on left-out data.
    most_findings
        Stop after so many.
    """

    settings: Settings = field(default_factory=Settings)
    rule: Rule = field(default_factory=Rule)
    library: tuple[AbstractPhysics, ...] = LIBRARY
    judged: int = 10
    most_findings: int = 3


@dataclass(frozen=True, slots=True)
class _Round:
    """What one round of search found."""

    judged: tuple[Judged, ...]
    screened: tuple[Candidate, ...]
    rejected: tuple[Rejected, ...]
    chosen: Judged | None
    base: FittedModel


def diagnose(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    *,
    held_out: Sequence[BoundRecording],
    options: Options | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Diagnosis:
    """Say whether physics is missing from a model, where and which, and show it.

    Parameters
    ----------
    graph
        The base model with starting values for its parameters.
    recordings
        Training recordings: everything is chosen and fitted on these.
    held_out
        Opened once, at the end, to show.
    progress
        Called with a sentence at each step.

    Raises
    ------
    FitError
        If the base model cannot be simulated at all.
    """
    chosen_options = Options() if options is None else options
    progress("fitting the base model")
    base = fit_model(graph, recordings, chosen_options.settings)
    if not np.isfinite(base.optimum.cost):
        raise FitError(
            f"{graph.name!r} cannot be simulated at its start values.",
            (graph.name,),
            "Give start values nearer to the machine, or bounds that keep it finite.",
        )
    rounds = _search(base, recordings, chosen_options, progress)
    progress("simulating the held-out recordings")
    return _answer(graph, recordings, held_out, rounds, chosen_options)


def _rebased(
    fitted: FittedModel, recordings: Sequence[BoundRecording], options: Options
) -> FittedModel:
    """Return the improved model, refitted over the horizon that now suits it."""
    if not isinstance(options.settings.horizon, Automatic):
        return fitted
    graph = fitted.graph.with_parameters(fitted.values)
    model = fitted.problem.model
    horizon = choose_horizon(graph, model, recordings, options.settings)
    if horizon == fitted.horizon:
        return fitted
    return fit_model(graph, recordings, replace(options.settings, horizon=horizon))


def _search(
    base: FittedModel,
    recordings: Sequence[BoundRecording],
    options: Options,
    progress: Callable[[str], None],
) -> list[_Round]:
    """Add supported physics one by one; the last round has found nothing more."""
    rounds: list[_Round] = []
    current = base
    while True:
        found = _one_round(current, options, len(rounds) + 1, progress)
        rounds.append(found)
        if found.chosen is None:
            return rounds
        current = _rebased(found.chosen.candidate.fitted, recordings, options)


def _one_round(
    base: FittedModel,
    options: Options,
    number: int,
    progress: Callable[[str], None],
) -> _Round:
    hypotheses = propose_all(base, options.library)
    screened, rejected = screen(
        base, hypotheses, lambda what: progress(f"round {number}: trying {what}")
    )
    worth = [c for c in screened if c.reduction(base) > options.rule.materiality / 2][
        : options.judged
    ]
    if not worth:
        return _Round((), screened, rejected, None, base)
    progress(f"round {number}: judging {len(worth)} candidates on left-out data")
    before = left_out_errors(base)
    judged = []
    for candidate in map(complete, worth):
        progress(
            f"round {number}: judging {candidate.hypothesis.physics} at "
            f"{candidate.hypothesis.place}"
        )
        errors = left_out_errors(candidate.fitted)
        judged.append(
            judge(candidate, before, errors, max(len(screened), 1), options.rule)
        )
    # After a named law, a free curve would only bend that law a little further.
    chosen = (
        best_supported(judged, curves=number == 1)
        if number <= options.most_findings
        else None
    )
    return _Round(tuple(judged), screened, rejected, chosen, base)


def _answer(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    held_out: Sequence[BoundRecording],
    rounds: Sequence[_Round],
    options: Options,
) -> Diagnosis:
    base, final = rounds[0].base, rounds[-1].base
    before, after = report(base, graph, recordings), report(final, graph, recordings)
    accepted = [r for r in rounds if r.chosen is not None]
    findings, others = _findings(accepted, after)
    floor = noise_floor(recordings)
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
        notes=_notes(rounds, after),
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
    accepted: Sequence[_Round], after: FitResult
) -> tuple[list[Finding], Mapping[str, Sequence[Judged]]]:
    findings, others = [], {}
    for found in accepted:
        chosen = found.chosen
        assert chosen is not None
        close = alternatives_to(chosen, list(found.judged))
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


def _evidence(rounds: Sequence[_Round]) -> tuple[Evidence, ...]:
    """Return all judged candidates of all rounds, best first within a round."""
    return tuple(
        _as_evidence(judged, found.base)
        for found in rounds
        for judged in sorted(found.judged, key=lambda j: -j.gain.value)
    )


def noise_floor(recordings: Sequence[BoundRecording]) -> dict[str, float]:
    """Return the measurement noise of each output, the largest over recordings."""
    names = recordings[0].output_names
    return {
        name: max(
            0.0 if r.steady else noise_std(r.time, r.outputs[:, i]) for r in recordings
        )
        for i, name in enumerate(names)
    }


def _verdict(
    findings: Sequence[Finding],
    base: FittedModel,
    floor: Mapping[str, float],
    first: _Round,
) -> tuple[Verdict, str]:
    if any(f.physics != "unknown_relation" for f in findings):
        return Verdict.PHYSICS_MISSING, " ".join(f.statement for f in findings)
    if findings:
        return Verdict.UNEXPLAINED, " ".join(f.statement for f in findings)
    undecided = [j for j in first.judged if j.support.value == "undecided"]
    ratios = residual_over_noise(base, floor)
    worst = max(ratios.values(), default=0.0)
    tried = len(first.screened)
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


def _blame(first: _Round) -> dict[str, float]:
    """Return for each junction the best training improvement a law there gives."""
    blame = {junction.name: 0.0 for junction in first.base.graph.junctions}
    for candidate in first.screened:
        place = candidate.hypothesis.place
        blame[place] = max(blame[place], candidate.reduction(first.base))
    return blame


def _notes(rounds: Sequence[_Round], after: FitResult) -> tuple[str, ...]:
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
            if wider and not clearly_better(judged, chosen, errors=2.0):
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
