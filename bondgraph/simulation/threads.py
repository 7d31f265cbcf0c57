"""Windows on several threads: compiled loops leave the interpreter to the others.

Where several processes share the cores, each has one thread: ``BONDGRAPH_THREADS`` says
how many, two by default.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

THREADS = "BONDGRAPH_THREADS"


def in_parallel(work: Callable[[int, int], None], count: int) -> None:
    """Do ``work(first, last)`` for contiguous parts of `count` pieces."""
    threads = min(int(os.environ.get(THREADS) or 2), count)
    if threads < 2:
        work(0, count)
        return
    edges = np.linspace(0, count, threads + 1).astype(int).tolist()
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, edges[:-1], edges[1:]))
