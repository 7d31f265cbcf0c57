"""Benchmarks: scripts that print tables; run one as ``python -m benchmarks.NAME``."""
