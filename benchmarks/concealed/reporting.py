"""The scoreboard as JSON, Markdown and a picture."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.concealed.scoring import Scored, board


def write_board(scored: Sequence[Scored], folder: Path) -> dict[str, Any]:
    """Write ``score.json``, ``score.md`` and ``power.svg``; return the numbers."""
    folder.mkdir(parents=True, exist_ok=True)
    numbers = board(scored)
    content = {**numbers, "each": [asdict(one) for one in scored]}
    (folder / "score.json").write_text(
        json.dumps(content, indent=1, default=str) + "\n", "utf-8"
    )
    (folder / "score.md").write_text(markdown(scored, numbers), "utf-8")
    picture(numbers["power"], folder / "power.svg")
    return numbers


def markdown(scored: Sequence[Scored], numbers: Mapping[str, Any]) -> str:
    """Return the scoreboard as a page."""
    strong, empty = numbers["strong"], numbers["empty_cases"]
    achieved = numbers["achieved_held_out_improvement"]
    lines = [
        f"{numbers['cases']} cases, {numbers['empty']} of them empty.",
        "",
        "| effects of at least 5 x noise | share | 95 % interval | of |",
        "|---|---|---|---|",
        *(
            _row(name.replace("_", " "), value)
            for name, value in strong.items()
            if name != "what"
        ),
        "",
        "| empty cases | share | 95 % interval | of |",
        "|---|---|---|---|",
        *(_row(name.replace("_", " "), value) for name, value in empty.items()),
        "",
        "| outside the library | share | 95 % interval | of |",
        "|---|---|---|---|",
        _row("unknown relation at the place", numbers["outside"]["right"]),
        "",
        f"Share of the achievable held-out improvement: median "
        f"{_percent(achieved['median'])}, worst decile "
        f"{_percent(achieved['worst_decile'])} ({achieved['cases']} cases).",
        "",
        f"Time per case: median {numbers['seconds']['median'] or 0:.1f} s, largest "
        f"{numbers['seconds']['largest'] or 0:.1f} s.",
        "",
        "| residual over noise | detected | right | confidently wrong | of |",
        "|---|---|---|---|---|",
        *(
            f"| {row['from']:g} to {row['to'] or 'more'} | "
            f"{_percent(row['detected']['share'])} | {_percent(row['right']['share'])} "
            f"| {_percent(row['confidently_wrong']['share'])} | "
            f"{row['right']['trials']} |"
            for row in numbers["power"]
        ),
        "",
        "| concealed | said |",
        "|---|---|",
        *(
            f"| {law} | {', '.join(f'{w} {n}' for w, n in row.items())} |"
            for law, row in numbers["confusion"].items()
        ),
        "",
        "| case | over noise | concealed | said | outcome | achieved | s |",
        "|---|---|---|---|---|---|---|",
        *(
            f"| {s.case} | {s.strength:.1f} | {', '.join(s.concealed) or '-'} | "
            f"{', '.join(s.said) or s.verdict} | {s.outcome.value} | "
            f"{_percent(s.achieved)} | {s.seconds:.0f} |"
            for s in scored
        ),
    ]
    return "\n".join(lines) + "\n"


def _row(name: str, share: Mapping[str, Any]) -> str:
    return (
        f"| {name} | {_percent(share['share'])} | {_percent(share['low'])} to "
        f"{_percent(share['high'])} | {share['trials']} |"
    )


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.0f} %"


def picture(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Draw detection and right answers against strength."""
    import matplotlib  # noqa: PLC0415 - only for the picture

    matplotlib.use("svg")
    from matplotlib import pyplot as plt  # noqa: PLC0415

    figure, axes = plt.subplots(figsize=(6.0, 3.6))
    places = range(len(rows))
    for key, colour in (
        ("detected", "#888888"),
        ("right", "#1b7837"),
        ("confidently_wrong", "#b2182b"),
    ):
        known = [(i, row[key]) for i, row in zip(places, rows, strict=True)
                 if row[key]["trials"]]  # fmt: skip
        share = [value["share"] for _, value in known]
        bars = (
            [value["share"] - value["low"] for _, value in known],
            [value["high"] - value["share"] for _, value in known],
        )
        axes.errorbar(
            [i for i, _ in known], share, yerr=bars, marker="o", capsize=3,
            color=colour, label=key.replace("_", " "),
        )  # fmt: skip
    axes.set_xticks(list(places), [f"{r['from']:g}–{r['to'] or '…'}" for r in rows])
    axes.set_xlabel("residual of the best base model, over noise")
    axes.set_ylabel("share of cases")
    axes.set_ylim(-0.03, 1.03)
    axes.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)
