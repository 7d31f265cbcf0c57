"""Section 4.4 and chapter 5 of the FlegX thesis: motor, gravity, the four loops.

Figures 4.8 (square wave) and 5.4 to 5.11 (Bode and Nichols of the four loops, as
designed and with ten times the friction); all twelve printed controllers in their
loops; gravity's torques and the loops' numerators.

Run with ``python examples/chapter5_loops.py [FOLDER]``; needs matplotlib.
"""

import math
import sys
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")  # pictures are written, no window is opened
import matplotlib.pyplot as plt
from scipy.signal import lsim

from bondgraph import (
    FrictionRule,
    SecondOrderPrototype,
    SheetRow,
    comparison_sheet,
    state_space,
    write_picture,
)
from flegx_models.controllers import (
    MODELS,
    evaluated,
    printed_figures,
    printed_loop,
    printed_reading,
)
from flegx_models.gravity import CASES, feed_forward, printed_feed_forward
from flegx_models.jump.leg_graph import leg_parameters
from flegx_models.loop_numerators import torque_constants_of_the_numerators
from flegx_models.motor import driven_motor
from flegx_models.parameters_control import CONTROL

GROWTH = CONTROL.values_by_name()["friction_growth"]
PROTOTYPE = SecondOrderPrototype(CONTROL.values_by_name()["damping_prototype"])


def motor_figure(folder: Path) -> None:
    system = state_space(driven_motor().finish())
    time = np.arange(4000) * 1e-6
    duty = np.where(time % 2e-3 < 1e-3, 20.0, -20.0)
    matrices = (system.A, system.B, system.C, system.D)
    _, current, _ = lsim(matrices, duty, time, interp=False)
    figure, axis = plt.subplots(figsize=(7, 3), layout="constrained")
    axis.plot(1e3 * time, current, label="current")
    axis.plot(1e3 * time, 0.2 * duty, "k:", label="0.20 A/% · duty")
    axis.set(title="4.8 motor and driver", xlabel="time [ms]", ylabel="current")
    axis.set_ylim(-5, 7)
    axis.legend(loc="upper right")
    figure.savefig(folder / "figure_4_8.png", dpi=90)
    plt.close(figure)


def loops(model: str) -> SheetRow:
    """Return a loop as designed, and what ten times the friction makes of it."""
    designed = printed_loop(model)
    rule = FrictionRule(
        lead=designed.lead,
        friction_pole=designed.friction_pole,
        crossover=designed.figures.crossover,
    )
    rubbed = designed.rubbed(GROWTH * designed.friction_pole)
    moved = printed_loop(model, "modified").rubbed(rubbed.friction_pole)
    riding = replace(rubbed, lead=rule.at(rubbed.friction_pole))
    return SheetRow(
        title=model.replace("_", ", "),
        designed={"designed": designed.loop},
        changed={
            "designed": designed.loop,
            f"friction × {GROWTH:g}": rubbed.loop,
            "zero as printed": moved.loop,
            "zero as derived": riding.loop,
        },
    )


def loop_table() -> str:
    lines = [f"{'loop':18}{'ω_gc':>16}{'ω_pc':>16}{'margin [°]':>18}{'as printed':>14}"]
    for model in MODELS:
        found, printed = printed_loop(model).figures, printed_figures(model)
        raw = printed_loop(model, reading=printed_reading()).figures
        margins = (math.degrees(m) for m in (found.phase_margin, printed.phase_margin))
        lines.append(
            f"{model:18}{found.crossover:8.2f}{printed.crossover:8.2f}"
            f"{found.turnover:8.2f}{printed.turnover:8.2f}"
            + "{:10.2f}{:8.2f}".format(*margins)
            + f"{math.degrees(raw.phase_margin):14.1f}"
        )
    return "\n".join([*lines, "(recomputed, printed; last: formulas as they stand)"])


def versions_table() -> str:
    lines = [
        f"{'controller':20}{'version':10}{'friction pole':>14}{'ω_gc':>8}{'ω_pc':>8}"
        f"{'margin [°]':>12}"
    ]
    for model, version, loop in evaluated():
        found = loop.figures
        lines.append(
            f"{model:20}{version:10}{loop.friction_pole:14.2f}{found.crossover:8.2f}"
            f"{found.turnover:8.2f}{math.degrees(found.phase_margin):12.2f}"
        )
    return "\n".join(lines)


def gravity_table() -> str:
    lines = [f"{'gravity [N·m]':18}{'hip':>8}{'printed':>9}{'knee':>9}{'printed':>9}"]
    for case in CASES:
        found, printed = (
            feed_forward(case, leg_parameters()),
            printed_feed_forward(case),
        )
        cells = (found.hip, printed.hip, found.knee, printed.knee)
        lines.append(f"{case:18}" + "{:8.2f}{:9.2f}{:9.2f}{:9.2f}".format(*cells))
    return "\n".join(lines)


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    motor_figure(folder)
    sheet = comparison_sheet([loops(m) for m in MODELS], prototype=PROTOTYPE)
    write_picture(sheet, folder / "figures_5_4_to_5_11.png")
    print(loop_table())
    print(versions_table())
    print(gravity_table())
    low, high = torque_constants_of_the_numerators()
    print(f"numerators of eq. 5.10 to 5.22: K_m from {low:.5f} to {high:.5f} N·m/A")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/chapter5"))
