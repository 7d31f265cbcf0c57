"""``python -m benchmarks.flegx_story make | run | shape``; see docs/flegx_story.md."""

import argparse
import json
from pathlib import Path
from typing import Any

from benchmarks.concealed.running import run_all
from benchmarks.flegx_story.leg import ALL, ALONE, JOINTS
from benchmarks.flegx_story.recording import write_case

SEED = 11
ALONE_IN = "lowerleg_stance"
"""The drive of which each piece of physics is also concealed alone."""


def make(folder: Path, samples: int) -> None:
    """Write the cases: each drive with all that is concealed, one with each alone.

    With all, also as the leg's torque sensor and strain gauges see it.
    """
    for joint in JOINTS:
        write_case(folder, joint, ALL, SEED, samples)
        write_case(folder, joint, ALL, SEED, samples, gauged=True)
        if joint.model == ALONE_IN:
            for one in ALONE:
                write_case(folder, joint, one, SEED, samples)


def said(answer: Path) -> str:
    """Return what was said of a case, in a line."""
    told: dict[str, Any] = json.loads(answer.read_text("utf-8"))
    findings = [f"{one['physics']} at {one['place']}" for one in told["findings"]]
    return f"{answer.stem:26s} {told['verdict']}: {', '.join(findings) or 'nothing'}"


def shaped(answer: Path) -> str:
    """Return the zero and the crossover for the model that was found, in a line."""
    # imported here: making and running need no loops
    from benchmarks.flegx_story.zeros import found_zero  # noqa: PLC0415

    found = found_zero(answer)
    if found is None:
        return "no single dry friction was found: the formula of the zero needs one"
    return (
        f"F = {found.friction:.2f} N·m at the joint; zero at {found.zero:.2f} rad/s, "
        f"crossover {found.design.measures.crossover:.2f} rad/s. "
        f"{found.design.status.value}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.flegx_story")
    parser.add_argument("what", choices=("make", "run", "shape"))
    parser.add_argument("--out", type=Path, default=Path("flegx-story"))
    parser.add_argument("--names", nargs="*", default=(), help="words in a case's name")
    parser.add_argument("--limit", type=float, default=1800.0, help="s for one case")
    parser.add_argument("--samples", type=int, default=1500, help="of a recording")
    chosen = parser.parse_args()
    cases, answers = chosen.out / "cases", chosen.out / "answers"
    match chosen.what:
        case "make":
            make(cases, chosen.samples)
        case "run":
            run_all(cases, answers, workers=1, limit=chosen.limit, names=chosen.names)
        case _:
            for answer in sorted(answers.glob("*.json")):
                if not answer.name.endswith(".run.json"):
                    print(f"{said(answer)}\n    {shaped(answer)}")


if __name__ == "__main__":
    main()
