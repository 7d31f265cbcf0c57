"""What holds for all tests: beside other workers, simulations take one thread each."""

import os

if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("BONDGRAPH_THREADS", "1")
