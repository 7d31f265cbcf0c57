"""``bondgraph new``: a folder to start from, in which every command works at once."""

import shlex
from pathlib import Path

import click

from bondgraph.cli.command import Command, OneOf, json_option
from bondgraph.cli.session import Session
from bondgraph.cli.starting.starts import STARTS, commands, files_of
from bondgraph.errors import BondGraphError


@click.command(
    "new",
    cls=Command,
    examples=(
        ("new mymotor", "A motor, its recordings, checks, and what to type"),
        ("new plant --like tanks", "The same for two tanks"),
    ),
)
@click.argument("name", type=click.Path())
@click.option(
    "--like",
    type=OneOf(list(STARTS)),
    default="motor",
    show_default=True,
    help="The machine to start from: " + "; ".join(
        f"{one.name}, {one.is_what}" for one in STARTS.values()
    ) + ".",
)  # fmt: skip
@json_option
@click.pass_obj
def command(
    session: Session, /, *, name: str, like: str, json_file: str | None
) -> None:
    """Make the folder NAME with a model, recordings, a mapping and checks.

    Everything in it can be run at once, and replaced piece by piece.
    """
    session.answers_in(json_file)
    folder, start = Path(name), STARTS[like]
    texts = files_of(start, folder.resolve().name)
    _make(folder)
    for file, text in texts.items():
        (folder / file).parent.mkdir(exist_ok=True)
        session.write(folder / file, text)
    session.say(f"{folder}: {start.is_what}.")
    session.hint("Type, for example:\n")
    session.hint(f"  cd {shlex.quote(str(folder))}")
    for line in commands(start):
        session.hint(f"  {line}")
    session.hint(f"\n{folder / 'README.md'} says what each file is.")
    session.deliver(
        json_file,
        {"schema": 1, "folder": str(folder), "like": like, "files": list(texts)},
    )


def _make(folder: Path) -> None:
    """Make the folder; an empty one is taken, anything else is left alone."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        taken = any(folder.iterdir())
    except OSError as error:
        raise BondGraphError(
            f"The folder {str(folder)!r} cannot be made ({error.strerror}).",
            (str(folder),),
            "Name another one.",
        ) from error
    if taken:
        raise BondGraphError(
            f"The folder {str(folder)!r} is not empty.",
            (str(folder),),
            "Name a new one: nothing of yours is written over.",
        )
