"""What ten million rows cost: read from CSV and Parquet, summed up, bound to a model.

    .venv/bin/python -m benchmarks.long_recording                # 10^7 rows
    .venv/bin/python -m benchmarks.long_recording --rows 1000000

Each format is read in a process of its own; its peak memory is told beside its time.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.measuring import print_table

FORMATS = ("csv", "parquet")


def written(folder: Path, rows: int) -> dict[str, Path]:
    """Write the same recording in each format; return where."""
    import pyarrow as pa  # noqa: PLC0415
    from pyarrow import csv, parquet  # noqa: PLC0415

    random = np.random.default_rng(1)
    force = np.round(np.repeat(random.uniform(-5, 5, rows // 100 + 1), 100)[:rows], 4)
    velocity = np.round(0.01 * np.cumsum(force) + random.normal(size=rows), 4)
    columns = {
        "time [s]": np.arange(rows) / 1000.0,
        "force [N]": force,
        "velocity [m/s]": velocity,
    }
    table = pa.table(columns)
    paths = {name: folder / f"run.{name}" for name in FORMATS}
    csv.write_csv(table, paths["csv"])
    parquet.write_table(table, paths["parquet"])
    return paths


def read(path: Path) -> None:
    """Read a recording and print what it cost, and its summary."""
    from bondgraph import read_recording  # noqa: PLC0415

    began = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    clock, processor = time.perf_counter(), time.process_time()
    recording = read_recording(path)
    summary = recording._repr_html_()  # least, mean, greatest and std of each channel
    wall, used = time.perf_counter() - clock, time.process_time() - processor
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    size = path.stat().st_size / 1e6
    print(
        f"{size:.0f} MB|{wall:.1f} s|{used:.1f} s|{began / 1e3:.0f} MB|"
        f"{peak / 1e3:.0f} MB|{len(recording)} rows, {summary.count('<tr>')} lines"
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=10_000_000)
    parser.add_argument("--read", type=Path, help="read this file and say the cost")
    chosen = parser.parse_args()
    if chosen.read:
        read(chosen.read)
        return
    with tempfile.TemporaryDirectory() as name:
        lines = []
        for kind, path in written(Path(name), chosen.rows).items():
            command = [sys.executable, "-m", __spec__.name, "--read", str(path)]
            told = subprocess.run(command, capture_output=True, text=True, check=True)
            lines.append([kind, *told.stdout.strip().split("|")])
    head = ["format", "file", "time", "processor", "memory before", "peak", "read"]
    print_table(f"{chosen.rows} rows of three channels", head, lines)


if __name__ == "__main__":
    main()
