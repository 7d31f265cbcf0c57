"""Benchmarks as modules, wherever pytest was started from: tests run a few repeats."""

import sys
from importlib import import_module
from pathlib import Path

ROOT = str(Path(__file__).parents[1])
if ROOT not in sys.path:
    sys.path.append(ROOT)

coverage = import_module("benchmarks.coverage")
hard_pendulum = import_module("benchmarks.hard_pendulum")
