"""The other methods run on every case, held against the same truth."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmarks.concealed.others.base import FittedBase, fitted_base
from benchmarks.concealed.others.methods import (
    Said,
    every_term_by_aic,
    gaussian_process,
    sindy,
)

METHODS: dict[str, Callable[[FittedBase], Said]] = {
    "every term, AIC": every_term_by_aic,
    "Gaussian process": gaussian_process,
    "SINDy discrepancy": sindy,
}


def compare(public: Path, sealed: Path, names: tuple[str, ...]) -> list[dict[str, Any]]:
    """Return one row per case and method; cases are those with a truth."""
    rows = []
    for case in sorted(path.parent for path in public.glob("*/case.json")):
        truth_file = sealed / f"{case.name}.json"
        wanted = not names or any(name in case.name for name in names)
        if not wanted or not truth_file.exists():
            continue
        truth = json.loads(truth_file.read_text("utf-8"))
        base = fitted_base(case)
        for method, run in METHODS.items():
            rows.append(_row(truth, method, run(base)))
            print(rows[-1], flush=True)
    return rows


def _row(truth: dict[str, Any], method: str, said: Said) -> dict[str, Any]:
    """Hold what a method says against the effects; one of two is enough here."""
    place = physics = both = False
    for effect in truth["effects"]:
        for one in effect["accepted"]:
            at = said.finding is not None and said.finding[1] in one["places"]
            is_it = said.finding is not None and said.finding[0] in one["words"]
            place, physics, both = place or at, physics or is_it, both or (at and is_it)
    empty = not [e for e in truth["effects"] if not e["silent"]]
    return {
        "case": truth["case"],
        "method": method,
        "strength": truth["effect_over_noise"],
        "empty": empty,
        "concealed": [f"{e['law']} at {e['place']}" for e in truth["effects"]],
        "said": " at ".join(said.finding) if said.finding else None,
        "place": place and not empty,
        "physics": physics and not empty,
        "both": both and not empty,
        "false_alarm": empty and said.finding is not None,
        "held_out_before": said.before,
        "held_out_after": said.after,
        "terms": said.terms,
        "note": said.note,
    }


def table(rows: list[dict[str, Any]]) -> str:
    """Return the comparison as Markdown."""
    lines = [
        "| method | located | named | both | of | false alarms | of empty | "
        "median held-out after / before |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for method in METHODS:
        own = [row for row in rows if row["method"] == method]
        strong = [r for r in own if not r["empty"] and r["strength"] >= 5.0]
        empty = [r for r in own if r["empty"]]
        ratios = sorted(r["held_out_after"] / r["held_out_before"] for r in strong)
        median = f"{ratios[len(ratios) // 2]:.2f}" if ratios else "-"
        counts = (sum(r[key] for r in strong) for key in ("place", "physics", "both"))
        lines.append(
            f"| {method} | {' | '.join(map(str, counts))} | {len(strong)} | "
            f"{sum(r['false_alarm'] for r in empty)} | {len(empty)} | {median} |"
        )
    return "\n".join(lines)
