"""A journal: what has been worked out so far, kept in a file, to go on from there.

One line of JSON per result, written as soon as it is known. The key of a result says
all that it depends on (`fingerprint`), and every line says which sources wrote it, so
that a journal of another model, other recordings, other choices or another version is
not mistaken for one's own: its lines are not found. Numbers are written so that they
are read back to the last bit. Nothing in the file is ever executed.
"""

import hashlib
import json
import os
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cache, lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import sympy

from bondgraph.errors import BondGraphError

Plain = dict[str, Any]
FILE = "journal.jsonl"
COMPUTED_WITH = ("numpy", "scipy", "sympy", "numba")
"""Packages of which another version may change the last bits of a result."""


@dataclass(slots=True)
class Journal:
    """Results by key, in memory and, where it has a directory, in a file there.

    Raises
    ------
    BondGraphError
        If the directory cannot be made, read or written to.
    """

    directory: Path | None = None
    _known: dict[str, Plain] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        if self.directory is None:
            return
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            content = self._path.read_bytes() if self._path.exists() else b""
            # A line that was cut off is ended; and what cannot be written shows now.
            self._append(b"" if not content or content.endswith(b"\n") else b"\n")
        except OSError as error:
            raise self._refused(error) from error
        for line in content.splitlines():
            self._remember(line)

    @property
    def _path(self) -> Path:
        assert self.directory is not None
        return self.directory / FILE

    def _remember(self, line: bytes) -> None:
        """Take over a line; one that is damaged or not ours is worked out anew."""
        try:
            entry = json.loads(line)
        except (ValueError, RecursionError):
            return
        match entry:
            case {"key": str(key), "by": by, "result": dict(result)} if by == sources():
                self._known[key] = result

    def get(self, key: str) -> Plain | None:
        """Return the result called `key`, or None where there is none yet."""
        return self._known.get(key)

    def put(self, key: str, result: Plain) -> Plain:
        """Keep a result, and return it as it will be read when the work goes on."""
        line = _line(key, result)
        kept: Plain = json.loads(line)["result"]
        self._known[key] = kept
        if self.directory is not None:
            try:
                self._append(line)
            except FileNotFoundError:
                self._begun_anew()
            except OSError as error:
                raise self._refused(error) from error
        return kept

    def _begun_anew(self) -> None:
        """Write all that is known, where somebody has emptied the cache meanwhile."""
        assert self.directory is not None
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            self._append(
                b"".join(_line(k, result) for k, result in self._known.items())
            )
        except OSError as error:
            raise self._refused(error) from error

    def _append(self, line: bytes) -> None:
        """Add a line in one write, so that lines of two processes do not mix."""
        to_end = os.O_WRONLY | os.O_APPEND | os.O_CREAT
        file = os.open(self._path, to_end, 0o666)
        try:
            while line:
                line = line[os.write(file, line) :]
        finally:
            os.close(file)

    def _refused(self, error: OSError) -> BondGraphError:
        name = str(self.directory)
        return BondGraphError(
            f"The journal in {name!r} cannot be used ({error.strerror}).",
            (name,),
            "Name a directory that may be written to.",
        )


def _line(key: str, result: Plain) -> bytes:
    """Return a result as a line of the file."""
    entry = {"key": key, "by": sources(), "result": result}
    return json.dumps(entry).encode() + b"\n"


@cache
def sources() -> str:
    """Return a short text that changes with any source file that makes results."""
    package = Path(__file__).parents[2]
    files = sorted(package.rglob("*.py"))
    parts = [(str(file.relative_to(package)), file.read_bytes()) for file in files]
    return fingerprint([f"{name} {version(name)}" for name in COMPUTED_WITH], *parts)


def fingerprint(*parts: object) -> str:
    """Return a short text that changes with any of `parts`: arrays by their bytes."""
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            digest.update(np.ascontiguousarray(part).tobytes())
        else:
            digest.update(_text(part).encode())
        digest.update(b"|")
    return digest.hexdigest()[:24]


def _text(part: object) -> str:
    """Return nearly what `repr` does, with every law written once."""
    if isinstance(part, sympy.Basic):
        return _law(part)
    if isinstance(part, tuple | list):
        return f"({', '.join(map(_text, part))})"
    if is_dataclass(part) and not isinstance(part, type):
        shown = [one.name for one in fields(part) if one.repr]
        members = (f"{name}={_text(getattr(part, name))}" for name in shown)
        return f"{type(part).__qualname__}({', '.join(members)})"
    return repr(part)


@lru_cache(maxsize=1024)
def _law(law: sympy.Basic) -> str:
    """Return the text of a law: that of a curve takes a tenth of a second to write."""
    return repr(law)
