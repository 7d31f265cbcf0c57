"""``bondgraph demo``: physics hidden in a simulated machine, found and shown.

The machine comes from `flegx_models.concealed_drive`, which shares no code with this
toolkit. Its recordings are written to files, and the files are diagnosed as any user's
would be. The machine models are named, never imported: the toolkit stands without them.
"""

from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

from bondgraph.cli.command import Command, json_option
from bondgraph.cli.diagnosing import answer, look_at
from bondgraph.cli.inputs import read_model
from bondgraph.cli.session import Session
from bondgraph.diagnosis.records import Diagnosis, Verdict
from bondgraph.errors import BondGraphError, ModelLoadError
from bondgraph.fitting.estimate import FitSettings
from bondgraph.loading import load_object
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.model_channels import read_for
from bondgraph.reporting.diagnosis_json import write_json
from bondgraph.structure.graph import FinishedGraph

MODEL = "flegx_models.demo:drive"
MACHINE = "flegx_models.concealed_drive"
DURATION = 4.0  # s, of each recording
PAGE, RESULT = "report.html", "result.json"
HIDDEN, WHERE = "load_dependent_friction", "worm"


@click.command(
    "demo",
    cls=Command,
    examples=(
        ("demo", "Friction hidden in a worm drive, found, shown on a page"),
        ("demo --without-effect", "Nothing hidden, nothing found"),
    ),
)
@click.option("--seed", default=1, show_default=True, help="Of motion, load and noise.")
@click.option("--without-effect", is_flag=True, help="Hide nothing; nothing is found.")
@click.option(
    "--out",
    default="bondgraph-demo",
    show_default=True,
    metavar="DIR",
    help="Where the recordings, the page and the JSON are written.",
)
@json_option
@click.pass_obj
def command(
    session: Session,
    /,
    *,
    seed: int,
    without_effect: bool,
    out: str,
    json_file: str | None,
) -> int:
    """Hide a worm friction in a simulated leg drive, record it, and find it.

    Exit status 1 if what is found is not what was hidden.
    """
    session.answers_in(json_file)
    if find_spec("flegx_models") is None:
        raise ModelLoadError(
            "The machine of the demo, the package flegx_models, is not installed.",
            ("flegx_models",),
            "Install bondgraph-workbench as a whole.",
        )
    folder = _folder(Path(out))
    graph = read_model(MODEL)
    with session.progress() as progress:
        progress("simulating the machine")
        paths = _record(folder, seed, without_effect=without_effect)
    for path in paths:
        session.wrote(path)
    train, held_out = (read_for(graph, path) for path in paths)
    session.say(_introduction(paths, without_effect=without_effect))
    found = _diagnosed(session, graph, (train, held_out), folder, json_file)
    as_hidden = _as_hidden(found, without_effect=without_effect)
    session.say(_conclusion(without_effect=without_effect, as_hidden=as_hidden))
    session.hint(_where_next(folder, found))
    return 0 if as_hidden else 1


def _folder(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BondGraphError(
            f"The folder {str(folder)!r} cannot be made ({error.strerror}).",
            (str(folder),),
            "Name another one with --out DIR.",
        ) from error
    return folder


def _record(folder: Path, seed: int, *, without_effect: bool) -> tuple[Path, Path]:
    """Record the machine twice, moved in two different ways, into CSV files."""
    record: Callable[..., Any] = _callable(f"{MACHINE}:record")
    write_csv: Callable[..., Any] = _callable(f"{MACHINE}:write_csv")
    motions = (
        (folder / "train.csv", seed, f"{MACHINE}:spline_reference"),
        (folder / "held_out.csv", seed + 1, f"{MACHINE}:multisine_reference"),
    )
    for path, number, motion in motions:
        reference = _callable(motion)
        recorded = record(
            number, DURATION, without_effect=without_effect, reference=reference
        )
        write_csv(path, recorded)
    return motions[0][0], motions[1][0]


def _callable(reference: str) -> Callable[..., Any]:
    found = load_object(reference)
    if not callable(found):
        raise ModelLoadError(f"{reference!r} is not a function.", (reference,))
    return found


def _introduction(paths: Sequence[Path], *, without_effect: bool) -> str:
    friction = load_object(f"{MACHINE}:WORM_FRICTION")
    hidden = (
        f"Nothing is hidden in it that the model {MODEL} leaves out."
        if without_effect
        else f"Hidden in it is friction of the worm, {friction} of the torque that the "
        f"worm transmits.\nThe model {MODEL} knows nothing of it."
    )
    train, held_out = paths
    return (
        f"A leg drive, simulated by {MACHINE}, was recorded for {DURATION:g} s each "
        f"time:\n{train} (splines, to train) and {held_out} (sines, held out).\n"
        f"{hidden}\n"
    )


def _diagnosed(
    session: Session,
    graph: FinishedGraph,
    recordings: tuple[BoundRecording, BoundRecording],
    folder: Path,
    json_file: str | None,
) -> Diagnosis:
    train, held_out = recordings
    found = answer(
        session,
        graph,
        [train],
        [held_out],
        settings=FitSettings(),
        html=str(folder / PAGE),
        json_file=json_file,
    )
    write_json(found, folder / RESULT)
    session.wrote(folder / RESULT)
    return found


def _as_hidden(found: Diagnosis, *, without_effect: bool) -> bool:
    """Return whether the answer is the truth, up to what cannot be told apart."""
    if without_effect:
        return found.verdict is Verdict.ADEQUATE
    places = [
        place
        for finding in found.findings
        if finding.physics == HIDDEN
        for place in (finding.place, *finding.indistinguishable_places)
    ]
    return WHERE in places


def _where_next(folder: Path, found: Diagnosis) -> str:
    """Return where the page is, what to look at first, and what to do then."""
    return (
        f"\nThe page: {(folder / PAGE).resolve().as_uri()}\n{look_at(found)}\n"
        f"The same as JSON: {folder / RESULT}. Your own machine: bondgraph new NAME."
    )


def _conclusion(*, without_effect: bool, as_hidden: bool) -> str:
    if without_effect:
        return (
            "Nothing was hidden, and nothing is found."
            if as_hidden
            else "Nothing was hidden, and yet something is found: a false alarm."
        )
    return (
        "What was hidden is found."
        if as_hidden
        else "What was hidden is not found, or not where it is."
    )
