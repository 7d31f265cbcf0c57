"""One call of the program: what it says, and what it has written so far.

Answers go to stdout, everything else to stderr. Where ``--json -`` sends the answer to
stdout as JSON, its words are left out, so that a program reads JSON and nothing else.
"""

import json
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import click

from bondgraph.errors import BondGraphError

STDOUT = "-"
F = TypeVar("F", bound=Callable[..., Any])


class Session:
    """What one call of the program has said and written.

    Attributes
    ----------
    traceback
        Whether the user asked to see where errors come from.
    """

    def __init__(self) -> None:
        self.traceback = False
        self._silent = False
        self._written: list[str] = []

    def say(self, text: str = "") -> None:
        """Print a part of the answer on stdout."""
        if not self._silent:
            click.echo(text.rstrip("\n"))

    def note(self, text: str) -> None:
        """Print something about the work, not the answer, on stderr."""
        click.echo(text.rstrip("\n"), err=True)

    def refuse(self, sentence: str) -> int:
        """Print why the request cannot be served, on one line; return the status."""
        self.note(f"bondgraph: {' '.join(sentence.split())}")
        return 2

    def answers_in(self, json_file: str | None) -> None:
        """Keep stdout for JSON if that is where it goes."""
        self._silent = json_file == STDOUT

    def wrote(self, path: Path | str) -> None:
        """Remember a file that stays, whatever happens next."""
        self._written.append(str(path))

    def kept(self) -> str:
        """Return in words what has been written so far."""
        if not self._written:
            return "nothing was written"
        return f"kept {' and '.join(self._written)}"

    def write(self, path: Path | str, text: str) -> None:
        """Write text to a file, or to stdout where `path` is ``-``.

        Raises
        ------
        BondGraphError
            If the file cannot be written.
        """
        if str(path) == STDOUT:
            click.echo(text.rstrip("\n"))
            return
        try:
            Path(path).write_text(text, encoding="utf-8")
        except OSError as error:
            raise BondGraphError(
                f"{str(path)!r} cannot be written ({error.strerror}).",
                (str(path),),
                "Name a file in a directory that exists and may be written to.",
            ) from error
        self.wrote(path)

    def deliver(self, json_file: str | None, answer: Mapping[str, Any]) -> None:
        """Write an answer as JSON where ``--json`` asks for it."""
        if json_file is not None:
            text = json.dumps(answer, indent=2, ensure_ascii=False, allow_nan=False)
            self.write(json_file, text + "\n")

    @contextmanager
    def progress(self) -> Iterator[Callable[[str], None]]:
        """Yield a function that shows the current step on a terminal.

        On anything but a terminal it shows nothing: a log has no use for it.
        """
        if not sys.stderr.isatty():
            yield lambda _: None
            return
        from rich.console import Console  # noqa: PLC0415  (0.1 s, only on a terminal)
        from rich.progress import Progress, SpinnerColumn, TextColumn  # noqa: PLC0415
        from rich.progress import TimeElapsedColumn as Elapsed  # noqa: PLC0415

        columns = (SpinnerColumn(), Elapsed(), TextColumn("{task.description}"))
        console = Console(stderr=True)
        with Progress(*columns, console=console, transient=True) as shown:
            task = shown.add_task("")
            yield lambda step: shown.update(task, description=step)


def json_option(command: F) -> F:
    """Add ``--json FILE``, which every command has."""
    return click.option(
        "--json",
        "json_file",
        metavar="FILE",
        help="Write the answer as JSON; - is stdout and leaves the words out.",
    )(command)
