"""``bondgraph fit``: parameters with what is known of them afterwards."""

import click

from bondgraph.cli.fit_options import fit_options
from bondgraph.cli.inputs import (
    Reading,
    model_argument,
    read_model,
    read_recordings,
    recording_options,
)
from bondgraph.cli.session import Session, json_option
from bondgraph.cli.terminal import table_style
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import Settings, fit
from bondgraph.fitting.result import FitResult, FitStatus
from bondgraph.reporting.diagnosis_json import json_value
from bondgraph.reporting.model_text import to_python
from bondgraph.reporting.tables import estimates_table
from bondgraph.reporting.wording import number_words, percent


@click.command("fit")
@model_argument
@click.argument("recordings", metavar="REC...", nargs=-1, required=True)
@click.option("-o", "--output", metavar="FILE", help="Write the fitted model (Python).")
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
    output: str | None,
    settings: Settings,
    reading: Reading,
    json_file: str | None,
) -> int:
    """Fit the free parameters of MODEL to recordings by simulation error.

    Exit status 1 if the fit did not converge.
    """
    session.answers_in(json_file)
    graph = read_model(model, values)
    bound = read_recordings(recordings, graph, reading)
    with session.progress() as progress:
        progress(f"fitting {graph.name}")
        result = fit(graph, bound, settings=settings)
    if result.status is FitStatus.SIMULATION_FAILED:
        raise FitError(
            f"{graph.name!r} cannot be simulated at its start values.",
            (graph.name,),
            "Give other start values, bounds, or a shorter --window.",
        )
    session.say(result.status.value)
    session.say()
    session.say(estimates_table(result.estimates, **table_style()))
    session.say()
    session.say(_score_words(result))
    for sentence in result.unidentifiable:
        session.say(f"Not identifiable from these recordings: {sentence}.")
    if output is not None:
        session.write(output, to_python(result.model))
    session.deliver(json_file, _plain(result))
    return 0 if result.status is FitStatus.CONVERGED else 1


def _score_words(result: FitResult) -> str:
    stretch = (
        "over whole recordings"
        if result.window is None
        else f"over windows of {number_words(result.window, 3)} s"
    )
    return f"Error {stretch}: {percent(result.score.nrmse)} of the measured spread."


def _plain(result: FitResult) -> dict[str, object]:
    return {
        "schema": 1,
        "status": result.status.name.lower(),
        "sentence": result.status.value,
        "parameters": {
            e.name: {
                "value": json_value(e.value),
                "std": json_value(e.std),
                "unit": e.unit,
                "start": json_value(e.start),
            }
            for e in result.estimates
        },
        "nrmse": json_value(result.score.nrmse),
        "rmse": json_value(result.score.rmse),
        "unidentifiable": list(result.unidentifiable),
        "iterations": result.iterations,
        "window": json_value(result.window),
        "model": to_python(result.model),
    }
