"""``bondgraph draw``: the picture of a graph."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from bondgraph.causality.assignment import assign_causality
from bondgraph.cli.command import Command, OneOf, json_option
from bondgraph.cli.inputs import model_argument, read_model
from bondgraph.cli.output_file import OutputFile
from bondgraph.cli.session import STDOUT, Session
from bondgraph.errors import BondGraphError
from bondgraph.reporting.drawing import (
    BondLabels,
    Colouring,
    Theme,
    draw_png,
    draw_svg,
)
from bondgraph.reporting.files import unwritable

_NUMBER = {
    "bonds": BondLabels.NUMBERS,
    "names": BondLabels.NAMES,
    "variables": BondLabels.VARIABLES,
    "none": BondLabels.NONE,
}


@click.command(
    "draw",
    cls=Command,
    examples=(
        ("draw leg.py:flight -o leg.svg", "The graph with its causal strokes"),
        ("draw leg.py:flight -o leg.png --number bonds", "A PNG with numbered bonds"),
        ("draw leg.py -o leg.svg --blame result.json", "Where physics is missing"),
    ),
)
@model_argument
@click.option(
    "-o",
    "--output",
    default=STDOUT,
    metavar="FILE",
    type=OutputFile(".svg", ".png"),
    help="Where to write the picture, SVG or by its name PNG; stdout otherwise.",
)
@click.option(
    "--number",
    type=OneOf(list(_NUMBER)),
    default="none",
    show_default=True,
    help="What to write at bonds: their number, their name, or effort and flow.",
)
@click.option(
    "--signals", is_flag=True, help="Draw sensors and modulation as activated bonds."
)
@click.option(
    "--colour-by",
    "values_file",
    metavar="FILE",
    type=click.Path(allow_dash=True),
    help="Colour places by a JSON file of values by name.",
)
@click.option(
    "--blame",
    metavar="FILE",
    type=click.Path(allow_dash=True),
    help="Colour the junctions by the blame in the JSON of a diagnosis.",
)
@click.option("--no-strokes", is_flag=True, help="Leave the causal strokes out.")
@click.option(
    "--theme",
    type=OneOf([theme.value for theme in Theme]),
    default=Theme.AUTO.value,
    show_default=True,
    help="Colours for light paper, dark screens, or whichever is read.",
)
@click.option(
    "--scale",
    type=click.FloatRange(0.1, 10.0),
    default=2.0,
    show_default=True,
    help="Size of a PNG.",
)
@json_option
@click.pass_obj
def command(
    session: Session,
    /,
    *,
    model: str,
    values: tuple[str, ...],
    output: str,
    json_file: str | None,
    scale: float,
    **look: Any,
) -> None:
    """Draw MODEL as SVG or PNG with half arrows, causal strokes and names."""
    if json_file == STDOUT == output:
        raise click.UsageError("The picture and the JSON cannot both go to stdout.")
    if look["blame"] is not None and look["values_file"] is not None:
        raise click.UsageError("A picture has one colour: --colour-by or --blame.")
    graph = read_model(model, values)
    assignment = None if look["no_strokes"] else assign_causality(graph)
    shares = {} if look["blame"] is None else _blame(Path(look["blame"]))
    file = look["values_file"]
    shown = {
        "assignment": assignment,
        "blame": shares,
        "colour": None if file is None else _colouring(Path(file)),
        "labels": _NUMBER[look["number"]],
        "signals": look["signals"],
        "theme": look["theme"],
    }
    if output.lower().endswith(".png"):
        _write(session, Path(output), draw_png(graph, scale=scale, **shown))
    else:
        session.write(output, draw_svg(graph, **shown))
    strokes = () if assignment is None else assignment.strokes
    session.deliver(
        json_file,
        {
            "schema": 1,
            "model": graph.name,
            "picture": None if output == STDOUT else output,
            "bonds": [[bond.tail, bond.head] for bond in graph.bonds],
            "strokes": {stroke.bond.name: stroke.at for stroke in strokes},
            "blame": shares,
        },
    )


def _write(session: Session, path: Path, picture: bytes) -> None:
    try:
        path.write_bytes(picture)
    except OSError as error:
        raise unwritable(path, error.strerror) from error
    session.wrote(path)


def _read(path: Path) -> Any:
    """Return what a JSON file holds, None where it is no JSON."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):  # the latter of brackets nested too deeply
        return None


def _blame(path: Path) -> dict[str, float]:
    """Return the blame in a diagnosis that was written as JSON."""
    content = _read(path)
    shares = _numbers(content.get("blame")) if isinstance(content, dict) else None
    if shares is None:
        raise BondGraphError(
            f"{str(path)!r} is not the JSON of a diagnosis.",
            (str(path),),
            "Write one with bondgraph diagnose --json FILE.",
        )
    return shares


def _colouring(path: Path) -> Colouring:
    """Return the colouring in a JSON file: values by place, or with words around."""
    content = _read(path)
    words: dict[str, Any] = {}
    if isinstance(content, dict) and isinstance(content.get("values"), dict):
        words, content = content, content["values"]
    values = _numbers(content)
    if not values:
        raise BondGraphError(
            f"{str(path)!r} does not give numbers by place.",
            (str(path),),
            'Write {"worm": 0.8, "joint": 0.2}, or {"values": {…}, "caption": "power '
            'lost", "unit": "W"}.',
        )
    return Colouring(values, str(words.get("caption", "")), str(words.get("unit", "")))


def _numbers(content: object) -> dict[str, float] | None:
    """Return a table of finite numbers by name; None if it is something else."""
    if not isinstance(content, Mapping):
        return None
    for value in content.values():
        if isinstance(value, bool) or not isinstance(value, int | float):
            return None
        if not math.isfinite(value):
            return None
    return {str(place): float(value) for place, value in content.items()}
