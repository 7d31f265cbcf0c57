"""``bondgraph fit``: parameters with what is known of them afterwards."""

from collections.abc import Iterator, Sequence

import click

from bondgraph.cli.command import Command, json_option
from bondgraph.cli.fit_answer import (
    answer_json,
    hold_words,
    intervals,
    known,
    profile_words,
)
from bondgraph.cli.fit_options import estimation_options, fit_options, substeps_option
from bondgraph.cli.inputs import (
    model_argument,
    read_model,
    read_recordings,
    recording_argument,
)
from bondgraph.cli.output_file import OutputFile
from bondgraph.cli.reading_options import Reading, recording_options
from bondgraph.cli.seen_noise import beyond_noise
from bondgraph.cli.session import Session
from bondgraph.cli.terminal import table_style
from bondgraph.errors import FitError
from bondgraph.fitting.certainty.profile import profile
from bondgraph.fitting.either_hold import fitted_either_way
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.fine_steps import told_finely
from bondgraph.fitting.fitted import FittedModel
from bondgraph.fitting.long_runs import simulate_whole
from bondgraph.fitting.result import FitResult, FitStatus, Score
from bondgraph.fitting.told import report
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.misreadings import without_misreadings
from bondgraph.reporting.model_text import to_python
from bondgraph.reporting.tables import INTERVAL, estimates_table

NOT_CONVERGED = (
    "It may need more steps (--iterations), start values nearer to the machine (--set, "
    "or --starts), or one of the parameters that go together held with std=0.0. A "
    "machine that has physics beyond the model looks like this too: bondgraph diagnose "
    "says which."
)


@click.command(
    "fit",
    cls=Command,
    examples=(
        ("fit axis.py run1.csv run2.csv", "Parameters with their uncertainty"),
        ("fit axis.py run1.csv -o fitted.py", "The fitted model as Python text"),
        ("fit axis.py run1.csv --loss huber --noise coloured", "Outliers, slow noise"),
    ),
)
@model_argument
@recording_argument("recordings", nargs=-1)
@click.option(
    "-o",
    "--output",
    metavar="FILE",
    type=OutputFile(),
    help="Write the fitted model (Python).",
)
@click.option(
    "--profile",
    "profiled",
    metavar="NAME",
    multiple=True,
    help="How far this parameter can move while the others follow; may be repeated.",
)
@fit_options(window="auto")
@substeps_option
@estimation_options
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
    output: str | None,
    profiled: tuple[str, ...],
    settings: FitSettings,
    either_hold: bool,
    reading: Reading,
    json_file: str | None,
) -> int:
    """Fit the free parameters of MODEL to recordings by simulation error.

    Exit status 1 if the fit did not converge.
    """
    session.answers_in(json_file)
    graph = read_model(model, values)
    read = without_misreadings(read_recordings(recordings, graph, reading))
    bound = read.recordings
    with session.progress(loops=True) as progress:
        progress(f"fitting {graph.name}")
        fit = fitted_either_way if either_hold else fit_model
        fitted = told_finely(fit(graph, bound, settings))
        result = report(fitted, graph, bound)
        whole = _over_whole_recordings(fitted, result, bound)
    if result.status is FitStatus.SIMULATION_FAILED:
        raise FitError(
            f"{graph.name!r} cannot be simulated at its start values.",
            (graph.name,),
            "Give other start values, bounds, or a shorter --window.",
        )
    session.say(result.status.value)
    session.say()
    table = estimates_table(result.estimates, **table_style(session))
    session.say(table)
    session.say()
    ends = "\n".join(intervals(result))
    if ends and (INTERVAL not in table or session.verbose):
        session.say(ends)
        session.say()
    for words in (*known(result, whole, graph, bound), *read.notes):
        session.say(words)
    problem = fitted.problem
    if either_hold and problem.model.input_names and problem.model.n_states:
        session.hint(hold_words(problem.hold, bound))
    for words in _advice(result, whole, bound):
        session.hint(words)
    with session.progress(loops=True) as progress:
        profiles = []
        for name in profiled:
            progress(f"profile of {name}")
            profiles.append(profile(result, name))
    for one in profiles:
        session.say(profile_words(one))
    if output is not None:
        session.write(output, to_python(result.model))
    session.deliver(
        json_file, answer_json(result, whole, profiles, hold=fitted.problem.hold)
    )
    return 0 if result.status is FitStatus.CONVERGED else 1


def _advice(
    result: FitResult, whole: Score | None, bound: Sequence[BoundRecording]
) -> Iterator[str]:
    """Yield what to do about what the fit did not do."""
    if result.status is FitStatus.ITERATION_LIMIT:
        yield NOT_CONVERGED
    beyond = beyond_noise((whole or result.score).rmse, bound)
    if beyond is not None:
        yield beyond
    if result.unidentifiable:
        yield (
            "What is known of a parameter beforehand may be said in the model: "
            "with std=0.0 it stays at its value."
        )


def _over_whole_recordings(
    fitted: FittedModel, result: FitResult, bound: Sequence[BoundRecording]
) -> Score | None:
    """Return the error of runs from one first state each, where the fit has windows.

    Windows begin anew at what was measured: the worse a model, the shorter the ones
    that it bears, and the better it looks in them.
    """
    if result.window is None or result.status is FitStatus.SIMULATION_FAILED:
        return None
    simulated = simulate_whole(fitted, bound)
    return simulated.score if simulated.whole else None
