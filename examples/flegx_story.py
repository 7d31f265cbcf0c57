"""The story of FlegX's own mismatch: what was concealed, what was found, the zeros.

Four drives of a simulated leg have what the thesis's four models leave out. Recordings,
answers and controllers are those of ``python -m benchmarks.flegx_story make`` and
``run``; this draws them, and prints one line for each drive.

Run with ``python examples/flegx_story.py [FOLDER] [PICTURE]`` from the top of the
repository; needs matplotlib. FOLDER is that of ``make`` and ``run``.
"""

import sys
from pathlib import Path
from textwrap import wrap

import matplotlib as mpl

mpl.use("Agg")  # pictures are written, no window is opened
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.flegx_story.telling import (
    Telling,
    Told,
    model_and_concealed,
    tellings,
)
from benchmarks.flegx_story.zeros import found_zero, printed_zero, tuned_zero
from flegx_models.tuned_zeros import identified_friction, tuning_tests

INK, GREY = "#222222", "#9a9a9a"
COLOURS = {Told.RIGHT: "#2a7f4f", Told.KIND: "#e0a030", Told.SILENT: "#ffffff"}
PIECES = {
    "worm": "worm\nfriction",
    "tendons": "tendon\ncompliance",
    "link": "flexible\nlink",
    "filter": "encoder\nfilter",
}
ALONE_FIRST = ("worm", "tendons", "link", "filter", "all")


def wording(name: str) -> str:
    """Return a case's name in words."""
    model, which = model_and_concealed(name)
    limb, phase = model.split("_")
    limb = {"lowerleg": "lower leg", "upperleg": "upper leg"}[limb]
    gauged = ", gauged" if name.endswith("_gauged") else ""
    return f"{limb}, {phase}, {'all' if which == 'all' else which + ' alone'}{gauged}"


def order(one: Telling) -> tuple[int, str]:
    return ALONE_FIRST.index(model_and_concealed(one.name)[1]), one.name


def found_and_concealed(axes: Axes, told: list[Telling]) -> None:
    """Draw a row for each case: a ring for what is concealed, filled where found."""
    for row, one in enumerate(told):
        for column, piece in enumerate(PIECES):
            if piece in one.pieces:
                axes.plot(column, row, "o", ms=15, mfc=COLOURS[one.pieces[piece]],
                          mec=INK, mew=1.2)  # fmt: skip
        beside = ", ".join(said.replace("_", " ") for said in one.beside)
        said = one.verdict.replace("_", " ") + (f"; also {beside}" if beside else "")
        said = "\n".join(wrap(said, 46))
        axes.text(len(PIECES) - 0.45, row, said, va="center", fontsize=8, color=INK)
    axes.set_xticks(range(len(PIECES)), PIECES.values(), fontsize=8)
    axes.xaxis.tick_top()
    axes.set_yticks(range(len(told)), [wording(one.name) for one in told], fontsize=8)
    axes.set_xlim(-0.6, len(PIECES) + 2.3)
    axes.set_ylim(len(told) - 0.4, -0.7)
    for kind, text in (
        (Told.RIGHT, "found and named"),
        (Told.KIND, "found, called another of its kind"),
        (Told.SILENT, "concealed, not found"),
    ):
        axes.plot([], [], "o", ms=9, mfc=COLOURS[kind], mec=INK, label=text)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.01), ncols=3,
                frameon=False, fontsize=8)  # fmt: skip
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def held_out(axes: Axes, told: list[Telling]) -> None:
    """Draw the held-out error of every case before and after."""
    for row, one in enumerate(told):
        axes.plot([one.after, one.before], [row, row], "-", color=GREY, lw=1.5)
        axes.plot(one.before, row, "o", color=GREY, ms=6)
        axes.plot(one.after, row, "o", color="#1f5fa8", ms=6)
    axes.set_xscale("log")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(len(told) - 0.4, -0.7)
    axes.set_yticks([])
    axes.set_title("held-out error [rad]:\nprinted (grey), found (blue)", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.spines[["left", "right", "top"]].set_visible(False)


def zeros(axes: Axes, folder: Path) -> None:
    """Draw the zero of each drive's controller: printed, found, and tuned by hand."""
    worm = identified_friction().worm
    for column, test in enumerate(tuning_tests()):
        axes.plot(column, printed_zero(test.model), "_", ms=18, mew=2, color=GREY)
        axes.plot(column, test.zero(worm), "s", ms=9, mfc="none", mec=INK)
        axes.plot(column, tuned_zero(test.model), "x", ms=8, mew=2, color="#b03030")
        for answer in sorted(folder.glob(f"{test.model}_*.json")):
            found = None if answer.stem.endswith(".run") else found_zero(answer)
            if found is not None:
                axes.plot(column + 0.22, found.zero, "o", ms=8, color="#1f5fa8")
    names = [
        test.model.replace("leg_", " leg,\n").replace("_", " ")
        for test in tuning_tests()
    ]
    axes.set_xticks(range(len(names)), names, fontsize=8)
    axes.set_yscale("log")
    axes.set_ylabel("zero of the lead [rad/s]", fontsize=8)
    axes.tick_params(labelsize=8)
    for marker, text, style in (
        ("_", "printed model", {"color": GREY, "ms": 12, "mew": 2}),
        ("o", "model found from recordings", {"color": "#1f5fa8", "ms": 7}),
        ("s", "with the concealed friction", {"mfc": "none", "mec": INK, "ms": 8}),
        ("x", "tuned by hand, chapter 6", {"color": "#b03030", "ms": 7, "mew": 2}),
    ):
        axes.plot([], [], marker, ls="", label=text, **style)
    axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes.spines[["right", "top"]].set_visible(False)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "flegx-story") / "answers"
    picture = Path(sys.argv[2] if len(sys.argv) > 2 else "flegx_story.svg")
    told = sorted(tellings(folder), key=order)
    for one in told:
        came = ", ".join(f"{piece}: {what.value}" for piece, what in one.pieces.items())
        print(f"{wording(one.name):32s} {one.verdict:16s} {came}")
    mpl.rcParams["svg.hashsalt"] = "flegx"  # the same answers make the same file
    figure, ((left, right), (below, empty)) = plt.subplots(
        2, 2, figsize=(10.0, 7.0), width_ratios=(2.8, 1.0), height_ratios=(1.5, 1.0)
    )
    empty.set_visible(False)
    found_and_concealed(left, told)
    held_out(right, told)
    zeros(below, folder)
    figure.tight_layout()
    figure.savefig(picture, metadata={"Date": None})
    print(f"drawn: {picture}")


if __name__ == "__main__":
    main()
