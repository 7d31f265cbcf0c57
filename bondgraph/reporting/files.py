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
        raise BondGraphError(
            f"{str(path)!r} cannot be written ({error.strerror}).",
            (str(path),),
            "Name a file in a directory that exists and may be written to.",
        ) from error
