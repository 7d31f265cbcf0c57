"""How the cost of every step grows with the machine, from 10 to 100 000 stages.

Each machine is measured in a process of its own, so that its peak memory is its own.
Times are processor seconds, the least of some repetitions. Writes
``benchmarks/results/scaling.json`` and ``scaling.svg``.

Usage: ``python -m benchmarks.scaling [--huge]``
"""

import argparse
import json
import math
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from benchmarks.ladders import FAMILIES, family
from benchmarks.measuring import print_machine, print_table, seconds

T = TypeVar("T")
RESULTS = Path(__file__).parent / "results"
SIZES = (10, 100, 1000, 10_000)
HUGE = 100_000
MOST_DERIVED = 1000
"""Symbolic equations of larger machines take minutes."""
STEPS = {"msd": 1000, "lc": 1000, "rlc": 1000, "nonlinear": 100}
WORDS = {
    "script": "script",
    "finish": "checked graph",
    "causality": "causality",
    "derive": "symbolic equations",
    "matrices": "A, B, C, D (implicit)",
    "causal_matrices": "A, B, C, D (causal)",
    "matching_and_blt": "matching + BLT",
    "sparse_lu": "sparse LU",
    "simulate": "simulation",
}


def spent(work: Callable[[], T], times: int) -> tuple[float, T]:
    """Return the least processor seconds of several runs, and the last result."""
    best, result = math.inf, None
    for _ in range(times):
        begin = time.process_time()
        result = work()
        best = min(best, time.process_time() - begin)
    assert result is not None
    return best, result


def measured(name: str, stages: int) -> dict[str, Any]:
    """Return the seconds of every step for one machine, and the peak memory."""
    from scipy.sparse import csc_array, csr_array  # noqa: PLC0415
    from scipy.sparse.linalg import splu  # noqa: PLC0415

    from bondgraph import assign_causality, derive  # noqa: PLC0415
    from bondgraph.numeric.implicit.blocks import components, matched  # noqa: PLC0415
    from bondgraph.numeric.implicit.matrices import (  # noqa: PLC0415
        implicit_state_space,
    )
    from bondgraph.numeric.implicit.system import implicit_system  # noqa: PLC0415
    from bondgraph.numeric.state_space import sparse_state_space  # noqa: PLC0415
    from bondgraph.simulation.sparse import simulate_sparse  # noqa: PLC0415

    small = family(name, 3).finish()  # first calls
    implicit_state_space(small)
    simulate_sparse(small, [0.0, 1.0])
    derive(small)
    base = peak()
    times = 5 if stages <= 1000 else 1
    found: dict[str, Any] = {"family": name, "stages": stages}
    found["script"], written = spent(lambda: family(name, stages), times)
    found["finish"], graph = spent(written.finish, times)
    found["bonds"] = len(graph.bonds)
    found["matrices"], system = spent(lambda: implicit_state_space(graph), times)
    found["states"], found["entries"] = system.A.shape[0], int(system.A.nnz)
    found["script_to_matrices_mb"], found["before_mb"] = peak(), base
    found["causality"], _ = spent(lambda: assign_causality(graph), times)
    if stages <= MOST_DERIVED:
        found["derive"], _ = spent(lambda: derive(graph), 1)
        found["causal_matrices"], other = spent(lambda: sparse_state_space(graph), 1)
        if not np.allclose(other.A.toarray(), system.A.toarray(), atol=1e-9):
            raise SystemExit(f"The routes disagree on {name} of {stages}.")
    full = implicit_system(graph, merged=False)
    z = np.zeros(full.constant.shape[1])
    G = csr_array(full.jacobian(z)[:, : full.n_powers])
    found["unknowns"] = full.constant.shape[1]

    def structure() -> int:
        column = matched(G)
        row = np.empty(len(column), np.int64)
        row[column] = np.arange(len(column))
        return components(csr_array(G[row]))[0]

    found["matching_and_blt"], _ = spent(structure, times)
    turned = csc_array(G)
    found["sparse_lu"], _ = spent(lambda: splu(turned), times)
    if stages < HUGE:
        grid = np.linspace(0.0, 0.01 * STEPS[name], STEPS[name] + 1)
        wave = np.sin(grid)
        found["simulate"], run = spent(
            lambda: simulate_sparse(graph, grid, inputs={"pull": wave}), 1
        )
        found["steps"], found["energy_audit"] = STEPS[name], run.audit.relative
    found["peak_mb"] = peak()
    return found


