"""``bondgraph export``: the model in the words of other programs."""

from collections.abc import Callable
from pathlib import Path

import click

from bondgraph.cli.command import Command, OneOf, json_option
from bondgraph.cli.inputs import model_argument, read_model
from bondgraph.cli.output_file import OutputFile
from bondgraph.cli.session import STDOUT, Session
from bondgraph.reporting.export.exporting import (
    C99,
    ExportedFile,
    Json,
    Latex,
    Matlab,
    Modelica,
    PythonControl,
    PythonFunctions,
    PythonModel,
    Target,
    export,
)

_TARGETS: dict[str, Callable[[str | None], Target]] = {
    "c": C99,
    "matlab": Matlab,
    "modelica": Modelica,
    "latex": lambda _: Latex(),
    "control": PythonControl,
    "numpy": PythonFunctions,
    "python": lambda _: PythonModel(),
    "json": lambda _: Json(),
}
_FORMERLY = {"python-control": "control"}


@click.command(
    "export",
    cls=Command,
    examples=(
        ("export leg.py:flight --to c -o leg.c", "C99: leg.c and leg.h"),
        ("export leg.py:flight --to modelica -o Leg.mo", "For OpenModelica, Dymola"),
        ("export leg.py:flight --to latex", "The equations, on the terminal"),
    ),
)
@model_argument
@click.option(
    "--to",
    "form",
    type=OneOf([*_TARGETS, *_FORMERLY]),
    required=True,
    help="c, matlab (Octave too), modelica: a program that simulates the model there; "
    "control, numpy: Python text for python-control or SciPy; latex: the equations; "
    "python: the graph itself; json: the linear system.",
)
@click.option(
    "-o",
    "--output",
    default=STDOUT,
    metavar="FILE",
    type=OutputFile(),
    help="Where to write it, which also names it there; stdout otherwise.",
)
@json_option
@click.pass_obj
def command(
    session: Session,
    /,
    *,
    model: str,
    values: tuple[str, ...],
    form: str,
    output: str,
    json_file: str | None,
) -> None:
    """Write MODEL in the words of other programs."""
    if json_file == STDOUT == output:
        raise click.UsageError("The text and the JSON cannot both go to stdout.")
    graph = read_model(model, values)
    name = None if output == STDOUT else Path(output).stem
    files = export(graph, _TARGETS[_FORMERLY.get(form, form)](name))
    if output == STDOUT:
        session.write(STDOUT, _together(files))
    else:
        first, *others = files
        session.write(output, first.text)
        for file in others:
            session.write(Path(output).with_name(file.name), file.text)
    session.deliver(
        json_file,
        {
            "schema": 1,
            "model": graph.name,
            "form": form,
            "text": _together(files),
            "files": {file.name: file.text for file in files},
        },
    )


def _together(files: tuple[ExportedFile, ...]) -> str:
    """Return all files as one text; a C header takes the place of its inclusion."""
    text = files[0].text
    for file in files[1:]:
        text = text.replace(f'#include "{file.name}"\n', file.text)
    return text
