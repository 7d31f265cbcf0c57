"""``bondgraph fit``: parameters with what is known of them afterwards."""

from collections.abc import Iterator, Sequence

import click

from bondgraph.cli.command import Command, json_option
from bondgraph.cli.fit_options import estimation_options, fit_options, hint_at_steps
from bondgraph.cli.inputs import (
    model_argument,
    read_model,
    read_recordings,
    recording_argument,
)
from bondgraph.cli.reading_options import Reading, recording_options
from bondgraph.cli.session import Session
from bondgraph.cli.terminal import table_style
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import FitSettings, fit_model, report
from bondgraph.fitting.fine_steps import told_finely
from bondgraph.fitting.identifiability import identifiability
from bondgraph.fitting.profile import Profile, profile
from bondgraph.fitting.result import FitResult, FitStatus
from bondgraph.fitting.solver_error import SolverError, SolverErrorStatus
from bondgraph.recordings.binding import BoundRecording
from bondgraph.reporting.diagnosis_json import json_value
from bondgraph.reporting.model_text import to_python
from bondgraph.reporting.tables import INTERVAL, estimates_table
from bondgraph.reporting.wording import (
    number_words,
    relative_error,
    unit_words,
    with_unit,
)
from bondgraph.structure.graph import FinishedGraph


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
    type=click.Path(allow_dash=True),
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
    reading: Reading,
    json_file: str | None,
) -> int:
    """Fit the free parameters of MODEL to recordings by simulation error.

    Exit status 1 if the fit did not converge.
    """
    session.answers_in(json_file)
    graph = read_model(model, values)
    bound = read_recordings(recordings, graph, reading)
    with session.progress(loops=True) as progress:
        progress(f"fitting {graph.name}")
        fitted = told_finely(fit_model(graph, bound, settings))
        result = report(fitted, graph, bound)
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
    intervals = "\n".join(_intervals(result))
    if intervals and (INTERVAL not in table or session.verbose):
        session.say(intervals)
        session.say()
    session.say("\n".join(_known(result, graph, bound)))
    hint_at_steps(session, settings, bound)
    if result.unidentifiable:
        session.hint(
            "What is known of a parameter beforehand may be said in the model: "
            "with std=0.0 it stays at its value."
        )
    with session.progress(loops=True) as progress:
        profiles = []
        for name in profiled:
            progress(f"profile of {name}")
            profiles.append(profile(result, name))
    for one in profiles:
        session.say(_profile_words(one))
    if output is not None:
        session.write(output, to_python(result.model))
    session.deliver(json_file, _plain(result, profiles))
    return 0 if result.status is FitStatus.CONVERGED else 1


def _intervals(result: FitResult) -> Iterator[str]:
    """Yield the intervals that are known, one a line, where there are any."""
    known = [(one, one.interval) for one in result.estimates if one.interval]
    if known:
        yield f"{INTERVAL}s"
    for one, interval in known:
        low, high = (number_words(end, 5) for end in interval)
        yield f"  {one.name}: {low} to {high} {unit_words(one.unit)}".rstrip()


def _known(
    result: FitResult, graph: FinishedGraph, bound: Sequence[BoundRecording]
) -> Iterator[str]:
    """Yield what the fit knows: errors, and what it cannot tell."""
    yield _score_words(result, graph)
    yield from _at_bounds(result)
    for name, phi in result.correlation.items():
        yield f"Noise of {name}: neighbouring samples correlate by {phi:.3f}."
    for sentence in result.unidentifiable:
        yield f"Not identifiable from these recordings: {sentence}."
    if result.unidentifiable:
        yield identifiability(graph, bound).status.value
    for sentence in result.barely_known:
        yield f"Hardly {sentence}."
    error = result.solver_error
    if error is not None and error.status is not SolverErrorStatus.FINE:
        yield error.status.value


def _profile_words(one: Profile) -> str:
    """Return a profile in one line, an open end as such."""
    low, high = (
        "open" if end is None else number_words(end, 5) for end in one.interval
    )
    ends = f"{low} to {high} {unit_words(one.unit)}".rstrip()
    return f"Profile of {one.name}: {ends}. {one.status.value}"


def _at_bounds(result: FitResult) -> Iterator[str]:
    """Yield the parameters that ended where the model lets them go no further."""
    for one in result.estimates:
        low, high = result.model.parameters[one.name].bounds
        # A loss that has come down to none is an answer.
        if one.value == high or (one.value == low and low != 0.0):
            bound = with_unit(number_words(one.value), one.unit)
            yield (
                f"{one.name} ended at its bound of {bound}: give it a wider one, or "
                "the model has not what the machine has."
            )


def _score_words(result: FitResult, graph: FinishedGraph) -> str:
    stretch = (
        "over whole recordings"
        if result.window is None
        else f"over windows of {number_words(result.window, 3)} s"
    )
    units = {m.name: m.unit for m in graph.measurements}
    channels = ", ".join(
        with_unit(f"{name} {number_words(rmse, 3)}", units[name])
        for name, rmse in result.score.rmse.items()
    )
    share = relative_error(result.score, "the measured spread")
    return f"Error {stretch}: {share} ({channels} rms)."


def _plain(result: FitResult, profiles: Sequence[Profile]) -> dict[str, object]:
    return {
        "schema": 1,
        "status": result.status.name.lower(),
        "sentence": result.status.value,
        "parameters": {
            e.name: {
                "value": json_value(e.value),
                "std": json_value(e.std),
                "interval": None if e.interval is None else list(e.interval),
                "unit": e.unit,
                "start": json_value(e.start),
            }
            for e in result.estimates
        },
        "nrmse": json_value(result.score.nrmse),
        "rmse": json_value(result.score.rmse),
        "unidentifiable": list(result.unidentifiable),
        "barely_known": list(result.barely_known),
        "noise_correlation": dict(result.correlation),
        "solver_error": _plain_solver_error(result.solver_error),
        "profiles": {
            one.name: {
                "status": one.status.name.lower(),
                "sentence": one.status.value,
                "interval": list(one.interval),
                "values": list(one.values),
                "rise": list(one.rise),
                "threshold": one.threshold,
            }
            for one in profiles
        },
        "iterations": result.iterations,
        "window": json_value(result.window),
        "model": to_python(result.model),
    }


def _plain_solver_error(error: SolverError | None) -> dict[str, object] | None:
    if error is None:
        return None
    return {
        "status": error.status.name.lower(),
        "sentence": error.status.value,
        "rmse": json_value(error.rmse),
        "shift": json_value(error.shift),
    }
