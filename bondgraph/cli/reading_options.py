"""The options for reading recordings, on the command line or in a file of them.

Every command that reads recordings has them. What one says of a test bench once and for
all stands in a TOML file, which ``--reading`` names; the command line goes before it.
What lies between two samples of an input is said of a bench too, so ``hold`` may stand
there, though it is an option of what simulates.
"""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import partial, wraps
from pathlib import Path
from typing import Any, TypeVar

import click

from bondgraph.cli.command import RECORDINGS, OneOf, Option
from bondgraph.errors import RecordingError, did_you_mean

F = TypeVar("F", bound=Callable[..., Any])
_option = partial(click.option, cls=Option, heading=RECORDINGS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """How recordings are read: the recording options as given.

    ``map`` and ``unit`` hold words such as ``theta=joint_angle`` and ``theta=deg``;
    ``begin`` and ``end`` are times of the recording, in seconds.
    """

    map: tuple[str, ...]
    unit: tuple[str, ...]
    time: str
    step: float | None
    begin: float | None
    end: float | None
    steady: bool
    gaps: str
    order: str
    repeats: str
    delimiter: str | None
    decimal: str
    encoding: str


def _from_file(ctx: click.Context, _: click.Parameter, value: str | None) -> None:
    """Take what a file says as the defaults of the other options.

    Raises
    ------
    RecordingError
        If the file cannot be read or says something else.
    """
    if value is not None and not ctx.resilient_parsing:
        ctx.default_map = {**(ctx.default_map or {}), **_defaults(Path(value))}


def _defaults(path: Path) -> dict[str, Any]:
    try:
        said = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeError, tomllib.TOMLDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise RecordingError(
            f"{str(path)!r} cannot be read as TOML ({why}).",
            (str(path),),
            "bondgraph new writes one to start from.",
        ) from error
    known = {field.name for field in fields(Reading)} | {_HOLD}
    for name, value in said.items():
        if name not in known:
            raise RecordingError(
                f"{str(path)!r} says {name!r}, which is no option for recordings.",
                (str(path), name),
                did_you_mean(name, known),
            )
        if isinstance(value, Mapping) != (name in _TABLES):
            form = f"[{name}] and lines such as theta = ..." if name in _TABLES else ""
            raise RecordingError(
                f"{name!r} in {str(path)!r} has the wrong form.",
                (str(path), name),
                f"Write {form or f'{name} = ...'}.",
            )
    return {
        name: [f"{k}={v}" for k, v in value.items()] if name in _TABLES else value
        for name, value in said.items()
    }


_TABLES = ("map", "unit")
_HOLD = "hold"
_OPTIONS = (
    _option(
        "--reading",
        metavar="FILE",
        type=click.Path(),
        is_eager=True,
        expose_value=False,
        callback=_from_file,
        help="TOML with these options and hold by name, as bondgraph new writes one.",
    ),
    _option(
        "--map",
        multiple=True,
        metavar="NAME=CHANNEL",
        help="Channel of the file for an input or measurement of the model; with a "
        "unit where the file has none (x=qm[m]).",
    ),
    _option(
        "--unit",
        multiple=True,
        metavar="NAME=UNIT",
        help="Unit of a channel, before the one that the file gives.",
    ),
    _option(
        "--time", default="time", show_default=True, help="Name of the time column."
    ),
    _option("--step", type=float, help="Seconds between samples without a time."),
    _option(
        "--begin",
        type=float,
        metavar="SECONDS",
        help="Leave out what was recorded before this time.",
    ),
    _option(
        "--end",
        type=float,
        metavar="SECONDS",
        help="Leave out what was recorded after this time.",
    ),
    _option(
        "--steady", is_flag=True, help="Rows are operating points, not samples in time."
    ),
    _option(
        "--gaps",
        type=OneOf(["refuse", "drop", "keep"]),
        default="refuse",
        show_default=True,
        help="Drop rows with empty cells, or keep the rest of such a row.",
    ),
    _option(
        "--order",
        type=OneOf(["refuse", "sort"]),
        default="refuse",
        show_default=True,
        help="What to do with times that run backward.",
    ),
    _option(
        "--repeats",
        type=OneOf(["refuse", "first", "mean"]),
        default="refuse",
        show_default=True,
        help="What to do with samples of equal time.",
    ),
    _option("--delimiter", help="Between the cells of a CSV file."),
    _option("--decimal", default=".", help="Decimal sign of a CSV file."),
    _option("--encoding", default="utf-8", help="Encoding of a CSV file."),
)


def recording_options(command: F) -> F:
    """Add the options for reading recordings; the command gets them as ``reading``."""
    names = [field.name for field in fields(Reading)]

    @wraps(command)
    def with_reading(*args: Any, **options: Any) -> Any:
        reading = Reading(**{name: options.pop(name) for name in names})
        return command(*args, reading=reading, **options)

    for option in reversed(_OPTIONS):
        with_reading = option(with_reading)
    return with_reading  # type: ignore[return-value]
