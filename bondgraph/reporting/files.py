"""Writing a result to a file, refused in one sentence where it cannot be."""

from pathlib import Path

from bondgraph.errors import BondGraphError


def write_text(path: Path | str, text: str) -> None:
    """Write `text` to the file at `path` in UTF-8, replacing what was there.

    Raises
    ------
    BondGraphError
        If the file cannot be written.
    """
    try:
        Path(path).write_text(text, encoding="utf-8")
    except OSError as error:
        raise unwritable(path, error.strerror) from error


def unwritable(path: Path | str, why: str | None) -> BondGraphError:
    """Return the refusal of a file that cannot be written."""
    return BondGraphError(
        f"{str(path)!r} cannot be written ({why}).",
        (str(path),),
        "Name a file in a directory that exists and may be written to.",
    )
