"""What it costs to lay out and draw a graph, and how that grows with its size.

    .venv/bin/python -m benchmarks.drawing

In processor seconds, the least of three drawings: chains and ladders as in `ladders`,
and trees with ports at random.
"""

import random
import time
from functools import partial

from benchmarks.ladders import family
from benchmarks.measuring import print_machine, print_table, seconds, stopwatch
from bondgraph import TF, BondGraph, FinishedGraph, Se
from bondgraph.reporting.drawing import draw_svg
from bondgraph.structure.elements import Compliance, Inertance, Resistance

STAGES = (30, 100, 300, 1000)
STORES_AND_LOSSES = (Inertance, Compliance, Resistance)


def tree(size: int) -> FinishedGraph:
    """Return a tree of 0- and 1-junctions, every fourth joint through a transformer."""
    dice = random.Random(3)
    graph = BondGraph(f"tree of {size}")
    for k in range(size):
        kinds = dice.choices(STORES_AND_LOSSES, k=dice.randint(0, 3))
        ports = [kind(f"x{k}_{n}") for n, kind in enumerate(kinds)]
        (graph.one if k % 2 else graph.zero)(f"n{k}", *ports)
        if k:
            parent = f"n{dice.randint(max(0, k - 6), k - 1)}"
            between = (TF(f"k{k}"),) if dice.random() < 0.25 else ()
            graph.join(parent, *between, f"n{k}")
    graph.put(Se("u"), on="n0")
    return graph.finish()


def main() -> None:
    """Measure and print."""
    print_machine()
    rows = []
    for name in ("msd", "lc", "tree"):
        for stages in STAGES:
            graph = tree(stages) if name == "tree" else family(name, stages).finish()
            work = partial(draw_svg, graph)
            spent, _ = stopwatch(work, clock=time.process_time)
            bonds = len(graph.bonds)
            rows.append([name, str(bonds), seconds(spent), seconds(spent / bonds)])
    print_table("Drawing", ["family", "bonds", "processor", "per bond"], rows)


if __name__ == "__main__":
    main()
