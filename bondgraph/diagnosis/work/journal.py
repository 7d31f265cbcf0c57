"""A journal: what has been worked out so far, kept in a file, to go on from there.

One line of JSON per result, written as soon as it is known. The key of a result says
all that it depends on (`fingerprint`), so that a journal of another model, other
recordings or other choices is not mistaken for one's own: its lines are not found.
Numbers are written so that they are read back to the last bit.
"""

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bondgraph.errors import BondGraphError

Plain = dict[str, Any]
FILE = "journal.jsonl"


@dataclass(slots=True)
class Journal:
    """Results by key, in memory and, where it has a directory, in a file there."""

    directory: Path | None = None
    _known: dict[str, Plain] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        if self.directory is None:
            return
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            text = self._path.read_text("utf-8") if self._path.exists() else ""
        except OSError as error:
            raise BondGraphError(
                f"The journal in {str(self.directory)!r} cannot be used "
                f"({error.strerror}).",
                (str(self.directory),),
                "Name a directory that may be written to.",
            ) from error
        for line in text.splitlines():
            self._remember(line)
        if text and not text.endswith("\n"):
            self._append("\n")

    @property
    def _path(self) -> Path:
        assert self.directory is not None
        return self.directory / FILE

    def _remember(self, line: str) -> None:
        try:
            entry = json.loads(line)
        except json.JSONDecodeError:
            return  # Cut off in the middle of a line: that result is worked out anew.
        self._known[entry["key"]] = entry["result"]

    def get(self, key: str) -> Plain | None:
        """Return the result called `key`, or None where there is none yet."""
        return self._known.get(key)

    def put(self, key: str, result: Plain) -> None:
        """Keep a result."""
        self._known[key] = result
        if self.directory is not None:
            self._append(json.dumps({"key": key, "result": result}) + "\n")

    def _append(self, text: str) -> None:
        with self._path.open("a", encoding="utf-8") as file:
            file.write(text)


def fingerprint(*parts: object) -> str:
    """Return a short text that changes with any of `parts`: arrays by their bytes."""
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            digest.update(np.ascontiguousarray(part).tobytes())
        else:
            digest.update(repr(part).encode())
        digest.update(b"|")
    return digest.hexdigest()[:24]
