"""Diagnosing and telling: the path that ``diagnose`` and ``demo`` share."""

import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from bondgraph.cli.resuming import kept_for_later
from bondgraph.cli.session import Loudness, Session
from bondgraph.cli.terminal import table_style
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.records import Diagnosis, Support, Verdict
from bondgraph.diagnosis.work.workers import Here, Where
from bondgraph.fitting.estimate import FitSettings
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.own_units import own_unit
from bondgraph.reporting.curve_table import curve_tables
from bondgraph.reporting.diagnosis_json import delivered, diagnosis_to_dict
from bondgraph.reporting.page.evidence import best_of_each
from bondgraph.reporting.report import report_html
from bondgraph.reporting.tables import (
    candidates_table,
    estimates_table,
)
from bondgraph.reporting.wording import (
    headline,
    number_words,
    percent,
    with_unit,
)
from bondgraph.structure.graph import FinishedGraph

MANY = 100
"""Of more times the noise the number tells nothing more: a sensor finer than a machine.
"""

SHOWN_CANDIDATES = 8
SHOWN_NOTES = 6
_LOOK_AT = {
    Verdict.PHYSICS_MISSING: "the held-out recordings before and after, "
    "then at the law and the places it could be confused with",
    Verdict.UNEXPLAINED: "the recovered curve and at the place",
    Verdict.CANNOT_TELL: "the candidates and at the next experiment",
    Verdict.ADEQUATE: "the errors against the noise on held-out data",
}


_COLOURS = {
    Verdict.PHYSICS_MISSING: "yellow",
    Verdict.UNEXPLAINED: "yellow",
    Verdict.CANNOT_TELL: "cyan",
    Verdict.ADEQUATE: "green",
}


def answer(
    session: Session,
    graph: FinishedGraph,
    training: Sequence[BoundRecording],
    held_out: Sequence[BoundRecording],
    *,
    settings: FitSettings,
    html: str | None,
    json_file: str | None,
    experiment_file: str | None = None,
    where: Where | None = None,
    seconds: float | None = None,
    resume: Path | None = None,
    either_hold: bool = True,
) -> Diagnosis:
    """Diagnose, print the answer, and write the report page and the JSON."""
    every = (*training, *held_out)
    with (
        kept_for_later(session, graph, every, resume) as kept,
        session.progress(loops=True) as progress,
    ):
        diagnosis = diagnose(
            graph,
            training,
            held_out=held_out,
            options=Options(
                settings=settings,
                where=where or Here(),
                resume=kept.folder,
                either_hold=either_hold,
                seconds=seconds,
            ),
            progress=progress,
        )
        kept.done = diagnosis.complete
    session.say(_verdict(session, diagnosis))
    if session.loudness is not Loudness.QUIET:
        session.say("\n".join(_told(session, diagnosis, every)))
    if html is not None:
        session.write(html, report_html(diagnosis, command=session.command))
    if experiment_file is not None:
        _write_experiment(session, diagnosis, experiment_file)
    told = diagnosis_to_dict(diagnosis)
    told["provenance"]["command"] = session.command
    session.deliver(json_file, told)
    return diagnosis


def _write_experiment(session: Session, diagnosis: Diagnosis, path: str) -> None:
    """Write the input to play, or say why there is none."""
    if diagnosis.experiment is not None:
        session.write(path, diagnosis.experiment.csv)
        return
    left_close = diagnosis.verdict is Verdict.CANNOT_TELL or any(
        alternative.support is Support.SUPPORTED
        for finding in diagnosis.findings
        for alternative in finding.alternatives
    )
    session.note(
        f"{path} was not written: "
        + (
            "no input could be designed that tells apart what is left close; the notes "
            "say why, where the recordings have a clock and inputs."
            if left_close
            else "there is nothing to tell apart."
        )
    )


def look_at(diagnosis: Diagnosis) -> str:
    """Return in a sentence what to look at first on the page of a diagnosis."""
    return f"Look first at {_LOOK_AT[diagnosis.verdict]}."


