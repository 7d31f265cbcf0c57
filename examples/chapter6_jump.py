"""Chapter 6 of the FlegX thesis: its figures, and who leaves the ground.

Figures 6.1 to 6.4 (tuning tests), 6.5 and 6.6 (squat), 6.7 as it runs (the jump). The
thesis's recordings are not public: the worm's friction is the one that its tuned zeros
stand for, or the least one with which the worm is irreversible.

Run with ``python examples/chapter6_jump.py [FOLDER]``; needs matplotlib.
"""

import sys
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")  # pictures are written, no window is opened
import matplotlib.pyplot as plt
from scipy.optimize import minimize_scalar

from bondgraph import Lead
from flegx_models.controllers import controller
from flegx_models.jump.simulation import Experiment, JumpRecord, run
from flegx_models.jump.tuning_run import run_test
from flegx_models.jump.worm import WormGear, irreversible_worm
from flegx_models.parameters_control import CONTROL
from flegx_models.planning import Phase, printed_plan
from flegx_models.tuned_zeros import TuningTest, identified_friction, tuning_tests

LOCKING = irreversible_worm()
IDEAL = LOCKING.with_friction(0.0)
LONG = 2 * CONTROL.values_by_name()["period_test"]  # s, of a tuning test
HUNG = CONTROL.values_by_name()["m_counterweight"]
TITLES = (
    "6.1 lower leg, flight",
    "6.2 upper leg, flight",
    "6.3 lower leg, stance",
    "6.4 upper leg, stance",
)


def tuning_figures(folder: Path, worm: WormGear) -> None:
    figure, axes = plt.subplots(2, 2, figsize=(10, 6), layout="constrained")
    for axis, test, title in zip(axes.flat, tuning_tests(), TITLES, strict=True):
        designed, final = (controller(test.model, v) for v in ("printed", "tuned"))
        ideal = run_test(test, IDEAL, designed, LONG)
        printed = run_test(test, worm, designed, LONG)
        tuned = run_test(test, worm, final, LONG)
        axis.plot(ideal.time, np.degrees(ideal.reference), "0.6", label="reference")
        axis.plot(ideal.time, np.degrees(ideal.angle), "k--", label="without friction")
        axis.plot(printed.time, np.degrees(printed.angle), label="worm, designed zero")
        axis.plot(tuned.time, np.degrees(tuned.angle), label="worm, tuned zero")
        axis.set(title=title, xlabel="time [s]", ylabel="angle [°]")
    lines, names = axes.flat[0].get_legend_handles_labels()
    figure.legend(lines, names, loc="outside lower center", ncols=4)
    save(figure, folder / "figures_6_1_to_6_4.png")


def squat_figures(folder: Path) -> None:
    plan = printed_plan()
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.5), layout="constrained")
    hip, knee = plan.squat()
    time = np.linspace(0, plan.squat_time, 200)
    hips = np.array([[hip.at(t).angle, hip.at(t).speed] for t in time])
    knees = np.array([[knee.at(t).angle, knee.at(t).speed] for t in time])
    joints = (("6.5 hip θ1", hips), ("6.6 knee θ2 (relative)", knees - hips))
    for axis, (title, values) in zip(axes, joints, strict=True):
        axis.plot(time, values[:, 0], label="angle [rad]")
        axis.plot(time, values[:, 1], label="speed [rad/s]")
        axis.set(title=title, xlabel="time [s]")
        axis.legend()
    save(figure, folder / "figures_6_5_and_6_6.png")


def jump_figure(folder: Path, worm: WormGear) -> None:
    figure, axes = plt.subplots(4, 2, figsize=(11, 9), sharex=True, sharey="row")
    for column, hung in enumerate((0.0, HUNG)):
        found = run(Experiment(worm=worm, counterweight=hung, duration=1.5))
        draw_jump(axes[:, column], found)
        axes[0, column].set_title(f"counterweight {hung:g} kg")
    axes[0, 0].legend(fontsize=8, loc="upper right")
    axes[3, 0].legend(fontsize=8, loc="upper right")
    figure.tight_layout()
    save(figure, folder / "jump.png")


