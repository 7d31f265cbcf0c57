"""What TOML files may hold that no program expects, read and shown without surprise.

TOML allows integers that no float holds, numbers of thousands of digits, which Python
refuses to read or print, and brackets nested deeper than any stack.
"""

import math
import tomllib
from pathlib import Path
from typing import Any

LONGEST_SHOWN = 60
"""Characters of a value that a sentence quotes."""


class NotTomlError(ValueError):
    """The text is no TOML; its words say where and why."""


def toml(path: Path) -> dict[str, Any]:
    """Return what the TOML file at `path` holds.

    Raises
    ------
    OSError
        If the file cannot be read.
    NotTomlError
        If it is not UTF-8 text, not TOML, or more deeply nested than can be read.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError as error:
        raise NotTomlError("it is not UTF-8 text") from error
    except ValueError as error:
        raise NotTomlError(_short(str(error))) from error
    except RecursionError:
        raise NotTomlError("its brackets are nested too deeply") from None


def finite(value: object) -> float | None:
    """Return a number as a float, None for anything that is not a finite one."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def shown(value: object) -> str:
    """Return a value as a sentence may quote it: short, and never an error."""
    try:
        return _short(repr(value))
    except (ValueError, RecursionError):  # an integer of thousands of digits
        return f"an {type(value).__name__} too large to be shown"


def _short(text: str) -> str:
    whole = " ".join(text.split())
    return whole if len(whole) <= LONGEST_SHOWN else f"{whole[:LONGEST_SHOWN]}…"