def _verdict(session: Session, diagnosis: Diagnosis) -> str:
    """Return the answer in two sentences, the first in its colour."""
    verdict = f"{headline(diagnosis)}."
    styled = session.styled(
        verdict, sys.stdout, fg=_COLOURS[diagnosis.verdict], bold=True
    )
    return "\n".join((styled, diagnosis.statement, *_how_sure(diagnosis)))


def _how_sure(diagnosis: Diagnosis) -> Iterator[str]:
    """Yield how probable each finding is, where that is known."""
    told = ", ".join(
        f"{finding.name} at {finding.place} {100 * finding.probability:.0f} of 100"
        for finding in diagnosis.findings
        if finding.probability is not None
    )
    if told:
        yield f"How sure: {told}."


def _told(
    session: Session, diagnosis: Diagnosis, recordings: Sequence[BoundRecording]
) -> Iterator[str]:
    """Yield what a reader asks next: how sure, what else, what now.

    A block that has nothing to say is left out.
    """
    yield ""
    yield from _errors(diagnosis, recordings)
    yield from curve_tables(diagnosis, **table_style(session))
    if diagnosis.candidates:
        yield "Considered, judged on left-out parts of the training recordings"
        different = best_of_each(diagnosis.candidates)
        shown = len(different) if session.verbose else SHOWN_CANDIDATES
        yield candidates_table(different[:shown], **table_style(session))
        more = len(different) - shown
        if more > 0:
            yield f"and {more} more: -v, the page and the JSON have them\n"
    estimates = delivered(diagnosis).estimates
    if estimates:
        curves = () if session.verbose else _of_curves(diagnosis)
        told = [one for one in estimates if one.name not in curves]
        all_of = "all" if diagnosis.fit_all else "the training"
        yield f"Parameters of the model handed on, fitted to {all_of} recordings"
        yield estimates_table(told, **table_style(session))
        if curves:
            yield f"and {len(curves)} of drawn curves: -v, the page and the JSON\n"
    if diagnosis.notes:
        shown = len(diagnosis.notes) if session.verbose else SHOWN_NOTES
        notes = _few(diagnosis.notes, shown)
        yield "\n".join(("Notes", *(f"  {note}" for note in notes), ""))
    if diagnosis.next_experiment:
        yield f"Next experiment: {diagnosis.next_experiment}\n"


def _of_curves(diagnosis: Diagnosis) -> frozenset[str]:
    """Return the parameters of curves without a name: single points tell nothing."""
    return frozenset(
        estimate.name
        for finding in diagnosis.findings
        for estimate in finding.estimates
        if finding.physics == "unknown_relation"
    )


def _few(notes: Sequence[str], most: int) -> Iterator[str]:
    yield from notes[:most]
    if len(notes) > most:
        yield f"and {len(notes) - most} more: -v, the page and the JSON have them"


def _errors(
    diagnosis: Diagnosis, recordings: Sequence[BoundRecording]
) -> Iterator[str]:
    yield "Simulated minus measured, before and after"
    parts = (("training", diagnosis.train), ("held out", diagnosis.held_out))
    for name, comparison in parts:
        before, after = comparison.before, comparison.after
        yield (
            f"  {name}: {percent(before.nrmse)} → {percent(after.nrmse)} of the "
            "measured spread"
        )
    units = {
        e.name: own_unit(recordings, e.name, e.unit)
        for e in diagnosis.model.measurements
    }
    floors = (
        with_unit(f"{name} {number_words(std * times, 3)}", unit)
        + _times_left(diagnosis.held_out.after.rmse.get(name), std)
        for name, std in diagnosis.noise_floor.items()
        for times, unit in (units[name],)
        if std > 0
    )
    floor = ", ".join(floors)
    yield f"  measurement noise: {floor}\n" if floor else ""


def _times_left(rmse: float | None, noise: float) -> str:
    """Return how many times the noise is left at the end, of what was held out."""
    if rmse is None or not math.isfinite(rmse):
        return ""
    times = rmse / noise
    words = number_words(times, 2) if times < MANY else f"more than {MANY}"
    return f" (held-out error at the end: {words} times that)"
