"""A file on disk: that it is there, that it holds something, and what identifies it."""

from hashlib import file_digest
from pathlib import Path

from bondgraph.errors import RecordingError, did_you_mean


def check_file(path: Path, suffixes: tuple[str, ...]) -> None:
    """Refuse a file that is missing, empty or may not be read, naming what is beside.

    Raises
    ------
    RecordingError
        With the path and the way out.
    """
    source = str(path)
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except FileNotFoundError as error:
        beside: list[str] = []
        if path.parent.is_dir():
            entries = (p.name for p in path.parent.iterdir())
            beside = [n for n in entries if n.lower().endswith(suffixes)][:20]
        raise RecordingError(
            f"There is no file {source!r}.",
            (source,),
            did_you_mean(path.name, beside) if beside else "Check the path.",
        ) from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise RecordingError(
            f"{source!r} cannot be opened ({reason}).",
            (source,),
            "Give a file that may be read.",
        ) from error
    if empty:
        raise RecordingError(
            f"{source!r} is empty.",
            (source,),
            "Check that the recording was saved completely.",
        )


def digest(path: Path) -> str:
    """Return the SHA-256 of a file's content, read in pieces."""
    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()


MOST_UNPACKED = 1 << 30
"""Bytes of numbers that any file may unpack to."""

MOST_TIMES = 100
"""A file that unpacks to more than that may be so many times smaller on disk: numbers
that a sensor has read, with its noise, do not pack so well."""


def check_unpacked(path: Path, numbers: int) -> None:
    """Refuse a small file that unpacks to more numbers than any recording of its size.

    Parameters
    ----------
    numbers
        Those that are about to be read, of 8 bytes each.

    Raises
    ------
    RecordingError
        Before anything is unpacked.
    """
    unpacked, packed = 8 * numbers, max(path.stat().st_size, 1)
    if unpacked > MOST_UNPACKED and unpacked > MOST_TIMES * packed:
        raise RecordingError(
            f"{str(path)!r} holds {packed / 1e6:.3g} MB and would unpack to "
            f"{unpacked / 1e9:.3g} GB of numbers.",
            (str(path),),
            "It may be damaged; save it again, or read fewer rows or channels.",
        )
