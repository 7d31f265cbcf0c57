"""Section 4.4 and chapter 5 of the FlegX thesis: motor, gravity, the four loops.

Figures 4.8 (square wave), 5.4 to 5.11 (Bode and Nichols of the loops, with ten times
the friction dashed), and the printed figures beside the recomputed ones.

Run with ``python examples/chapter5_loops.py [FOLDER]``; needs matplotlib.
"""

import math
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")  # pictures are written, no window is opened
import matplotlib.pyplot as plt
from scipy.signal import lsim

from bondgraph import state_space
from flegx_models.controllers import (
    MODELS,
    PrintedLoop,
    printed_figures,
    printed_loop,
    printed_reading,
    torque_constants_of_the_numerators,
)
from flegx_models.gravity import CASES, feed_forward, printed_feed_forward
from flegx_models.jump.leg_graph import leg_parameters
from flegx_models.motor import driven_motor
from flegx_models.parameters_control import CONTROL

GROWTH = CONTROL.values_by_name()["friction_growth"]
OMEGA = np.geomspace(0.05, 200, 400)


def motor_figure(folder: Path) -> None:
    system = state_space(driven_motor().finish())
    time = np.arange(4000) * 1e-6
    duty = np.where(time % 2e-3 < 1e-3, 20.0, -20.0)
    matrices = (system.A, system.B, system.C, system.D)
    _, current, _ = lsim(matrices, duty, time, interp=False)
    figure, axis = plt.subplots(figsize=(7, 3), layout="constrained")
    axis.plot(1e3 * time, current, label="current [A]")
    axis.plot(1e3 * time, 0.2 * duty, "k:", label="0.20 A/% · duty")
    axis.set(title="4.8 motor and driver", xlabel="time [ms]", ylim=(-5, 7))
    axis.legend(loc="upper right")
    figure.savefig(folder / "figure_4_8.png", dpi=90)
    plt.close(figure)


def loop_figure(folder: Path, model: str) -> None:
    loop = printed_loop(model)
    friction = GROWTH * loop.friction_pole
    curves = {
        "designed": (loop, "-"),
        f"{GROWTH:g} × friction, same zero": (loop.rubbed(friction), ":"),
        f"{GROWTH:g} × friction, zero moved": (
            printed_loop(model, "modified").rubbed(friction),
            "--",
        ),
    }
    figure, (bode, nichols) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
    twin = bode.twinx()
    for k, (name, (curve, style)) in enumerate(curves.items()):
        gain, phase = decibels_and_degrees(curve)
        bode.semilogx(OMEGA, gain, f"C{k}", ls=style, label=name)
        twin.semilogx(OMEGA, phase, f"C{k}", ls=style, alpha=0.5)
        nichols.plot(phase, gain, f"C{k}", ls=style, label=name)
    found = loop.figures
    bode.axvline(found.crossover, color="0.7")
    bode.set(xlabel="ω [rad/s]", ylabel="gain [dB]", title=model.replace("_", ", "))
    twin.set_ylabel("phase [°] (pale)")
    nichols.plot(-180, 0, "k+")
    nichols.set(
        xlabel="phase [°]", ylabel="gain [dB]", xlim=(-270, -60), ylim=(-50, 50)
    )
    nichols.set_title(
        f"crossover {found.crossover:.2f} rad/s, "
        f"margin {math.degrees(found.phase_margin):.2f}°"
    )
    nichols.legend(fontsize=8, loc="lower right")
    figure.savefig(folder / f"loop_{model}.png", dpi=90)
    plt.close(figure)


def decibels_and_degrees(loop: PrintedLoop) -> tuple[np.ndarray, np.ndarray]:
    gain = [20 * math.log10(abs(loop.response(w))) for w in OMEGA]
    return np.array(gain), np.array([math.degrees(loop.phase(w)) for w in OMEGA])


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
    for model in MODELS:
        loop_figure(folder, model)
    print(loop_table())
    print(gravity_table())
    low, high = torque_constants_of_the_numerators()
    print(f"numerators of eq. 5.10 to 5.22: K_m from {low:.5f} to {high:.5f} N·m/A")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/chapter5"))
