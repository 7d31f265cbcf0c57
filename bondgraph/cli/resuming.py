"""Where an interrupted diagnosis is kept, so that the same command goes on from there.

Unless ``--resume`` names a place, the journal of a diagnosis lies among the user's
caches and is deleted when all has been tried. Its folder is named by all that the
answer depends on: the words of the command, and what is in the model's and the
recordings' files. What another version of this program wrote is not read.
"""

import hashlib
import shutil
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import platformdirs

from bondgraph.cli.session import Session
from bondgraph.diagnosis.work.journal import FILE, sources
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

FORGOTTEN = 30 * 24 * 3600.0  # s after which nobody goes on


@dataclass(slots=True)
class Kept:
    """Where the journal of a diagnosis is; None where no directory can be made.

    It is of no use any more once all is `done`.
    """

    folder: Path | None
    done: bool = True


@contextmanager
def kept_for_later(
    session: Session,
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    resume: Path | None,
) -> Iterator[Kept]:
    """Yield where the journal is, and delete it afterwards unless there is more to do.

    Parameters
    ----------
    resume
        The directory that the user names; it is not deleted.
    """
    folder = resume or _own_folder(graph, recordings)
    if folder is None:
        yield Kept(None)
        return
    known = _known(folder)
    if known:
        session.note(f"Going on from {_results(known)} of an interrupted diagnosis.")
    session.resumes = partial(_sentence, folder)
    kept = Kept(folder)
    yield kept
    session.resumes = str
    if resume is None and kept.done:
        # Not the folder: the same command may be running a second time.
        (folder / FILE).unlink(missing_ok=True)


def _own_folder(
    graph: FinishedGraph, recordings: Sequence[BoundRecording]
) -> Path | None:
    home = Path(platformdirs.user_cache_dir("bondgraph", appauthor=False)) / "diagnoses"
    folder = home / _name(graph, recordings)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:  # No cache to write to: then an interruption costs the work.
        return None
    _forget(home)
    return folder


def _name(graph: FinishedGraph, recordings: Sequence[BoundRecording]) -> str:
    whole = hashlib.sha256(repr(graph).encode())
    for recording in recordings:
        whole.update(f"{recording.name} {recording.sha256}".encode())
    whole.update(repr(sys.argv[1:]).encode())
    return whole.hexdigest()[:24]


def _known(folder: Path) -> int:
    try:
        lines = (folder / FILE).read_bytes().splitlines()
    except OSError:
        return 0
    own = sources().encode()
    return sum(own in line for line in lines)


def _sentence(folder: Path) -> str:
    """Return how to go on, if anything was worked out."""
    known = _known(folder)
    return f"the same command goes on from {_results(known)}" if known else ""


def _results(count: int) -> str:
    return "1 result" if count == 1 else f"{count} results"


def _forget(home: Path) -> None:
    """Delete what nobody went on from for a month."""
    for folder in home.iterdir():
        with suppress(OSError):
            if time.time() - folder.stat().st_mtime > FORGOTTEN:
                shutil.rmtree(folder, ignore_errors=True)
