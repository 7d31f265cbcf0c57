"""``bondgraph diagnose``: what a model leaves out, found in recordings."""

from collections.abc import Sequence
from pathlib import Path

import click

from bondgraph.cli.command import Command, json_option
from bondgraph.cli.diagnosing import answer, look_at
from bondgraph.cli.fit_options import fit_options
from bondgraph.cli.inputs import (
    model_argument,
    read_model,
    read_recordings,
    recording_argument,
)
from bondgraph.cli.output_file import OutputFile
from bondgraph.cli.reading_options import Reading, recording_options
from bondgraph.cli.session import Session
from bondgraph.cli.work_options import time_limit, work_options
from bondgraph.diagnosis.work.workers import Where
from bondgraph.errors import RecordingError
from bondgraph.fitting.estimate import FitSettings
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.windows import split as split_recording

SPLIT = 0.6
TIME_LIMIT = "8"  # min


@click.command(
    "diagnose",
    cls=Command,
    examples=(
        ("diagnose axis.py run.csv --html report.html", "What is missing, with a page"),
        ("diagnose axis.py a.csv b.csv --held-out c.csv", "Shown on c, chosen without"),
        ("diagnose axis.py run.csv -q --json result.json", "For a program to read"),
        (
            "diagnose axis.py run.csv --next-experiment play.csv",
            "What to play next, where laws are left close",
        ),
    ),
)
@model_argument
@recording_argument("recordings", nargs=-1)
@click.option(
    "--held-out",
    "held_out",
    multiple=True,
    metavar="REC",
    type=click.Path(),
    help="A recording kept back to show the answer on; repeat for more.",
)
@click.option(
    "--split",
    type=click.FloatRange(0, 1, min_open=True, max_open=True),
    help=f"Without --held-out: the share to train on, {SPLIT:g} by default.",
)
@click.option(
    "--html", metavar="FILE", type=OutputFile(), help="Write the report page."
)
@click.option(
    "--next-experiment",
    "experiment_file",
    metavar="FILE.csv",
    type=OutputFile(),
    help="Write the input to play that would tell apart what is left close.",
)
@click.option(
    "--resume",
    metavar="DIR",
    type=click.Path(file_okay=False, path_type=Path),
    help="Keep what is worked out in this directory, and go on from what is there.",
)
@work_options
@click.option(
    "--time-limit",
    "seconds",
    callback=time_limit,
    default=TIME_LIMIT,
    show_default=True,
    metavar="MINUTES|none",
    help="End the search after so long; what stands by then is the answer, and the "
    "same command goes on from there.",
)
@fit_options(window="auto")
@recording_options
@json_option
@click.pass_obj
def command(
    session: Session,
    /,
    *,
    model: str,
    values: tuple[str, ...],
    recordings: tuple[str, ...],
    held_out: tuple[str, ...],
    split: float | None,
    html: str | None,
    experiment_file: str | None,
    settings: FitSettings,
    reading: Reading,
    resume: Path | None,
    either_hold: bool,
    where: Where,
    seconds: float | None,
    json_file: str | None,
) -> None:
    """Say whether MODEL leaves physics out, where and which, and show it.

    REC... are for training: everything is fitted and chosen on them. The held-out
    recordings are opened once, at the end. Without any, the first part of each
    recording trains and the rest is held out.
    """
    if held_out and split is not None:
        raise click.UsageError("--split has no use where --held-out is given.")
    session.answers_in(json_file)
    graph = read_model(model, values)
    bound = read_recordings((*recordings, *held_out), graph, reading)
    training, kept_back = bound[: len(recordings)], bound[len(recordings) :]
    if not held_out:
        share = SPLIT if split is None else split
        session.note(
            f"Without --held-out, the first {100 * share:.4g} % of each recording "
            "trains and the rest is held out."
        )
        parts = [split_recording(recording, share) for recording in bound]
        training = [first for first, _ in parts]
        kept_back = [rest for _, rest in parts]
    else:
        _check_apart(training, kept_back)
    found = answer(
        session,
        graph,
        training,
        kept_back,
        settings=settings,
        html=html,
        experiment_file=experiment_file,
        json_file=json_file,
        where=where,
        seconds=seconds,
        resume=resume,
        either_hold=either_hold,
    )
    session.hint(
        "Add --html report.html for the page with pictures."
        if html is None
        else f"Report page: {html}\n{look_at(found)}"
    )


def _check_apart(
    training: Sequence[BoundRecording], held_out: Sequence[BoundRecording]
) -> None:
    """Refuse to show an answer on what it was chosen on."""
    for kept_back in held_out:
        for recording in training:
            if recording.sha256 and recording.sha256 == kept_back.sha256:
                raise RecordingError(
                    f"{kept_back.name!r} is held out and has the same content as "
                    f"{recording.name!r}, which trains.",
                    (kept_back.name, recording.name),
                    "Hold out another recording, or give one and let --split divide "
                    "it.",
                )
