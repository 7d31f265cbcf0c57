"""Looking for trouble: random machines and damaged files, each with an own judge.

``python -m benchmarks.fuzzing graphs 10000`` and ``... files 2000``; see
docs/robustness.md for what they found.
"""
