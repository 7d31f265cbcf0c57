"""Files that a command is to write, refused while the command line is read.

A search may take minutes; that its page has nowhere to go is known before. A recording
is measured once, and a model is somebody's work: a slip in the name of an output costs
neither.
"""

import errno
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from bondgraph.cli.session import STDOUT
from bondgraph.errors import BondGraphError
from bondgraph.reporting.files import unwritable


class OutputFile(click.Path):
    """The name of a file that can be written, or ``-`` for stdout.

    Parameters
    ----------
    suffixes
        With which it may end; any where none is given. A name may have none at all.
    """

    def __init__(self, *suffixes: str) -> None:
        super().__init__(allow_dash=True)
        self.suffixes = suffixes

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Any:
        """Return the name, or refuse it.

        Raises
        ------
        BondGraphError
            If the file cannot be written or has another suffix.
        """
        name = str(super().convert(value, param, ctx))
        if name == STDOUT:
            return name
        path = Path(name)
        if self.suffixes and path.suffix.lower() not in ("", *self.suffixes):
            allowed = " or ".join(self.suffixes)
            raise BondGraphError(
                f"{name!r} ends in {path.suffix}, and what is written is {allowed}.",
                (name,),
                f"Name it {path.with_suffix(self.suffixes[0]).name}, for example.",
            )
        trouble = _trouble(path)
        if trouble is not None:
            raise unwritable(name, os.strerror(trouble))
        return name


def refuse_overwriting(context: click.Context) -> None:
    """Refuse to write what is read, or two answers into one file.

    Raises
    ------
    BondGraphError
        Naming the file and the options.
    """
    taken: dict[Path, str] = {}
    for option, path in _files(context, written=False):
        # A model is named as file.py:factory.
        for name in {path, path.rpartition(":")[0] or path}:
            taken.setdefault(Path(name).resolve(), f"is read as {option}")
    for option, path in _files(context, written=True):
        if path == STDOUT:
            continue
        where = Path(path).resolve()
        if where in taken:
            raise BondGraphError(
                f"{path!r} {taken[where]}, and {option} would write over it.",
                (path,),
                f"Name another file for {option}.",
            )
        taken[where] = f"is written by {option}"


def _trouble(path: Path) -> int | None:
    """Return why a file cannot be written, as an error number; None where it can."""
    if path.is_dir():
        return errno.EISDIR
    if path.exists():
        return None if os.access(path, os.W_OK) else errno.EACCES
    if not path.parent.exists():
        return errno.ENOENT
    if not path.parent.is_dir():
        return errno.ENOTDIR
    return None if os.access(path.parent, os.W_OK | os.X_OK) else errno.EACCES


def _files(context: click.Context, *, written: bool) -> Iterator[tuple[str, str]]:
    """Yield what each file is for and its path, of those written or of those read."""
    for param in context.command.params:
        kind = param.type
        if isinstance(kind, click.Path) and isinstance(kind, OutputFile) == written:
            value = context.params.get(param.name or "")
            for path in value if isinstance(value, tuple) else (value,):
                if path is not None:
                    yield _called(param), str(path)


def _called(param: click.Parameter) -> str:
    if isinstance(param, click.Option):
        return param.opts[-1]
    return param.human_readable_name.removesuffix("...")
