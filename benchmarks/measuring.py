"""What every benchmark needs: a fair stop watch, a table, and the machine in words."""

import platform
import time
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")
PACKAGES = ("numpy", "numba", "scipy", "sympy")


def stopwatch(work: Callable[[], T], *, times: int = 3) -> tuple[float, T]:
    """Return the shortest of several runs in seconds, and what the last one gave.

    The shortest is the one that other programs on the machine disturbed least.
    """
    best, result = float("inf"), None
    for _ in range(times):
        begin = time.perf_counter()
        result = work()
        best = min(best, time.perf_counter() - begin)
    assert result is not None
    return best, result


def print_table(
    title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]
) -> None:
    """Print a table that can be pasted into Markdown."""
    widths = [max(map(len, column)) for column in zip(columns, *rows, strict=True)]
    print(f"\n{title}\n")
    for row in (columns, ["-" * width for width in widths], *rows):
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        print(f"| {' | '.join(cells)} |")


def seconds(value: float) -> str:
    """Return a duration in words of a fitting size."""
    return f"{1e3 * value:.3g} ms" if value < 1.0 else f"{value:.3g} s"


def print_machine() -> None:
    """Print the date, the processor and the versions that matter."""
    today = datetime.now(tz=UTC).date().isoformat()
    packages = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    print(f"{today}; {_processor()}; Python {platform.python_version()}; {packages}")


def _processor() -> str:
    file = Path("/proc/cpuinfo")
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if "model name" in line]
    return f"{len(names)} x {names[0]}" if names else platform.machine()
