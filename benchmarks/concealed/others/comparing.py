"""The other methods run on every case, held against the same truth as the tool."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.concealed.board import STRONG
from benchmarks.concealed.others.base import FittedBase, fitted_base
from benchmarks.concealed.others.methods import (
    every_term_by_aic,
    gaussian_process,
    sindy,
)
from benchmarks.concealed.others.said import Said
from benchmarks.concealed.others.stepwise import stepwise_by_bic
from benchmarks.concealed.scoring import Outcome, match, score_case
from benchmarks.concealed.shares import quantile, wilson

METHODS: dict[str, Callable[[FittedBase], Said]] = {
    "stepwise, true laws, BIC": stepwise_by_bic,
    "every term, AIC": every_term_by_aic,
    "Gaussian process": gaussian_process,
    "SINDy discrepancy": sindy,
}
TOOL = "bondgraph diagnose"

Row = dict[str, Any]


def compare(
    public: Path, sealed: Path, names: tuple[str, ...], kept: Path
) -> list[Row]:
    """Return one row per case and method; cases are those with a truth.

    Rows are kept in the file `kept` after every method, and another run goes on there.
    """
    rows: list[Row] = json.loads(kept.read_text("utf-8")) if kept.exists() else []
    done = {(row["case"], row["method"]) for row in rows}
    for case in sorted(path.parent for path in public.glob("*/case.json")):
        truth_file = sealed / f"{case.name}.json"
        wanted = not names or any(name in case.name for name in names)
        missing = [method for method in METHODS if (case.name, method) not in done]
        if not missing or not wanted or not truth_file.exists():
            continue
        truth = json.loads(truth_file.read_text("utf-8"))
        base = fitted_base(case)
        for method in missing:
            rows.append(_row(truth, method, METHODS[method](base)))
            print(rows[-1], flush=True)
            kept.write_text(json.dumps(rows, indent=1), "utf-8")
    return rows


def of_the_tool(answers: Path, sealed: Path, cases: set[str]) -> list[Row]:
    """Return the same rows for answers of the tool to the same cases.

    As with the others, only what it says first counts here; its place is the class
    that it calls indistinguishable.
    """
    rows = []
    for name in sorted(cases):
        if not (answers / f"{name}.json").exists():
            continue
        truth = json.loads((sealed / f"{name}.json").read_text("utf-8"))
        answer = json.loads((answers / f"{name}.json").read_text("utf-8"))
        first = [{**one, "alternatives": []} for one in answer["findings"][:1]]
        effects = [e for e in truth["effects"] if not e["silent"]]
        matches = [match(one, e) for one in first for e in effects]
        before, after = (
            answer["fit"]["held_out"][when]["nrmse"] for when in ("before", "after")
        )
        alarm = score_case(truth, answer, 0.0).outcome is Outcome.FALSE_ALARM
        rows.append(
            {
                **_of_truth(truth, TOOL),
                "said": f"{first[0]['physics']} at {first[0]['place']}"
                if first
                else None,
                "place": any(m.place for m in matches),
                "physics": any(m.physics for m in matches),
                "both": any(m.first for m in matches),
                "false_alarm": alarm,
                "held_out_before": before,
                "held_out_after": after,
            }
        )
    return rows


def _of_truth(truth: Mapping[str, Any], method: str) -> Row:
    return {
        "case": truth["case"],
        "method": method,
        "strength": truth["effect_over_noise"],
        "empty": all(e["silent"] for e in truth["effects"]),
        "outside": any(e["outside"] for e in truth["effects"]),
        "concealed": [f"{e['law']} at {e['place']}" for e in truth["effects"]],
    }


def _row(truth: Mapping[str, Any], method: str, said: Said) -> Row:
    """Hold what a method says against the effects; one of two is enough here."""
    place = physics = both = False
    for effect in truth["effects"]:
        for one in effect["accepted"]:
            at = said.finding is not None and said.finding[1] in one["places"]
            is_it = said.finding is not None and said.finding[0] in one["words"]
            place, physics, both = place or at, physics or is_it, both or (at and is_it)
    known = _of_truth(truth, method)
    empty = known["empty"]
    return {
        **known,
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


def table(rows: Sequence[Row]) -> str:
    """Return the comparison as Markdown, each share with its 95 % interval.

    Effects outside of the library have no name that a method could say; they and weak
    ones are left out. The last columns are of held-out errors, after over before.
    """
    lines = [
        "| method | effects | located | named | both | empty | false alarms | held-out "
        "error, median | worse on held-out data |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for method in (TOOL, *METHODS):
        own = [row for row in rows if row["method"] == method]
        if not own:
            continue
        empty = [r for r in own if r["empty"]]
        strong = [
            r
            for r in own
            if not r["empty"] and not r["outside"] and r["strength"] >= STRONG
        ]
        ratios = [r["held_out_after"] / r["held_out_before"] for r in strong]
        middle = quantile(ratios, 0.5)
        cells = (
            method,
            str(len(strong)),
            *(_share([r[key] for r in strong]) for key in ("place", "physics", "both")),
            str(len(empty)),
            _share([r["false_alarm"] for r in empty]),
            "-" if middle is None else f"{100 * middle:.0f} %",
            _share([ratio > 1.02 for ratio in ratios]),
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _share(held: Sequence[bool]) -> str:
    low, high = wilson(sum(held), len(held))
    return f"{sum(held)} ({100 * low:.0f} to {100 * high:.0f} %)"
