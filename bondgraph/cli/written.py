"""Files that a command writes, which are never those that it reads.

A recording is measured once, and a model is somebody's work: a slip in the name of an
output must not cost either.
"""

from collections.abc import Iterator
from pathlib import Path

import click

from bondgraph.errors import BondGraphError

STDOUT = "-"


class Written(click.Path):
    """A file that is written; ``-`` is stdout where the command allows it."""


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


def _files(context: click.Context, *, written: bool) -> Iterator[tuple[str, str]]:
    """Yield what each file is for and its path, of those written or of those read."""
    for param in context.command.params:
        kind = param.type
        if isinstance(kind, click.Path) and isinstance(kind, Written) == written:
            value = context.params.get(param.name or "")
            for path in value if isinstance(value, tuple) else (value,):
                if path is not None:
                    yield _called(param), str(path)


def _called(param: click.Parameter) -> str:
    if isinstance(param, click.Option):
        return param.opts[-1]
    return param.human_readable_name.removesuffix("...")
