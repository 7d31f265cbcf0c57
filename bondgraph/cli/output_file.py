"""Files that a command is to write, refused while the command line is read.

A search may take minutes; that its page has nowhere to go is known before.
"""

import errno
import os
from pathlib import Path
from typing import Any

import click

from bondgraph.errors import BondGraphError


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
        if name == "-":
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
            raise BondGraphError(
                f"{name!r} cannot be written ({os.strerror(trouble)}).",
                (name,),
                "Name a file in a directory that exists and may be written to.",
            )
        return name


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
