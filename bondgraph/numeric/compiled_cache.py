"""Compiled loops on disk belong to the sources they were compiled from, all of them.

numba keeps a compiled function as long as its own file stays, although what it calls
may have changed in another file; such a leftover would crash. So all of them go when
any file that compiled loops are made of has changed.
"""

import hashlib
from pathlib import Path

STAMP = "compiled_from.txt"
MARKS = (b"numba", b"numeric.machine", b"NamedTuple")
"""A source with one of these words takes part in compiled loops."""


def discard_stale(folder: Path) -> bool:
    """Forget the compiled loops of `folder` if its sources are not those they were.

    Returns whether they were forgotten. Where nothing can be written, as in an
    installation for all users, nothing is kept here either.
    """
    cache = folder / "__pycache__"
    stamp = cache / STAMP
    now = _digest(folder)
    try:
        if stamp.is_file() and stamp.read_text("ascii") == now:
            return False
        cache.mkdir(exist_ok=True)
        for index in cache.glob("*.nbi"):
            index.unlink(missing_ok=True)
        stamp.write_text(now, "ascii")
    except OSError:
        return False
    return True


def _digest(folder: Path) -> str:
    whole = hashlib.sha256()
    for source in sorted(folder.glob("*.py")):
        text = source.read_bytes()
        if any(mark in text for mark in MARKS):
            whole.update(source.name.encode() + b"\0" + text + b"\0")
    return whole.hexdigest()