def draw_jump(axes: np.ndarray, found: JumpRecord) -> None:
    time = found.time
    for k, joint in enumerate(("hip", "knee")):
        color = f"C{k}"
        # Both bend away from the vertical; the knee's absolute angle mirrors the hip's.
        bend = np.degrees(np.abs([found.references[:, k], found.angles[:, k]]))
        axes[0].plot(time, bend[0], color, ls=":")
        axes[0].plot(time, bend[1], color, label=joint)
        axes[3].plot(time, found.currents[:, k], color, label=joint)
    axes[1].plot(time, found.push, "k")
    axes[2].plot(time, 1e3 * found.clearance, "C2")
    labels = ("|angle| [°]", "ground [N]", "foot above ground [mm]", "current [A]")
    for axis, label in zip(axes, labels, strict=True):
        axis.set_ylabel(label)
        for start, end in found.flights:
            axis.axvspan(start, end, color="C2", alpha=0.15)
    waiting = [phase is not Phase.SQUATTING for phase in found.phases]
    top = axes[3].get_ylim()[1]
    axes[3].fill_between(time, 0, top, where=waiting, color="0.9", step="post")
    axes[3].set_xlabel("time [s] (grey: the planner believes to fly)")


def who_leaves_the_ground(worm: WormGear) -> str:
    plan = printed_plan()
    faster = replace(plan, hip_speed=2 * plan.hip_speed, knee_speed=2 * plan.knee_speed)
    worms = {
        "ideal worm": IDEAL,
        "worm of the tuned zeros": worm,
        "irreversible worm": LOCKING,
    }
    lines = [
        f"{'highest, 0.8 s [mm]':26}{'0 kg':>8}{'5 kg':>8}{'0 kg, twice as fast':>21}"
    ]
    for name, gear in worms.items():
        cases = ((0.0, plan), (HUNG, plan), (0.0, faster))
        heights = [
            run(
                Experiment(worm=gear, counterweight=hung, plan=way, duration=0.8)
            ).highest
            for hung, way in cases
        ]
        cells = "".join(
            f"{1e3 * h:{w}.2f}" for h, w in zip(heights, (8, 8, 21), strict=True)
        )
        lines.append(f"{name:26}{cells}")
    return "\n".join(lines)


def closest_zero(test: TuningTest, worm: WormGear) -> tuple[float, float, float]:
    """Return the zero whose response comes closest to the one without friction.

    As section 6.1 tunes, on the simulated machine, with the tuned gain and pole. Then
    what the designed and the tuned controller leave over, as shares of the swing.
    """
    designed, tuned = (controller(test.model, v) for v in ("printed", "tuned"))
    ideal = run_test(test, IDEAL, designed, LONG)
    swing = float(np.ptp(ideal.reference))

    def left(law: Lead) -> float:
        return run_test(test, worm, law, LONG).distance(ideal) / swing

    best = minimize_scalar(
        lambda zero: left(replace(tuned, zero=zero)),
        bounds=(tuned.zero / 2, 2 * tuned.zero),
        method="bounded",
        options={"xatol": 0.05},
    )
    return float(best.x), left(designed), left(tuned)


def zeros_table() -> str:
    found = identified_friction()
    lines = [
        "zeros [rad/s]      tuned  irreversible  two frictions  closest  "
        "left over: designed, tuned [% of the swing]"
    ]
    for test, fitted in zip(tuning_tests(), found.zeros, strict=True):
        best, designed, tuned = closest_zero(test, found.worm)
        lines.append(
            f"{test.model:18}{test.tuned_zero:6.2f}{test.zero(LOCKING):14.2f}"
            f"{fitted:15.2f}{best:9.2f}{100 * designed:14.1f}{100 * tuned:7.1f}"
        )
    lines.append(
        f"fitted: f = {found.worm.friction:.3f} (irreversible from "
        f"{LOCKING.friction:.3f}), {found.worm.constant:.2f} N·m without load"
    )
    return "\n".join(lines)


def save(figure: plt.Figure, path: Path) -> None:
    figure.savefig(path, dpi=90)
    plt.close(figure)


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    worm = identified_friction().worm
    tuning_figures(folder, worm)
    squat_figures(folder)
    jump_figure(folder, worm)
    print(zeros_table())
    print(who_leaves_the_ground(worm))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/chapter6"))
