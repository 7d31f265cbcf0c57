"""Diagnosing and telling: the path that ``diagnose`` and ``demo`` share."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from bondgraph.cli.session import Session
from bondgraph.cli.terminal import table_style
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.records import Diagnosis, Evidence, Verdict
from bondgraph.diagnosis.work.workers import Here, Where
from bondgraph.fitting.estimate import FitSettings
from bondgraph.recordings.binding import BoundRecording
from bondgraph.reporting.diagnosis_json import delivered, diagnosis_to_dict
from bondgraph.reporting.report import report_html
from bondgraph.reporting.tables import (
    candidates_table,
    estimates_table,
)
from bondgraph.reporting.wording import (
    VERDICTS,
    number_words,
    percent,
    unit_words,
)
from bondgraph.structure.graph import FinishedGraph

SHOWN_CANDIDATES = 8
SHOWN_NOTES = 6
_LOOK_AT = {
    Verdict.PHYSICS_MISSING: "look first at the held-out recordings before and after, "
    "then at the law and the places it could be confused with",
    Verdict.UNEXPLAINED: "look first at the recovered curve and at the place",
    Verdict.CANNOT_TELL: "look first at the candidates and at the next experiment",
    Verdict.ADEQUATE: "look first at the errors against the noise on held-out data",
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
    where: Where | None = None,
    resume: Path | None = None,
    either_hold: bool = False,
) -> Diagnosis:
    """Diagnose, print the answer, and write the report page and the JSON."""
    with session.progress() as progress:
        diagnosis = diagnose(
            graph,
            training,
            held_out=held_out,
            options=Options(
                settings=settings,
                where=where or Here(),
                resume=resume,
                either_hold=either_hold,
            ),
            progress=progress,
        )
    session.say("\n".join(_told(diagnosis)))
    if html is not None:
        session.write(html, report_html(diagnosis))
        session.say(f"Report page: {html} ({_LOOK_AT[diagnosis.verdict]}).")
    else:
        session.say("Add --html report.html for the page with pictures.")
    session.deliver(json_file, diagnosis_to_dict(diagnosis))
    return diagnosis


def _told(diagnosis: Diagnosis) -> Iterator[str]:
    """Yield the answer in the order in which a reader asks: what, how sure, what now.

    A block that has nothing to say is left out.
    """
    yield f"{VERDICTS[diagnosis.verdict]}."
    yield f"{diagnosis.statement}\n"
    yield from _errors(diagnosis)
    if diagnosis.candidates:
        yield "Considered, judged on left-out parts of the training recordings"
        different = _best_of_each(diagnosis.candidates)
        yield candidates_table(different[:SHOWN_CANDIDATES], **table_style())
        more = len(different) - SHOWN_CANDIDATES
        if more > 0:
            yield f"and {more} more, in the page and the JSON\n"
    estimates = delivered(diagnosis).estimates
    if estimates:
        yield "Parameters of the model handed on, fitted to all recordings"
        yield estimates_table(estimates, **table_style())
    if diagnosis.notes:
        yield "\n".join(("Notes", *(f"  {note}" for note in _few(diagnosis.notes)), ""))
    if diagnosis.next_experiment:
        yield f"Next experiment: {diagnosis.next_experiment}\n"


def _best_of_each(candidates: Sequence[Evidence]) -> list[Evidence]:
    """Return the first candidate of each law at each place, which is the best.

    A law may be tried at a place in several ways; a table has no use for all of them.
    """
    best: dict[tuple[str, str], Evidence] = {}
    for candidate in candidates:
        best.setdefault((candidate.physics, candidate.place), candidate)
    return list(best.values())


def _few(notes: Sequence[str]) -> Iterator[str]:
    yield from notes[:SHOWN_NOTES]
    if len(notes) > SHOWN_NOTES:
        yield f"and {len(notes) - SHOWN_NOTES} more, in the page and the JSON"


def _errors(diagnosis: Diagnosis) -> Iterator[str]:
    yield "Simulated minus measured, before and after"
    parts = (("training", diagnosis.train), ("held out", diagnosis.held_out))
    for name, comparison in parts:
        before, after = comparison.before, comparison.after
        yield (
            f"  {name}: {percent(before.nrmse)} → {percent(after.nrmse)} of the "
            "measured spread"
        )
    units = {e.name: e.unit for e in diagnosis.model.measurements}
    floors = (
        f"{name} {number_words(std, 3)} {unit_words(units[name])}"
        for name, std in diagnosis.noise_floor.items()
        if std > 0
    )
    floor = ", ".join(floors)
    yield f"  measurement noise: {floor}\n" if floor else ""
