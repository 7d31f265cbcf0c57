"""Checking: derived gains, poles, zeros and margins against declared values, for CI."""

from bondgraph.checking.declaration import read_checks
from bondgraph.checking.junit import write_junit
from bondgraph.checking.records import Check
from bondgraph.checking.run import CheckReport, CheckResult, run_checks

__all__ = [
    "Check",
    "CheckReport",
    "CheckResult",
    "read_checks",
    "run_checks",
    "write_junit",
]
