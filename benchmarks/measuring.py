"""What every benchmark needs: a fair stop watch, a table, and the machine in words."""

import json
import os
import platform
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")
PACKAGES = ("numpy", "numba", "scipy", "sympy")


def stopwatch(
    work: Callable[[], T],
    *,
    times: int = 3,
    clock: Callable[[], float] = time.perf_counter,
) -> tuple[float, T]:
    """Return the shortest of several runs in seconds, and what the last one gave.

    The shortest is the one that other programs on the machine disturbed least.
    """
    best, result = float("inf"), None
    for _ in range(times):
        begin = clock()
        result = work()
        best = min(best, clock() - begin)
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
    print(machine())


def machine() -> str:
    """Return the date, the processor, its load and the versions that matter."""
    today = datetime.now(tz=UTC).date().isoformat()
    packages = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    load = f"load {os.getloadavg()[0]:.1f}"
    python = f"Python {platform.python_version()}"
    return f"{today}; {_processor()}, {load}; {python}; {packages}"


def _processor() -> str:
    file = Path("/proc/cpuinfo")
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if "model name" in line]
    return f"{len(names)} x {names[0]}" if names else platform.machine()


def interleaved(
    works: Mapping[str, Callable[[], object]], *, rounds: int = 7
) -> dict[str, tuple[float, float]]:
    """Return the shortest and the median of several runs of each, in processor seconds.

    The works take turns, so that what else the machine does disturbs all alike.
    """
    for work in works.values():
        work()
    times: dict[str, list[float]] = {name: [] for name in works}
    for _ in range(rounds):
        for name, work in works.items():
            begin = time.process_time()
            work()
            times[name].append(time.process_time() - begin)
    return {name: (min(t), statistics.median(t)) for name, t in times.items()}


def write_results(name: str, record: object) -> None:
    """Write what was measured, with the machine, to ``results/<name>.json``."""
    file = Path(__file__).parent / "results" / f"{name}.json"
    whole = {"machine": machine(), "measured": record}
    file.write_text(json.dumps(whole, indent=1) + "\n", "utf-8")
