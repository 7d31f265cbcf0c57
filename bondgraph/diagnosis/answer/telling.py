"""The answer: what the search found, told in records, numbers and sentences."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bondgraph.diagnosis.answer.all_together import doubted_together
from bondgraph.diagnosis.answer.at_jumps import doubted_at_jumps
from bondgraph.diagnosis.answer.beyond import beyond_training
from bondgraph.diagnosis.answer.changed_over import with_images
from bondgraph.diagnosis.answer.comparing import compared, over_long
from bondgraph.diagnosis.answer.concluding import concluded
from bondgraph.diagnosis.answer.doubt import doubted
from bondgraph.diagnosis.answer.evidence_shown import all_evidence
from bondgraph.diagnosis.answer.found import findings_of
from bondgraph.diagnosis.answer.long_run import lost_over_whole
from bondgraph.diagnosis.answer.look_alikes import look_alikes
from bondgraph.diagnosis.answer.notes import notes_on, provenance
from bondgraph.diagnosis.answer.one_size import doubted_in_one_size
from bondgraph.diagnosis.answer.rounded_inputs import doubted_within_rounding
from bondgraph.diagnosis.answer.separating import designed, left_close
from bondgraph.diagnosis.answer.showing import recovered_law, traces
from bondgraph.diagnosis.answer.stated import (
    at_bounds,
    contradicted,
    driven_away,
    ended_at_bounds,
)
from bondgraph.diagnosis.answer.turning import doubted_at_turns, turns_of
from bondgraph.diagnosis.answer.untried import untried
from bondgraph.diagnosis.answer.wording import next_experiment
from bondgraph.diagnosis.candidates import CURVE, Candidate
from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.evidence.leftover import foretold, noise_floor
from bondgraph.diagnosis.evidence.proportion import known_in_proportion
from bondgraph.diagnosis.records import Comparison, Diagnosis, Finding
from bondgraph.diagnosis.search.base.horizons import refitted
from bondgraph.diagnosis.search.options import Options
from bondgraph.diagnosis.search.remaining import remaining
from bondgraph.diagnosis.search.round_found import Round, accepted, chosen_in
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.fine_steps import told_finely
from bondgraph.fitting.result import FitResult, FitStatus
from bondgraph.fitting.told import report
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

HARDLY = 0.9
"""Whole recordings of which so much of the error is left are hardly explained."""

DRAWN_RIVALS = 4
"""How many other laws are drawn over the cloud of a recovered one."""

NOT_TOGETHER = (
    "The model could not be fitted to all recordings together; it is handed on as "
    "fitted to those that train."
)


def answer(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    held_out: Sequence[BoundRecording],
    rounds: Sequence[Round],
    final: FittedModel,
    options: Options,
) -> Diagnosis:
    """Return the diagnosis that the rounds of a search amount to.

    Where time has run out the model is handed on as it is, fitted to what trains.
    """
    late, made = any(one.cut_short for one in rounds), accepted(rounds)
    base, final = rounds[0].base, final if late or made else told_finely(final)
    before, after = report(base, graph, recordings), report(final, graph, recordings)
    shown = compared(base, final, recordings, held_out)
    floor = foretold(final, noise_floor(recordings))
    long = over_long(base, final, recordings, shown.trained)
    left = max(remaining(rounds, floor), left_of_whole(long, floor))
    proportion = known_in_proportion(final, base)
    told, others = findings_of(rounds, after, held_out, options, left, proportion)
    told = with_images(told, base.graph, after.estimates)
    # A curve leaves to an element beside it what goes in proportion.
    named = any(one.physics != CURVE for one in told)
    away = driven_away(graph, before.estimates, after.estimates) if named else ()
    within = not away and not ended_at_bounds(graph, after.estimates)
    told = doubted(told, left, carried=shown.stands, within=within)
    turns = turns_of(base.problem.model, recordings)
    findings = doubted_at_turns(_doubted_as_recorded(told, rounds), turns)
    everything = (*recordings, *held_out)
    everywhere = None if late else _delivered(graph, final, everything, options)
    findings = doubted_together(findings, everywhere, stands=shown.stands)
    wrong = contradicted(graph, after.estimates)
    verdict, statement = concluded(
        rounds, final, findings, wrong, left, shown, recordings, options
    )
    close = left_close(rounds, others, verdict)
    experiment, undesigned = (
        (None, ()) if close is None else designed(close, recordings)
    )
    laws = [
        recovered_law(r.base, r.chosen.candidate, final, recordings, _rivals(r))
        for r in made
        if r.chosen is not None
    ]
    return Diagnosis(
        verdict=verdict,
        statement=statement,
        findings=(*findings, *wrong),
        train=shown.trained,
        held_out=shown.held_out,
        noise_floor=floor,
        false_alarm_probability=options.rule.false_alarm_probability,
        next_experiment=next_experiment(findings, others, base, experiment),
        experiment=experiment,
        candidates=all_evidence(rounds),
        blame=_blame(rounds[0]),
        fit_before=before,
        fit_after=after,
        fit_all=everywhere,
        traces=traces(base, final, held_out),
        recovered=tuple(law for law in laws if law is not None),
        notes=(
            *map(str, turns),
            *lost_over_whole(final, recordings, shown.trained),
            *beyond_training(chosen_in(rounds), final, held_out),
            *at_bounds(graph, after.estimates),
            *away,
            *undesigned,
            *look_alikes(findings, base, recordings),
            *untried(graph, verdict),
            *(() if late or everywhere is not None else (NOT_TOGETHER,)),
            *notes_on(rounds, after, options),
        ),
        complete=not late,
        provenance=provenance(recordings, held_out, options, final),
    )


def _doubted_as_recorded(
    findings: Sequence[Finding], rounds: Sequence[Round]
) -> list[Finding]:
    """Return the findings, less probable where what was recorded shows them badly."""
    made = accepted(rounds)
    findings = doubted_at_jumps(findings, made)
    findings = doubted_within_rounding(findings, made)
    return doubted_in_one_size(findings, rounds)


def left_of_whole(trained: Comparison, floor: Mapping[str, float]) -> float:
    """Return the share of squared error that long training recordings keep, if most.

    What explains windows, each from a state of its own, and hardly a recording is not
    the cause. What noise leaves of a recording, as it does of one with a weak effect,
    is nothing that a cause could take away.
    """
    whole = kept = 0.0
    for name, before in trained.before.rmse.items():
        after, noise = trained.after.rmse[name], floor.get(name, 0.0)
        if before > noise:
            whole += 1.0 - (noise / before) ** 2
            kept += max(after**2 - noise**2, 0.0) / before**2
    share = kept / whole if whole > 0.0 else 0.0
    return 0.0 if share < HARDLY**2 else min(share, 1.0)


def _rivals(found: Round) -> list[Candidate]:
    """Return the best of each other physics judged at the chosen place."""
    chosen = found.chosen
    assert chosen is not None
    best: dict[str, Judged] = {}
    for judged in sorted(found.judged, key=lambda j: -j.gain.value):
        if judged.place == chosen.place and judged.physics != chosen.physics:
            best.setdefault(judged.physics, judged)
    return [judged.candidate for judged in list(best.values())[:DRAWN_RIVALS]]


def _delivered(
    start: FinishedGraph,
    final: FittedModel,
    everything: Sequence[BoundRecording],
    options: Options,
) -> FitResult | None:
    """Return the final model refitted on everything recorded, to be used from here.

    None where that cannot be simulated. The estimates tell the user's own start values,
    where the user's model has them.
    """
    settings = replace(
        options.settings,
        horizon=final.horizon,
        solver=final.problem.solver,
        hold=final.problem.hold,
    )
    fitted = report(refitted(final, everything, settings), start, everything)
    return None if fitted.status is FitStatus.SIMULATION_FAILED else fitted


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
