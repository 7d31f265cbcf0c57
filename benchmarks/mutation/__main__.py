"""Mutation testing of what is trusted: causality, equations and evidence.

    python -m benchmarks.mutation coverage              # which test runs which line
    python -m benchmarks.mutation run --sample 300      # mutants, drawn with a seed
    python -m benchmarks.mutation report                # what survived, and the shares

A mutant is killed when a test that runs its line fails, or takes ten times as long as
before. Each is tried in a process of its own by the tests that run its line, the
quickest first. What was tried is kept line by line, so that a run goes on.
"""

import argparse
from pathlib import Path

from benchmarks.mutation.covering import cover
from benchmarks.mutation.reporting import told
from benchmarks.mutation.running import try_mutants

WORK = Path("out/mutation")


def main() -> None:
    """Do one of the three steps."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("step", choices=["coverage", "run", "report"])
    parser.add_argument("--sample", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=40.0)
    parser.add_argument("--only", default="", help="mutants whose path contains this")
    chosen = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    if chosen.step == "coverage":
        cover(WORK)
    elif chosen.step == "run":
        try_mutants(
            WORK, chosen.sample, chosen.seed, 60.0 * chosen.minutes, chosen.only
        )
    else:
        print(told(WORK))


if __name__ == "__main__":
    main()
