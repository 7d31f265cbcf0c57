"""What holds for all tests: beside other workers, each of them takes one thread."""

import os

if "PYTEST_XDIST_WORKER" in os.environ:
    for threads in ("BONDGRAPH_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(threads, "1")
