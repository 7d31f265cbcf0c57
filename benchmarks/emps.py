"""A real machine: how long fitting and diagnosing the EMPS recording take.

The model is that of ``examples/recordings/emps.py``. The recording (24 841 samples) is
not part of the repository; BONDGRAPH_RECORDINGS names the folder it is looked for in.
"""

import os
from pathlib import Path

import sympy

from benchmarks.measuring import (
    interleaved,
    print_machine,
    print_table,
    seconds,
    stopwatch,
    write_results,
)
from bondgraph import BondGraph, I, R, Se, diagnose, f, fit, load_model, read_for, split
from bondgraph.structure.graph import FinishedGraph

ROOT = Path(__file__).parents[1]
FOLDER = Path(os.environ.get("BONDGRAPH_RECORDINGS", ROOT / "../shared/recordings"))
PUBLISHED = {"M [kg]": 95.11, "F_v [N s/m]": 203.5, "F_c [N]": 20.39}


def with_dry_friction() -> FinishedGraph:
    """Return the carriage with Coulomb friction: four parameters to fit."""
    bias, coulomb, slip, viscous = sympy.symbols("bias coulomb slip viscous")
    axis = BondGraph("EMPS carriage with dry friction", domain="translation")
    axis.one(
        "carriage",
        Se("motor_force"),
        I("mass"),
        R("friction", law=viscous * f + coulomb * sympy.tanh(f / slip)),
        Se("amplifier_offset", value=bias),
    )
    axis.measure("position", displacement="carriage")
    axis.parameter("mass", 100, "kg", bounds=(1, 1e4))
    axis.parameter("viscous", 200, "N*s/m", bounds=(0, 1e5))
    axis.parameter("bias", 0, "N")
    axis.parameter("coulomb", 10, "N", bounds=(0, 1e3))
    axis.parameter("slip", 1e-3, "m/s", std=0.0)
    return axis.finish()


def main() -> None:
    file = FOLDER / "emps" / "train.csv"
    if not file.is_file():
        print(f"Skipped: there is no recording {file}.")
        return
    print_machine()
    graph = load_model(str(ROOT / "examples/recordings/emps.py:carriage"))
    reading, recording = stopwatch(lambda: read_for(graph, file))
    train, held_out = split(recording, 0.6)
    warming, _ = stopwatch(lambda: fit(graph, [train.part(0, 500)]), times=1)
    fitting, fitted = stopwatch(lambda: fit(graph, [train]), times=2)
    answering, answer = stopwatch(
        lambda: diagnose(graph, [train], held_out=[held_out]), times=1
    )
    dry = with_dry_friction()
    used = interleaved({"dry": lambda: fit(dry, [recording])}, rounds=3)["dry"][0]
    whole, dry_fit = stopwatch(lambda: fit(dry, [recording]), times=3)
    write_results(
        "emps",
        {"samples": len(recording), "seconds": whole, "processor_seconds": used,
         "estimates": {e.name: (e.value, e.std) for e in dry_fit.estimates}},
    )  # fmt: skip
    rows = [
        ("fit with dry friction", seconds(whole), f"{len(recording)} samples, 4 "
         f"parameters; {seconds(used)} of processor time"),
        ("read", seconds(reading), f"{len(recording)} samples"),
        ("first fit of 500 samples", seconds(warming), "with loading the kernel"),
        ("fit", seconds(fitting), f"{len(train)} samples, {fitted.iterations} steps"),
        ("diagnose", seconds(answering), f"{answer.verdict}: {len(answer.candidates)} "
         "candidates"),
    ]  # fmt: skip
    print_table("EMPS", ("what", "time", "of"), rows)
    assert answer.fit_all is not None
    print_table(
        f"Found: {', '.join(one.physics for one in answer.findings) or 'nothing'}; "
        "fitted to the whole recording at the end",
        ("parameter", "estimate", "std", "unit"),
        [
            (e.name, f"{e.value:.5g}", f"{e.std:.2g}" if e.std else "-", e.unit)
            for e in answer.fit_all.estimates
        ],
    )
    published = ", ".join(f"{name} {value:g}" for name, value in PUBLISHED.items())
    print(f"\nPublished: {published}")


if __name__ == "__main__":
    main()
