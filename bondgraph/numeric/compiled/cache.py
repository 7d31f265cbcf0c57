"""Where compiled loops lie on disk: each state of their sources has its own folder.

numba keeps a compiled function as long as its own file stays, although what it calls
may have changed in another file; such a leftover would corrupt memory. So the folder
is named by a digest of all sources that compiled loops are made of. Nothing in use is
ever deleted: processes may start at once, on the same or on different sources.
"""

import hashlib
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock
from typing import Any

import numba
from numba.misc.appdirs import AppDirs

SOURCES = ("compiled", "kernel", "native")
"""The packages that compiled loops are made of."""
UNUSED = 3600.0  # seconds since a process last started with a folder
_LOCK = Lock()
_SETTINGS: Any = numba.config


def cache_folder(package: Path) -> Path | None:
    """Return the folder for the loops made of the sources in `package`, as they are.

    It lies beside the sources, where numba's setting ``NUMBA_CACHE_DIR`` says, or, as
    in an installation for all users, among the user's own caches. None where no folder
    can be written.
    """
    name = f"loops-{digest(package)}"
    if _SETTINGS.CACHE_DIR:
        choices = [Path(_SETTINGS.CACHE_DIR) / "bondgraph"]
    else:
        choices = [package / "__pycache__", _of_user() / "bondgraph"]
    for choice in choices:
        if _writable(choice / name):
            _forget_unused(choice, name)
            return choice / name
    return None


def digest(package: Path) -> str:
    """Return a name for the sources of compiled loops, as they are."""
    whole = hashlib.sha256()
    for source in sorted(p for s in SOURCES for p in (package / s).rglob("*.py")):
        text = source.read_bytes()
        name = source.relative_to(package).as_posix()
        whole.update(f"{name}\0{len(text)}\0".encode() + text)
    return whole.hexdigest()[:16]


@contextmanager
def kept_in(folder: Path) -> Iterator[None]:
    """Let what is decorated meanwhile be kept in `folder`; numba asks only then."""
    with _LOCK:
        before = _SETTINGS.CACHE_DIR
        _SETTINGS.CACHE_DIR = str(folder)
        try:
            yield
        finally:
            _SETTINGS.CACHE_DIR = before


def _of_user() -> Path:
    """Return where numba keeps the user's caches."""
    places: Any = AppDirs  # it has no types
    return Path(places(appname="numba", appauthor=False).user_cache_dir)


def _writable(folder: Path) -> bool:
    """Make a folder and mark it as used; return whether that is possible."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
        os.utime(folder)
    except OSError:
        return False
    return True


def _forget_unused(parent: Path, name: str) -> None:
    """Delete what sources of the past left behind; numba makes anew what it misses."""
    for old in parent.glob("loops-*"):
        with suppress(OSError):  # another process was first
            if old.name != name and time.time() - old.stat().st_mtime > UNUSED:
                shutil.rmtree(old, ignore_errors=True)