def peak() -> float:
    """Return the largest resident memory so far in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def in_a_process(name: str, stages: int) -> dict[str, Any]:
    """Return `measured` of a fresh interpreter."""
    command = [sys.executable, "-m", "benchmarks.scaling", "--one", name, str(stages)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if ran.returncode:
        raise SystemExit(ran.stderr)
    answer: dict[str, Any] = json.loads(ran.stdout.splitlines()[-1])
    return answer


def slope(records: list[dict[str, Any]], key: str, low: int, high: int) -> str:
    """Return how many times more `high` stages cost than `low`."""
    by_size = {r["stages"]: r[key] for r in records if key in r}
    if low not in by_size or high not in by_size:
        return ""
    return f"{by_size[high] / max(by_size[low], 1e-9):.1f}"


def plot(records: list[dict[str, Any]], file: Path) -> None:
    """Draw seconds over stages, one panel per family."""
    import matplotlib as mpl  # noqa: PLC0415

    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "bondgraph"  # equal data give an equal file
    from matplotlib import pyplot as plt  # noqa: PLC0415

    figure, panels = plt.subplots(1, len(FAMILIES), figsize=(15, 4.6), sharey=True)
    for name, panel in zip(FAMILIES, panels, strict=True):
        own = [r for r in records if r["family"] == name]
        for key, label in WORDS.items():
            points = [(r["stages"], r[key]) for r in own if r.get(key)]
            if points:
                panel.loglog(*zip(*points, strict=True), "o-", ms=3, label=label)
        sizes = np.array([r["stages"] for r in own])
        panel.loglog(sizes, 2e-5 * sizes, "k:", lw=1, label="20 µs a stage")
        panel.set_title(name)
        panel.set_xlabel("stages")
        panel.grid(visible=True, alpha=0.3)
    panels[0].set_ylabel("processor seconds")
    panels[-1].legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})


def report(records: list[dict[str, Any]]) -> None:
    print_machine()
    for name in FAMILIES:
        own = [r for r in records if r["family"] == name]
        rows = [
            (
                str(r["stages"]),
                str(r["bonds"]),
                *(seconds(r[key]) if key in r else "" for key in WORDS),
                f"{r['script_to_matrices_mb']:.0f} MB",
                f"{r['peak_mb']:.0f} MB",
            )
            for r in own
        ]
        growth = ["1000 to 10 000", "times"]
        growth += [slope(own, key, 1000, 10_000) for key in WORDS]
        rows.append((*growth, "", ""))
        print_table(
            f"{name} ({STEPS[name]} steps simulated)",
            ("stages", "bonds", *WORDS.values(), "memory to matrices", "memory"),
            rows,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--one", nargs=2, metavar=("FAMILY", "STAGES"))
    parser.add_argument("--huge", action="store_true", help="a chain of 100 000 too")
    parser.add_argument("--families", nargs="*", default=list(FAMILIES))
    chosen = parser.parse_args()
    if chosen.one:
        print(json.dumps(measured(chosen.one[0], int(chosen.one[1]))))
        return
    work = [(name, stages) for name in chosen.families for stages in SIZES]
    if chosen.huge:
        work.append(("msd", HUGE))
    records = [in_a_process(name, stages) for name, stages in work]
    records.sort(key=lambda r: (r["family"], r["stages"]))
    RESULTS.mkdir(exist_ok=True)
    text = json.dumps(records, indent=1) + "\n"
    (RESULTS / "scaling.json").write_text(text, "utf-8")
    plot(records, RESULTS / "scaling.svg")
    report(records)


if __name__ == "__main__":
    main()
