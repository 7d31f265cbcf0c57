"""The same chains in other tools, in the same run: equal matrices, and how much longer.

The other tools live in a virtual environment of their own, outside of this repository;
``--make`` creates it and installs them by name from the package index. A tool that is
not there is skipped, with the reason.

Usage: ``python -m benchmarks.peers --venv /tmp/peers [--make] [--stages 5 10 20 40]``
"""

import argparse
import json
import math
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.ladders import family
from benchmarks.measuring import print_machine, print_table, seconds
from bondgraph import derive
from bondgraph.numeric.implicit.matrices import implicit_state_space
from bondgraph.structure.elements import EffortSource

PEERS = ("BondGraphTools", "bondgraph")
FAMILIES = ("msd", "lc", "rlc")
RESULTS = Path(__file__).parent / "results"
WORKER = Path(__file__).with_name("peer_worker.py")
EQUAL = 1e-9
"""BondGraphTools turns measured numbers into rationals of about 13 digits."""


def make(venv: Path) -> None:
    """Create the environment and install what can be installed."""
    if not (venv / "bin" / "python").exists():
        subprocess.run([sys.executable, "-m", "venv", str(venv)], check=True)
    for name in PEERS:
        command = [str(venv / "bin" / "pip"), "install", "--quiet", name]
        ran = subprocess.run(command, capture_output=True, text=True, check=False)
        if ran.returncode:
            print(f"{name} did not install: {ran.stderr.strip().splitlines()[-1]}")


def topology(name: str, stages: int) -> dict[str, Any]:
    """Return a machine in no tool's words."""
    graph = family(name, stages).finish()
    values = graph.parameters.values_by_name()
    nodes = [(n.name, n.letter, values.get(n.name)) for n in graph.nodes]
    bonds = [(b.tail, b.head) for b in graph.bonds]
    assert sum(isinstance(n, EffortSource) for n in graph.nodes) == 1
    return {"nodes": nodes, "bonds": bonds}


def theirs(venv: Path, tool: str, name: str, stages: int, limit: float) -> Any:
    """Return what the worker says, or the reason why it says nothing."""
    task = {**topology(name, stages), "warm": topology(name, 2)}
    try:
        ran = subprocess.run(
            [str(venv / "bin" / "python"), str(WORKER), tool],
            input=json.dumps(task),
            capture_output=True,
            text=True,
            timeout=limit,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"over {limit:.0f} s on the clock"
    if ran.returncode:
        return ran.stderr.strip().splitlines()[-1]
    return json.loads(ran.stdout.splitlines()[-1])


def ours(name: str, stages: int) -> tuple[float, float, np.ndarray]:
    """Return processor seconds from script to numbers, to symbols, and A."""
    numbers = symbols = math.inf
    for _ in range(5):
        begin = time.process_time()
        A = implicit_state_space(family(name, stages).finish()).A
        numbers = min(numbers, time.process_time() - begin)
    for _ in range(2):
        begin = time.process_time()
        derive(family(name, stages).finish())
        symbols = min(symbols, time.process_time() - begin)
    return numbers, symbols, A.toarray()


def compared(
    venv: Path, families: list[str], stages: list[int], limit: float
) -> list[dict[str, Any]]:
    """Run every tool on every machine."""
    ours("msd", 2)
    records: list[dict[str, Any]] = []
    for name in families:
        for size in stages:
            numbers, symbols, A = ours(name, size)
            for tool in PEERS:
                record = {"family": name, "stages": size, "tool": tool}
                record |= {"numbers": numbers, "symbols": symbols}
                said = theirs(venv, tool, name, size, limit)
                if isinstance(said, str):
                    record["skipped"] = said
                else:
                    # BondGraphTools was given numbers, the other tool knows symbols.
                    mine = numbers if tool == "BondGraphTools" else symbols
                    apart = np.abs(np.array(said["A"]) - A).max() / np.abs(A).max()
                    record |= {"seconds": said["seconds"], "apart": float(apart)}
                    record |= {"equal": bool(apart < EQUAL)}
                    record |= {"ratio": said["seconds"] / mine}
                records.append(record)
                text = json.dumps(records, indent=1) + "\n"
                (RESULTS / "peers.json").write_text(text, "utf-8")
    return records


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--venv", type=Path, required=True)
    parser.add_argument("--make", action="store_true", help="create and fill it")
    parser.add_argument("--stages", type=int, nargs="*", default=[5, 10, 20, 40])
    parser.add_argument("--families", nargs="*", default=list(FAMILIES))
    parser.add_argument("--limit", type=float, default=300.0, metavar="SECONDS")
    chosen = parser.parse_args()
    here = Path(__file__).resolve().parent.parent
    if chosen.venv.resolve().is_relative_to(here):
        raise SystemExit("Put the other tools' environment outside of the repository.")
    if chosen.make:
        make(chosen.venv)
    if not (chosen.venv / "bin" / "python").exists():
        raise SystemExit(f"There is no environment in {chosen.venv}; add --make.")
    RESULTS.mkdir(exist_ok=True)
    records = compared(chosen.venv, chosen.families, chosen.stages, chosen.limit)
    print_machine()
    rows = [
        (
            *(r["family"], str(r["stages"]), r["tool"]),
            seconds(r["seconds"]) if "seconds" in r else f"skipped: {r['skipped']}",
            seconds(r["numbers"]),
            seconds(r["symbols"]),
            f"{r['ratio']:.0f}" if "ratio" in r else "",
            ("yes" if r["equal"] else "NO") if "equal" in r else "",
        )
        for r in records
    ]
    print_table(
        "Other tools, processor seconds",
        (
            *("machine", "stages", "tool", "its time", "ours, numbers"),
            *("ours, symbols", "times longer", "A equal"),
        ),
        rows,
    )
    if any(not r.get("equal", True) for r in records):
        raise SystemExit("Some matrices differ.")


if __name__ == "__main__":
    main()
