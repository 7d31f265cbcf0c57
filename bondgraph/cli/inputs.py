"""What the user names on the command line, as objects: a model and its recordings.

Options of every command that reads recordings are declared here once. The library's
refusals name its own arguments; here they are spelled as the options of this program.
"""

import ast
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click
import numpy as np
from click.shell_completion import CompletionItem

from bondgraph.cli.reading_options import Reading
from bondgraph.errors import BondGraphError, ParameterError, RecordingError
from bondgraph.loading import load_model
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.model_channels import read_for
from bondgraph.recordings.names import parse_mapping
from bondgraph.structure.graph import FinishedGraph

F = TypeVar("F", bound=Callable[..., Any])


class ModelName(click.Path):
    """``file.py:factory`` or ``package.module:factory``, completed in a shell."""

    name = "model"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Return the functions of the file before a colon; before that, files.

        The file is read, never run.
        """
        where, colon, begun = incomplete.partition(":")
        if not colon:
            return [CompletionItem(incomplete, type="file")]
        try:
            tree = ast.parse(Path(where).read_text(encoding="utf-8"))
        except (OSError, ValueError, SyntaxError):
            return []
        names = [n.name for n in tree.body if isinstance(n, ast.FunctionDef)]
        return [
            CompletionItem(f"{where}:{name}")
            for name in names
            if name.startswith(begun) and not name.startswith("_")
        ]


def model_argument(command: F) -> F:
    """Add the argument MODEL and the option ``--set``, which belong together."""
    values = click.option(
        "--set",
        "values",
        multiple=True,
        metavar="NAME=VALUE",
        help="Another value of a parameter, in SI units: a number or a ratio, 1/6900.",
    )
    return click.argument("model", type=ModelName())(values(command))


def recording_argument(name: str, *, nargs: int = 1) -> Callable[[F], F]:
    """Add the argument REC, a file; any number of them where `nargs` is -1."""
    return click.argument(
        name,
        metavar="REC..." if nargs < 0 else "REC",
        nargs=nargs,
        required=True,
        type=click.Path(),
    )


def read_model(reference: str, values: Sequence[str] = ()) -> FinishedGraph:
    """Return the model that `reference` names, with the values of ``--set`` in it.

    Raises
    ------
    ModelLoadError
        If the model cannot be found or its code fails.
    ParameterError
        If a value is not a number, or its parameter is not in the model.
    """
    graph = load_model(reference)
    return graph.with_parameters(dict(_number(text) for text in values))


def _number(text: str) -> tuple[str, float]:
    """Return a parameter and its value, which may be a ratio: of a compliance, 1/k."""
    name, _, value = (part.strip() for part in text.partition("="))
    above, slash, below = value.partition("/")
    try:
        return name, float(above) / float(below) if slash else float(value)
    except (ValueError, ZeroDivisionError):
        raise ParameterError(
            f"--set {text} does not give a parameter a number.",
            (name,),
            "Write --set name=value, as --set mass=95.1 or --set spring=1/6900.",
        ) from None


def read_recordings(
    paths: Sequence[str], graph: FinishedGraph, reading: Reading
) -> list[BoundRecording]:
    """Return recordings as the inputs and measurements of the model.

    Each is called by its file's name without suffix, or by its path where two files
    have the same name.

    Raises
    ------
    RecordingError, MissingExtraError
        If a file cannot be read or does not fit the model.
    """
    stems = [Path(path).stem for path in paths]
    names = [
        stem if stems.count(stem) == 1 else path
        for stem, path in zip(stems, paths, strict=True)
    ]
    return [
        _read(path, name, graph, reading)
        for path, name in zip(paths, names, strict=True)
    ]


def _read(
    path: str, name: str, graph: FinishedGraph, reading: Reading
) -> BoundRecording:
    try:
        whole = read_for(
            graph,
            path,
            name=name,
            mapping=parse_mapping(reading.map),
            units=_units(reading.unit),
            time=reading.time,
            step=reading.step,
            steady=reading.steady,
            gaps=reading.gaps,
            order=reading.order,
            repeats=reading.repeats,
            delimiter=reading.delimiter,
            decimal=reading.decimal,
            encoding=reading.encoding,
        )
    except BondGraphError as error:
        remedy = as_options(error.remedy)
        raise type(error)(error.problem, error.about, remedy) from error
    return _between(whole, reading.begin, reading.end)


def _between(
    whole: BoundRecording, begin: float | None, end: float | None
) -> BoundRecording:
    """Return what was recorded from one time to another, both included."""
    if begin is None and end is None:
        return whole
    if whole.steady:
        raise RecordingError(
            f"The rows of {whole.name!r} are operating points and have no time.",
            (whole.name,),
            "Leave out --begin and --end, or --steady.",
        )
    first, last = float(whole.time[0]), float(whole.time[-1])
    start = np.searchsorted(whole.time, first if begin is None else begin)
    stop = np.searchsorted(whole.time, last if end is None else end, side="right")
    if stop - start < 2:
        raise RecordingError(
            f"Fewer than two samples of {whole.name!r} lie between --begin and --end.",
            (whole.name,),
            f"It was recorded from {first:.6g} to {last:.6g} s.",
        )
    return whole.part(int(start), int(stop))


def _units(words: Sequence[str]) -> dict[str, str]:
    units = {}
    for word in words:
        name, _, unit = (part.strip() for part in word.partition("="))
        if not name or not unit:
            raise RecordingError(
                f"--unit {word} does not give a channel a unit.",
                (word,),
                "Write --unit name=unit, as --unit theta=deg.",
            )
        units[name] = unit
    return units


_SPELLINGS = (
    # A model says which channels are read, so none can be left out.
    (r",? (or|and) leave (it|the channel|the column) out with channels=\(\.\.\.\)", ""),
    (r",? (or say which to read with|and) channels=\(\.\.\.\)( if it was given)?", ""),
    (r"mapping=\{.*?\}", "--map time=t[s] --map NAME=CHANNEL[unit]"),
    (r'units=\{"([^"]*)": "([^"]*)"\}', r"--unit \1=\2"),
    (r"\b(time)=\.\.\.", r"--time NAME"),
    (r"\bstep=\.\.\.( in seconds)?", r"--step SECONDS"),
    (r"\bsteady=True", r"--steady"),
    (r"""\b(gaps|order|repeats|delimiter|decimal|encoding)=["']([^"']*)["']""",
     r"--\1 '\2'"),
    (r"\b(\w+)=(CHANNEL|COLUMN)\b", r"--map \1=\2"),
    (r"--(\w+) '(\w[\w-]*)'", r"--\1 \2"),
)  # fmt: skip


def as_options(remedy: str) -> str:
    """Return a remedy of the library with its arguments spelled as options."""
    for argument, option in _SPELLINGS:
        remedy = re.sub(argument, option, remedy)
    return remedy
