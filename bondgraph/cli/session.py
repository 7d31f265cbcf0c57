"""One call of the program: what it says, and what it has written so far.

Answers go to stdout, everything else to stderr. Where ``--json -`` sends the answer to
stdout as JSON, its words are left out, so that a program reads JSON and nothing else.
Names from models and files are printed, so no control code in them reaches a terminal.
"""

import json
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from enum import IntEnum, StrEnum
from pathlib import Path
from typing import Any, TextIO

import click

from bondgraph.cli.first_use import told_of_compiling
from bondgraph.progress import Silent, Step, Steps, shown_progress
from bondgraph.reporting.files import write_text

STDOUT = "-"
_COLOUR_CODE = re.compile(r"\x1b\[[0-9;]*m")
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")


class Loudness(IntEnum):
    """How much is said beside the answer."""

    QUIET = 0
    NORMAL = 1
    VERBOSE = 2


class Colour(StrEnum):
    """When text is coloured."""

    AUTO = "auto"
    ALWAYS = "always"
    NEVER = "never"


class Session:
    """What one call of the program has said and written.

    Attributes
    ----------
    traceback
        Whether the user asked to see where errors come from.
    loudness
        How much is said beside the answer.
    colour
        When text is coloured.
    resumes
        Says how work that is interrupted now can be gone on with; empty where nothing
        is kept.
    command
        The command line of this call, for a page that says how it was made.
    """

    def __init__(self) -> None:
        self.traceback = False
        self.loudness = Loudness.NORMAL
        self.colour = Colour.AUTO
        self.resumes: Callable[[], str] = str
        self.command = ""
        self._silent = False
        self._written: list[str] = []

    @property
    def verbose(self) -> bool:
        """Whether everything is to be said."""
        return self.loudness is Loudness.VERBOSE

    def say(self, text: str = "") -> None:
        """Print a part of the answer on stdout."""
        if not self._silent:
            _print(text, sys.stdout, coloured=self.coloured(sys.stdout))

    def hint(self, text: str) -> None:
        """Print on stdout what helps after the answer; nothing where quiet."""
        if self.loudness is not Loudness.QUIET:
            self.say(text)

    def note(self, text: str) -> None:
        """Print something about the work, not the answer, on stderr."""
        if self.loudness is not Loudness.QUIET:
            self._tell(text)

    def _tell(self, text: str) -> None:
        _print(text, sys.stderr, coloured=self.coloured(sys.stderr))

    def refuse(self, sentence: str) -> int:
        """Print why the request cannot be served, on one line; return the status."""
        name = self.styled("bondgraph:", sys.stderr, fg="red", bold=True)
        self._tell(f"{name} {_visible(' '.join(sentence.split()))}")
        return 2

    def show_traceback(self, text: str) -> None:
        """Print where an error was raised, if that was asked for."""
        if self.traceback:
            self._tell(text)

    def coloured(self, stream: TextIO) -> bool:
        """Return whether text written to `stream` is coloured."""
        from bondgraph.reporting.tables import wants_colour  # noqa: PLC0415 (0.3 s)

        if self.colour is Colour.AUTO:
            return stream.isatty() and wants_colour(stream)
        return self.colour is Colour.ALWAYS

    def styled(self, text: str, stream: TextIO, **style: Any) -> str:
        """Return text in a colour where `stream` shows colours."""
        return click.style(text, **style) if self.coloured(stream) else text

    def answers_in(self, json_file: str | None) -> None:
        """Keep stdout for JSON if that is where it goes."""
        self._silent = json_file == STDOUT

    def wrote(self, path: Path | str) -> None:
        """Remember a file that stays, whatever happens next."""
        self._written.append(str(path))

    def kept(self) -> str:
        """Return in words what has been written so far, and how to go on."""
        files = f"kept {' and '.join(self._written)}" if self._written else ""
        return "; ".join(filter(None, (files, self.resumes()))) or "nothing was written"

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
        write_text(path, text)
        self.wrote(path)

    def deliver(self, json_file: str | None, answer: Mapping[str, Any]) -> None:
        """Write an answer as JSON where ``--json`` asks for it."""
        if json_file is not None:
            text = json.dumps(answer, indent=2, ensure_ascii=False, allow_nan=False)
            self.write(json_file, text + "\n")

    @contextmanager
    def progress(self, *, loops: bool = False) -> Iterator[Step]:
        """Yield a function that is told each step.

        A terminal shows the present one; ``-v`` prints them all, one a line. Anything
        else shows nothing: a log has no use for it.

        Parameters
        ----------
        loops
            Whether compiled loops are run, so that they may have to be compiled first,
            which is noted.
        """
        shown: Callable[[], Any] = shown_progress
        if self.verbose:
            shown = Steps(self._tell).shown
        elif self.loudness is Loudness.QUIET or not sys.stderr.isatty():
            shown = Silent().shown
        told = told_of_compiling(self.note) if loops else nullcontext()
        with shown() as step, told:
            yield step


def _print(text: str, stream: TextIO, *, coloured: bool) -> None:
    clean = text.rstrip("\n")
    pieces = _COLOUR_CODE.split(clean)
    codes = _COLOUR_CODE.findall(clean) if coloured else [""] * (len(pieces) - 1)
    whole = _visible(pieces[0]) + "".join(
        code + _visible(piece) for code, piece in zip(codes, pieces[1:], strict=True)
    )
    click.echo(whole, file=stream, color=coloured)


def _visible(text: str) -> str:
    """Return text with control characters spelled out, but for tabs and line ends."""
    return _CONTROL.sub(lambda c: f"\\x{ord(c.group()):02x}", text)
