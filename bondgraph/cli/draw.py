"""``bondgraph draw``: the picture of a graph."""

import json
from pathlib import Path

import click

from bondgraph.causality.assignment import assign_causality
from bondgraph.cli.inputs import model_argument, read_model
from bondgraph.cli.session import STDOUT, Session, json_option
from bondgraph.errors import BondGraphError
from bondgraph.reporting.drawing import draw_svg


@click.command("draw")
@model_argument
@click.option(
    "-o",
    "--output",
    default=STDOUT,
    metavar="FILE",
    help="Where to write the SVG; stdout otherwise.",
)
@click.option(
    "--blame",
    metavar="FILE",
    help="Colour the junctions by the blame in the JSON of a diagnosis.",
)
@click.option("--no-strokes", is_flag=True, help="Leave the causal strokes out.")
@json_option
@click.pass_obj
def command(
    session: Session,
    /,
    *,
    model: str,
    values: tuple[str, ...],
    output: str,
    blame: str | None,
    no_strokes: bool,
    json_file: str | None,
) -> None:
    """Draw MODEL as SVG with half arrows, causal strokes and names."""
    if json_file == STDOUT == output:
        raise click.UsageError("The picture and the JSON cannot both go to stdout.")
    graph = read_model(model, values)
    strokes = {}
    if not no_strokes:
        strokes = {s.bond.name: s.at for s in assign_causality(graph).strokes}
    shares = {} if blame is None else _blame(Path(blame))
    session.write(output, draw_svg(graph, assignment=strokes, blame=shares))
    session.deliver(
        json_file,
        {
            "schema": 1,
            "model": graph.name,
            "picture": None if output == STDOUT else output,
            "bonds": [[bond.tail, bond.head] for bond in graph.bonds],
            "strokes": strokes,
            "blame": shares,
        },
    )


def _blame(path: Path) -> dict[str, float]:
    """Return the blame in a diagnosis that was written as JSON."""
    try:
        shares = json.loads(path.read_text(encoding="utf-8"))["blame"]
        return {str(place): float(share) for place, share in shares.items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise BondGraphError(
            f"{str(path)!r} is not the JSON of a diagnosis.",
            (str(path),),
            "Write one with bondgraph diagnose --json FILE.",
        ) from error
