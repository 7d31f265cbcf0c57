"""Windows on several threads: compiled loops leave the interpreter to the others.

Where several processes share the cores, each has one thread: ``BONDGRAPH_THREADS`` says
how many, two by default. The threads are kept: starting one takes as long as a short
simulation.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise

import numpy as np

THREADS = "BONDGRAPH_THREADS"


def in_parallel(work: Callable[[int, int], None], count: int) -> None:
    """Do ``work(first, last)`` for contiguous parts of `count` pieces."""
    threads = min(int(os.environ.get(THREADS) or 2), count)
    if threads < 2:
        work(0, count)
        return
    edges = np.linspace(0, count, threads + 1).astype(int).tolist()
    own, *others = pairwise(edges)
    pool = _helpers(threads - 1)
    begun = [(part, pool.submit(work, *part)) for part in others]
    try:
        work(*own)
        for part, helper in begun:
            # What no helper has begun, busy for somebody else, is done here.
            if helper.cancel():
                work(*part)
            else:
                helper.result()
    finally:
        # Whatever is interrupted: what a loop still reads must not be let go of.
        for _, helper in begun:
            if not helper.cancel():
                helper.exception()


@cache
def _helpers(count: int) -> ThreadPoolExecutor:
    """Return the threads beside the one that asks."""
    return ThreadPoolExecutor(count, "bondgraph")


# A forked process has none of its parent's threads.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_helpers.cache_clear)
