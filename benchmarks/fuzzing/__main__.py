"""The command: ``python -m benchmarks.fuzzing graphs 10000`` or ``… files 2000``.

``--first N`` begins with another seed, ``--out FILE`` keeps a JSON line per trial, and
``report FILE…`` puts such files together. Ends with 1 if anything crashed, hung, was
wrong, or was refused in another way than promised.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from benchmarks.fuzzing.tampering import FileEnd, damaged_file
from benchmarks.fuzzing.verdicts import FAILURES, End, graph_line
from benchmarks.fuzzing.watching import Line, watched, work
from benchmarks.measuring import print_table

TRIALS = {"graphs": graph_line, "files": damaged_file}
SIZES = (10, 30, 100, 1000)
MEANING: dict[str, str] = {end.name: end.value for end in (*End, *FileEnd)}
FAILED = {end.name for end in FAILURES} | {FileEnd.BROKEN.name}


def main() -> int:
    """Run a sweep, or read one, and say how its trials ended."""
    words = argparse.ArgumentParser(prog="python -m benchmarks.fuzzing")
    words.add_argument("mode", choices=[*TRIALS, "worker", "report"])
    words.add_argument("rest", nargs="+", help="how many trials, or files to report")
    words.add_argument("--first", type=int, default=0)
    words.add_argument("--out", type=Path, help="one JSON line per trial")
    asked = words.parse_args()
    if asked.mode == "worker":
        kind, first, count = asked.rest
        work(TRIALS[kind], int(first), int(count))
        return 0
    if asked.mode == "report":
        return report(_read(asked.rest))
    found = watched(asked.mode, asked.first, int(asked.rest[0]))
    return report(found if asked.out is None else _kept(found, asked.out))


def _read(names: Sequence[str]) -> Iterator[Line]:
    for name in names:
        with Path(name).open(encoding="utf-8") as file:
            yield from map(json.loads, file)


def _kept(lines: Iterable[Line], path: Path) -> Iterator[Line]:
    with path.open("a", encoding="utf-8") as file:
        for line in lines:
            print(json.dumps(line), file=file, flush=True)
            yield line


def report(lines: Iterable[Line]) -> int:
    """Print how many trials ended how, and what failed; return the status."""
    counts: Counter[tuple[str, str]] = Counter()
    failed, most = [], {"seconds": (0.0, -1), "memory": (0.0, -1)}
    for line in lines:
        counts[line["end"], _column(line)] += 1
        for what, so_far in most.items():
            most[what] = max(so_far, (float(line.get(what, 0.0)), line["seed"]))
        if line["end"] in FAILED:
            failed.append(line)
    columns = sorted({column for _, column in counts})
    rows = []
    for end, meaning in MEANING.items():
        row = [counts[end, column] for column in columns]
        if sum(row):
            rows.append((meaning, *map(str, (*row, sum(row)))))
    heads = (f"{counts.total()} trials", *(c[2:] for c in columns), "all")
    print_table("", heads, rows)
    (seconds, slow), (memory, large) = most.values()
    print(f"\nThe slowest took {seconds:.2g} s (seed {slow}).")
    if memory:
        print(f"The largest took {memory / 2**20:.0f} MiB (seed {large}).")
    for line in failed:
        print(f"seed {line['seed']}: {MEANING[line['end']]}. {line.get('said')}")
    return 1 if failed else 0


def _column(line: Line) -> str:
    """Return the column of a trial: two characters to sort by, and its words."""
    if "kind" in line:
        kind = line["kind"].partition(":")[0]
        return f"  {kind}"
    size = sum(line.get("elements", 0) > edge for edge in SIZES)
    return f"{size} to {SIZES[size]}"


if __name__ == "__main__":
    sys.exit(main())
