"""A command of the program: its help with examples, and what all commands share.

Every command has ``-q``, ``-v``, ``--color`` and ``--traceback``, before the command's
name or after it, and ``--json``. They act on the session and are not passed on.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import click

from bondgraph.cli.output_file import OutputFile, refuse_overwriting
from bondgraph.cli.session import Colour, Loudness, Session
from bondgraph.errors import did_you_mean

F = TypeVar("F", bound=Callable[..., Any])
Example = tuple[str, str]
ARGUMENT, COMMON = "Arguments", "In every command"
RECORDINGS = "How recordings are read"
ARGUMENTS = {
    "MODEL": "file.py:factory or package.module:factory; without factory where the "
    "file has one. The file is Python and is run.",
    "REC": "A recording: CSV, Parquet, MAT or HDF5.",
}


class Option(click.Option):
    """An option that says under which heading of the help it stands."""

    def __init__(self, *names: Any, heading: str = "Options", **rest: Any) -> None:
        super().__init__(*names, **rest)
        self.heading = heading


class OneOf(click.Choice[str]):
    """One of some words; a wrong one is answered with the nearest."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> str:
        """Return the word, or refuse it."""
        if value not in self.choices:
            words = ", ".join(self.choices)
            near = did_you_mean(str(value), self.choices)
            hint = near if near.startswith("Did") else f"It is one of {words}."
            self.fail(f"there is no {value!r}. {hint}", param, ctx)
        return super().convert(value, param, ctx)


def positive_number(value: str) -> float | None:
    """Return the positive finite number that a text is; None where it is none."""
    try:
        number = float(value)
    except ValueError:
        return None
    return number if 0.0 < number < math.inf else None


class WholeNumber(click.IntRange):
    """An integer in a range, called as people call it when it is none."""

    name = "whole number"


class Command(click.Command):
    """A command with examples in its help and the options that all commands have.

    Parameters
    ----------
    examples
        Command lines without the program's name, each with what it does.
    """

    def __init__(
        self, *words: Any, examples: Sequence[Example] = (), **rest: Any
    ) -> None:
        super().__init__(*words, **rest)
        self.examples = tuple(examples)
        self.params += common_options()

    def invoke(self, ctx: click.Context) -> Any:
        """Run it, where it writes over nothing that it reads."""
        refuse_overwriting(ctx)
        return super().invoke(ctx)

    def format_options(
        self, ctx: click.Context, formatter: click.HelpFormatter
    ) -> None:
        """Write the options under their headings, those of every command last."""
        format_options(self, ctx, formatter)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the examples, each under what it does."""
        format_examples(self.examples, formatter)
        super().format_epilog(ctx, formatter)


def format_options(
    command: click.Command, ctx: click.Context, formatter: click.HelpFormatter
) -> None:
    """Write the options of a command under their headings."""
    headings: dict[str, list[tuple[str, str]]] = {ARGUMENT: [], "Options": []}
    for param in command.get_params(ctx):
        if isinstance(param, click.Argument):
            word = param.make_metavar(ctx).strip("[]").removesuffix("...")
            if word in ARGUMENTS:
                headings[ARGUMENT].append((word, ARGUMENTS[word]))
            continue
        record = param.get_help_record(ctx)
        if record is not None:
            common = {"--json", "--help", "--version"} & set(param.opts)
            own = COMMON if common else getattr(param, "heading", "Options")
            headings.setdefault(own, []).append(record)
    for heading, records in sorted(headings.items(), key=lambda h: h[0] == COMMON):
        if records:
            with formatter.section(heading):
                formatter.write_dl(records)


def format_examples(
    examples: Sequence[Example], formatter: click.HelpFormatter
) -> None:
    """Write examples, each line as it is typed under a line of what it does."""
    if not examples:
        return
    with formatter.section("Examples"):
        for line, does in examples:
            formatter.write_text(f"{does}:")
            formatter.write(f"{'':{formatter.current_indent + 2}}bondgraph {line}\n")


def common_options() -> list[click.Parameter]:
    """Return the options of every command, which set what the session does."""
    return [
        _common(
            ["-q", "--quiet"],
            _set("loudness", Loudness.QUIET),
            is_flag=True,
            help="Say only the answer, without hints, notes and progress.",
        ),
        _common(
            ["-v", "--verbose"],
            _set("loudness", Loudness.VERBOSE),
            is_flag=True,
            help="Say each step with its time, and every note and candidate.",
        ),
        _common(
            ["--color", "--colour"],
            lambda session, word: setattr(session, "colour", Colour(word)),
            type=OneOf([one.value for one in Colour]),
            metavar="WHEN",
            help="auto (on a terminal, unless NO_COLOR is set), always or never.",
        ),
        _common(
            ["--traceback"],
            _set("traceback", True),
            is_flag=True,
            help="Show where an error was raised.",
        ),
    ]


def _common(
    names: list[str], act: Callable[[Session, Any], None], **rest: Any
) -> Option:
    def callback(ctx: click.Context, _: click.Parameter, value: Any) -> None:
        if value:
            act(ctx.ensure_object(Session), value)

    return Option(names, heading=COMMON, expose_value=False, callback=callback, **rest)


def _set(name: str, value: object) -> Callable[[Session, Any], None]:
    return lambda session, _: setattr(session, name, value)


def json_option(command: F) -> F:
    """Add ``--json FILE``, which every command has."""
    return click.option(
        "--json",
        "json_file",
        metavar="FILE",
        type=OutputFile(),
        help="Write the answer as JSON; - is stdout and leaves the words out.",
    )(command)
