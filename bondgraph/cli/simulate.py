"""``bondgraph simulate``: a model beside a recording."""

import click
import numpy as np

from bondgraph.cli.command import Command, json_option
from bondgraph.cli.fit_answer import hold_words
from bondgraph.cli.fit_options import fit_options, substeps_option
from bondgraph.cli.inputs import (
    model_argument,
    read_model,
    read_recordings,
    recording_argument,
)
from bondgraph.cli.output_file import OutputFile
from bondgraph.cli.reading_options import Reading, recording_options
from bondgraph.cli.session import Session
from bondgraph.cli.simulate_answer import advice, answer_json, as_csv, found
from bondgraph.errors import FitError
from bondgraph.fitting.either_hold import simulated_either_way
from bondgraph.fitting.estimate import FitSettings
from bondgraph.fitting.horizon import WholeRecordings
from bondgraph.fitting.simulate import Solution, SolveStatus, simulate
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.misreadings import without_misreadings


@click.command(
    "simulate",
    cls=Command,
    examples=(
        ("simulate axis.py run.csv", "How far the model is from the recording"),
        ("simulate axis.py run.csv --set mass=95 -o both.csv", "Another value, kept"),
        ("simulate axis.py run.mat --map 'x=qm[m]'", "Channels with other names"),
    ),
)
@model_argument
@recording_argument("recording")
@click.option(
    "-o",
    "--output",
    metavar="FILE",
    type=OutputFile(),
    help="Write measured and simulated.",
)
@fit_options(window="whole")
@substeps_option
@recording_options
@json_option
@click.pass_obj
def command(
    session: Session,
    /,
    *,
    model: str,
    values: tuple[str, ...],
    recording: str,
    output: str | None,
    settings: FitSettings,
    either_hold: bool,
    reading: Reading,
    json_file: str | None,
) -> None:
    """Drive MODEL with the inputs of the recording REC and compare its outputs.

    The initial state is estimated from the recording; no parameter is changed.
    """
    session.answers_in(json_file)
    graph = read_model(model, values)
    read = without_misreadings(read_recordings([recording], graph, reading))
    (bound,) = read.recordings
    hold = None
    with session.progress(loops=True) as progress:
        progress(f"simulating {bound.name}")
        if either_hold:
            solution, hold = simulated_either_way(graph, bound, settings)
        else:
            solution = simulate(graph, bound, settings=settings)
    if solution.status is SolveStatus.FAILED:
        raise _failed(graph.name, bound, solution)
    for line in found(solution, bound, graph):
        session.say(line)
    for note in read.notes:  # What is left out of a recording is said in any case.
        session.say(note)
    whole = isinstance(settings.horizon, WholeRecordings)
    held = [] if hold is None else [hold_words(hold, [bound], "with these values")]
    for hint in (*advice(solution, bound, whole=whole), *bound.notes, *held):
        session.hint(hint)
    if solution.reason:  # of a run with accounts, where the one without them went on
        session.say(solution.reason)
    if output is not None:
        session.write(output, as_csv(solution))
    session.deliver(json_file, answer_json(solution))


def _failed(model: str, bound: BoundRecording, solution: Solution) -> FitError:
    """Return where a simulation stopped; of a table which rows have no solution."""
    if not bound.steady:
        return FitError(
            f"The simulation of {model!r} along {bound.name!r} does not stay "
            f"finite. {solution.reason}".rstrip(),
            (model, bound.name),
            "Simulate shorter stretches with --window SECONDS.",
        )
    missing = np.isfinite(solution.measured) & ~np.isfinite(solution.simulated)
    rows = np.flatnonzero(missing.any(axis=1))
    verb = "has" if rows.size == 1 else "have"
    return FitError(
        f"{rows.size} of the {len(missing)} rows of {solution.recording!r} {verb} no "
        f"solution with {model!r}: the first is row {rows[0]}, counted from 0.",
        (model, solution.recording),
        "Look whether a law falls there where it should rise, or leave such rows out.",
    )
