"""``python -m benchmarks.flegx_story make | run | shape``; see docs/flegx_story.md."""

import argparse
import json
from pathlib import Path
from typing import Any

from benchmarks.concealed.running import run_all
from benchmarks.flegx_story.leg import ALL, ALONE, JOINTS
from benchmarks.flegx_story.recording import write_case
from benchmarks.flegx_story.train import RATIO, WORM
from bondgraph import load_model

SEED = 11
ALONE_IN = "lowerleg_stance"
"""The drive of which each piece of physics is also concealed alone."""

RATIOS = {"motor": RATIO, "worm": WORM, "joint": 1.0}
"""Speed of a place per speed of the joint."""


def make(folder: Path) -> None:
    """Write the cases: each drive with all that is concealed, one with each alone."""
    for joint in JOINTS:
        write_case(folder, joint, ALL, SEED)
        if joint.model == ALONE_IN:
            for one in ALONE:
                write_case(folder, joint, one, SEED)


def said(answer: Path) -> str:
    """Return what was said of a case, in a line."""
    told: dict[str, Any] = json.loads(answer.read_text("utf-8"))
    findings = [f"{one['physics']} at {one['place']}" for one in told["findings"]]
    return f"{answer.stem:26s} {told['verdict']}: {', '.join(findings) or 'nothing'}"


def shaped(answer: Path) -> str:
    """Return the zero and the crossover for the model that was found, in a line."""
    # imported here: making and running need no loops
    from benchmarks.flegx_story.shaping import (  # noqa: PLC0415
        designed,
        plant_of,
        rubbed,
        speed_of_the_test,
    )

    told: dict[str, Any] = json.loads(answer.read_text("utf-8"))
    dry = [one for one in told["findings"] if one["physics"] == "coulomb_friction"]
    if len(dry) != 1:
        return "no Coulomb friction alone was found: the formula of the zero needs one"
    (one,) = dry
    (size,) = one["parameters"].values()
    ratio = RATIOS[one["place"]]
    text = answer.with_suffix(".py")
    text.write_text(told["model"], "utf-8")
    limb, phase, concealed = answer.stem.split("_", 2)
    speed = ratio * speed_of_the_test(f"{limb}_{phase}")
    found = load_model(f"{text}:model")
    plant = plant_of(rubbed(found, one["element"], size["value"], speed))
    behind_the_filter = concealed in ("all", "filter")
    design = designed(f"{limb}_{phase}", plant, filtered=not behind_the_filter)
    return (
        f"F = {ratio * size['value']:.2f} N·m at the joint; zero at "
        f"{design.controller.value('zero'):.2f} rad/s, crossover "
        f"{design.measures.crossover:.2f} rad/s. {design.status.value}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.flegx_story")
    parser.add_argument("what", choices=("make", "run", "shape"))
    parser.add_argument("--out", type=Path, default=Path("flegx-story"))
    parser.add_argument("--names", nargs="*", default=(), help="words in a case's name")
    parser.add_argument("--limit", type=float, default=1800.0, help="s for one case")
    chosen = parser.parse_args()
    cases, answers = chosen.out / "cases", chosen.out / "answers"
    match chosen.what:
        case "make":
            make(cases)
        case "run":
            run_all(cases, answers, workers=1, limit=chosen.limit, names=chosen.names)
        case _:
            for answer in sorted(answers.glob("*.json")):
                if not answer.name.endswith(".run.json"):
                    print(f"{said(answer)}\n    {shaped(answer)}")


if __name__ == "__main__":
    main()
