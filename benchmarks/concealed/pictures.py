"""Pictures of the scoreboard: power, reliability, confusion and time."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

SILENT = ("adequate", "cannot_tell", "unexplained", "unknown_relation", "none")
"""What names no law: grey, where naming none is not right."""
GREEN, RED, GREY, BLUE = "#1b7837", "#b2182b", "#777777", "#2166ac"


def draw(numbers: Mapping[str, Any], folder: Path) -> None:
    """Write ``power``, ``reliability`` and ``confusion`` as SVG and PNG."""
    import matplotlib  # noqa: PLC0415 - only for the pictures

    matplotlib.use("agg")
    from matplotlib import pyplot as plt  # noqa: PLC0415

    plt.rcParams["svg.hashsalt"] = "concealed"
    for name, paint, size in (
        ("power", _power, (6.4, 3.6)),
        ("reliability", _reliability, (4.4, 4.0)),
        ("confusion", _confusion, (7.2, 6.4)),
    ):
        figure, axes = plt.subplots(figsize=size, layout="constrained")
        paint(axes, numbers)
        figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
        figure.savefig(folder / f"{name}.png", dpi=130)
        plt.close(figure)


def _bars(
    axes: Any, x: Sequence[float], shares: Sequence[Mapping[str, Any]], **look: Any
) -> None:
    """Draw shares with their 95 % intervals, where there are trials."""
    known = [(at, one) for at, one in zip(x, shares, strict=True) if one["trials"]]
    middle = [one["share"] for _, one in known]
    reach = (
        [max(one["share"] - one["low"], 0.0) for _, one in known],
        [max(one["high"] - one["share"], 0.0) for _, one in known],
    )
    at = [at for at, _ in known]
    axes.errorbar(at, middle, yerr=reach, marker="o", capsize=3, **look)


def _power(axes: Any, numbers: Mapping[str, Any]) -> None:
    rows = numbers["power"]
    for shift, key, colour in (
        (-0.06, "detected", GREY),
        (0.0, "right", GREEN),
        (0.06, "confidently_wrong", RED),
    ):
        x = [i + shift for i in range(len(rows))]
        label = key.replace("_", " ")
        _bars(axes, x, [row[key] for row in rows], color=colour, label=label)
    ticks = [
        f"{row['from']:g} to {row['to']:g}" if row["to"] else f"over {row['from']:g}"
        for row in rows
    ]
    names = [
        f"{t}\nn = {r['right']['trials']}" for t, r in zip(ticks, rows, strict=True)
    ]
    axes.set_xticks(range(len(rows)), names)
    axes.set_xlabel("residual of the best base model, over the noise")
    axes.set_ylabel("share of cases")
    axes.set_ylim(-0.03, 1.03)
    axes.legend(frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))


def _reliability(axes: Any, numbers: Mapping[str, Any]) -> None:
    rows = [r for r in numbers["calibration"]["rows"] if r["right"]["trials"]]
    axes.plot([0, 1], [0, 1], color=GREY, linewidth=1, label="calibrated")
    stated = [row["stated"] for row in rows]
    right = [row["right"] for row in rows]
    _bars(axes, stated, right, color=BLUE, label="findings", linestyle="none")
    for row in rows:
        axes.annotate(
            str(row["right"]["trials"]),
            (row["stated"], row["right"]["share"]),
            xytext=(-6, 8), textcoords="offset points", ha="right",
        )  # fmt: skip
    axes.set_xlabel("stated probability")
    axes.set_ylabel("share that is right")
    axes.set_xlim(-0.02, 1.02)
    axes.set_ylim(-0.02, 1.02)
    axes.legend(frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))


def _confusion(axes: Any, numbers: Mapping[str, Any]) -> None:
    """Draw the confusion matrix: right words green, silence grey, others red."""
    table = numbers["confusion"]
    concealed = list(table)
    words = sorted({word for row in table.values() for word in row})
    words.sort(key=lambda w: concealed.index(w) if w in concealed else len(concealed))
    for i, law in enumerate(concealed):
        for word, count in table[law].items():
            j, total = words.index(word), sum(table[law].values())
            right = word in numbers["accepted_words"].get(law, (law,))
            colour = GREEN if right else GREY if word in SILENT else RED
            axes.add_patch(_square(j, i, count / total, colour))
            axes.text(j, i, str(count), ha="center", va="center", fontsize=7)
    axes.set_xticks(range(len(words)), [_plain(w) for w in words], rotation=90)
    axes.set_yticks(range(len(concealed)), [_plain(law) for law in concealed])
    axes.tick_params(labelsize=7)
    axes.set_xlim(-0.6, len(words) - 0.4)
    axes.set_ylim(len(concealed) - 0.4, -0.6)
    axes.set_xlabel("said first")
    axes.set_ylabel("concealed")


def _square(x: int, y: int, share: float, colour: str) -> Any:
    from matplotlib.patches import Rectangle  # noqa: PLC0415

    return Rectangle((x - 0.5, y - 0.5), 1, 1, color=colour, alpha=0.15 + 0.6 * share)


def _plain(word: str) -> str:
    return word.replace("_", " ")
