"""``bondgraph export``: the model in the words of other programs."""

import json
from collections.abc import Callable

import click

from bondgraph.cli.inputs import model_argument, read_model
from bondgraph.cli.session import STDOUT, Session, json_option
from bondgraph.equations.derivation import derive
from bondgraph.equations.rendering import as_latex
from bondgraph.numeric.state_space import StateSpace, state_space
from bondgraph.reporting.model_text import to_python
from bondgraph.structure.graph import FinishedGraph


def _latex(graph: FinishedGraph) -> str:
    return as_latex(derive(graph)) + "\n"


def _python_control(graph: FinishedGraph) -> str:
    """Return a Python text that makes the linear system with its signal names."""
    system = state_space(graph)
    return (
        "import control\n\n"
        "system = control.ss(\n"
        + "".join(f"    {m.tolist()!r},\n" for m in _matrices(system))
        + f"    states={list(system.states)!r},\n"
        + f"    inputs={list(system.inputs)!r},\n"
        + f"    outputs={list(system.outputs)!r},\n"
        # python-control allows no dots in names
        + f"    name={system.name.replace('.', '_')!r},\n"
        + ")\n"
    )


def _json(graph: FinishedGraph) -> str:
    """Return the numbers of the linear system with names and units."""
    system = state_space(graph)
    plain = {
        "schema": 1,
        "model": system.name,
        "states": list(system.states),
        "inputs": list(system.inputs),
        "outputs": list(system.outputs),
        "units": {
            "states": list(system.state_units),
            "inputs": list(system.input_units),
            "outputs": list(system.output_units),
        },
    }
    letters = dict(zip("ABCD", _matrices(system), strict=True))
    matrices = {letter: matrix.tolist() for letter, matrix in letters.items()}
    return json.dumps({**plain, **matrices}, indent=2, ensure_ascii=False) + "\n"


def _matrices(system: StateSpace):  # type: ignore[no-untyped-def]
    return (system.A, system.B, system.C, system.D)


_WRITERS: dict[str, Callable[[FinishedGraph], str]] = {
    "latex": _latex,
    "python": to_python,
    "python-control": _python_control,
    "json": _json,
}


@click.command("export")
@model_argument
@click.option(
    "--to",
    "form",
    type=click.Choice(list(_WRITERS)),
    required=True,
    help="LaTeX of the equations; Python text of the graph; the linear system at the "
    "model's parameter values for python-control or as JSON.",
)
@click.option(
    "-o",
    "--output",
    default=STDOUT,
    metavar="FILE",
    help="Where to write it; stdout otherwise.",
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
    text = _WRITERS[form](graph)
    session.write(output, text)
    session.deliver(
        json_file,
        {"schema": 1, "model": graph.name, "form": form, "text": text},
    )
