"""The scoreboard as JSON, Markdown and pictures."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.concealed.board import board
from benchmarks.concealed.pictures import draw
from benchmarks.concealed.scoring import Scored


def write_board(scored: Sequence[Scored], folder: Path) -> dict[str, Any]:
    """Write ``score.json``, ``score.md`` and the pictures; return the numbers."""
    folder.mkdir(parents=True, exist_ok=True)
    numbers = board(scored)
    content = {**numbers, "each": [asdict(one) for one in scored]}
    (folder / "score.json").write_text(
        json.dumps(content, indent=1, default=str) + "\n", "utf-8"
    )
    (folder / "score.md").write_text(markdown(scored, numbers), "utf-8")
    draw(numbers, folder)
    return numbers


def markdown(scored: Sequence[Scored], numbers: Mapping[str, Any]) -> str:
    """Return the scoreboard as a page."""
    achieved, seconds = numbers["achieved_held_out_improvement"], numbers["seconds"]
    empty, named = numbers["empty_cases"], numbers["named_pairs"]
    outside = numbers["outside"]
    parts = [
        f"{numbers['cases']} cases, {numbers['empty']} of them empty.",
        _shares("effects of at least 5 x noise", numbers["strong"]),
        f"An answer names {_number(named['median'])} pairs of physics and place in "
        f"the median, {_number(named['largest'])} at most.",
        _shares("empty cases", empty),
        _shares(
            "outside the library, at least 5 x noise",
            {
                "unknown relation at the place": outside["right"],
                "its curve within 10 %, where one is shown": outside["curve_within"],
            },
        ),
        f"Share of the achievable held-out improvement: median "
        f"{_percent(achieved['median'])}, worst decile "
        f"{_percent(achieved['worst_decile'])} ({achieved['cases']} cases).",
        f"Time per case: median {seconds['median'] or 0:.1f} s, largest "
        f"{seconds['largest'] or 0:.1f} s, all {(seconds['sum'] or 0) / 60:.0f} min.",
        _power_table(numbers["power"]),
        _calibration_table(numbers["calibration"]),
        _table(
            ("concealed", "said first"),
            ((law, _listed(row)) for law, row in numbers["confusion"].items()),
        ),
        _table(
            ("machine", "outcomes"),
            ((name, _listed(row)) for name, row in numbers["by_machine"].items()),
        ),
        "![power](power.svg) ![reliability](reliability.svg) "
        "![confusion](confusion.svg)",
        _table(
            ("case", "over noise", "concealed", "said", "outcome", "achieved", "s"),
            map(_case_row, scored),
        ),
    ]
    return "\n\n".join(parts) + "\n"


def _shares(title: str, rows: Mapping[str, Any]) -> str:
    return _table(
        (title, "share", "95 % interval", "of"),
        (
            (
                name.replace("_", " "),
                _percent(one["share"]),
                f"{_percent(one['low'])} to {_percent(one['high'])}",
                str(one["trials"]),
            )
            for name, one in rows.items()
            if isinstance(one, Mapping) and "share" in one
        ),
    )


def _power_table(rows: Sequence[Mapping[str, Any]]) -> str:
    return _table(
        ("residual over noise", "detected", "right", "confidently wrong", "of"),
        (
            (
                f"{row['from']:g} to {row['to'] or 'more'}",
                *(
                    _percent(row[key]["share"])
                    for key in ("detected", "right", "confidently_wrong")
                ),
                str(row["right"]["trials"]),
            )
            for row in rows
        ),
    )


def _calibration_table(calibration: Mapping[str, Any]) -> str:
    brier = calibration["brier"]
    table = _table(
        ("stated probability", "mean", "right as said", "95 % interval", "of"),
        (
            (
                f"{100 * row['from']:g} to {100 * row['to']:g} %",
                _percent(row["stated"]),
                _percent(row["right"]["share"]),
                f"{_percent(row['right']['low'])} to {_percent(row['right']['high'])}",
                str(row["right"]["trials"]),
            )
            for row in calibration["rows"]
        ),
    )
    end = "" if brier is None else f"\n\nBrier score {brier:.3f}."
    return table + end


def _case_row(s: Scored) -> tuple[str, ...]:
    return (
        s.case,
        f"{s.strength:.1f}",
        ", ".join(s.concealed) or "-",
        ", ".join(s.said) or s.verdict,
        s.outcome.value,
        _percent(s.achieved),
        f"{s.seconds:.0f}",
    )


def _table(head: Sequence[str], rows: Any) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _listed(row: Mapping[str, int]) -> str:
    return ", ".join(f"{word} {count}" for word, count in row.items())


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.0f} %"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:g}"
