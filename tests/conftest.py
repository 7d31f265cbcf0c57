"""What holds for all tests: one thread beside other workers, and a memory for algebra.

Tests derive the same machines again and again: sympy remembers a thousand results of
each of its functions by itself, and a fifth of the time goes into finding them anew.
"""

import os

os.environ.setdefault("SYMPY_CACHE_SIZE", "30000")  # Read as sympy is imported.

if "PYTEST_XDIST_WORKER" in os.environ:
    for threads in ("BONDGRAPH_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(threads, "1")
