"""All chapters put together, and the audit as text and as a page."""

from functools import cache

from bondgraph import Change, Reconciliation
from flegx_models.audit import (
    assumptions,
    chapter2,
    chapter3,
    chapter4,
    control,
    gravity,
    jump,
    loops,
    slips,
)
from flegx_models.audit.records import Audit, Row, Verdict


@cache
def audit() -> Audit:
    """Return the audit, computed afresh once."""
    found = (
        *chapter2.rows(),
        *chapter3.rows(),
        *chapter4.rows(),
        *control.rows(),
        *gravity.rows(),
        *loops.rows(),
    )
    return Audit(
        rows=tuple(sorted(found, key=lambda row: row.chapter)),
        questions=(
            *chapter4.questions(),
            *control.questions(),
            *gravity.questions(),
        ),
        remarks=(
            *chapter3.remarks(),
            *chapter4.remarks(),
            *assumptions.remarks(),
            *gravity.remarks(),
            *loops.remarks(),
            *control.remarks(),
            *jump.remarks(),
            *slips.remarks(),
        ),
    )


_HEAD = ("where", "quantity", "printed", "derived", "off", "corrected", "verdict")


def as_text(found: Audit) -> str:
    """Return the rows as an aligned table, with causes below each."""
    cells = [_HEAD, *map(_cells, found.rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(_HEAD))]
    lines = []
    for number, row in enumerate(cells):
        padded = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        lines.append("  ".join(padded).rstrip())
        cause = found.rows[number - 1].cause if number else ""
        if cause:
            lines.append(f"    {cause}")
    lines += ["", _counts(found), ""]
    for question in found.questions:
        lines += [question.title, question.comment, str(question.answer), ""]
    lines += [f"{remark.where}: {remark.statement}" for remark in found.remarks]
    return "\n".join(lines)


def as_markdown(found: Audit) -> str:
    """Return the audit as the page docs/flegx_audit.md."""
    lines = [
        "# The audit of the FlegX thesis",
        "",
        "Written by `python -m flegx_models.audit --markdown docs/flegx_audit.md`; a "
        "test says that it is up to date. Every printed result that can be computed "
        "again stands beside what the thesis's own numbers give, in the unit shown. A "
        "result is *reproduced* where the interval that its data's rounding allows "
        "meets its own. *Corrected* is the value with the correction, "
        "or the slip, that the last column names.",
        "",
        f"**{_counts(found)}**",
    ]
    for chapter in sorted({row.chapter for row in found.rows}):
        lines += ["", f"## Chapter {chapter}", "", *_table(found, chapter)]
    lines += ["", "## Which numbers would have to change", "", _HOW]
    for question in found.questions:
        lines += ["", f"### {question.title}", "", question.comment, ""]
        lines += _answer(question.answer)
    lines += ["", "## Beside the results", ""]
    lines += [f"- *{r.where}*: {r.statement}" for r in found.remarks]
    return "\n".join(lines) + "\n"


_HOW = (
    "Each group of results is put to [`reconcile`](reconciliation.md): which smallest "
    "sets of numbers must leave their rounding interval for all results of the group "
    "to come out within theirs? Every set of the smallest number of members is listed, "
    "by the sum of |ln(new / printed)|; bold where the size cannot tell them apart."
)


def _table(found: Audit, chapter: int) -> list[str]:
    lines = [
        "| where | quantity | unit | printed | derived | off | corrected | verdict |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for row in found.rows:
        if row.chapter == chapter:
            where, quantity, printed, derived, off, corrected, verdict = _cells(row)
            quantity = quantity.removesuffix(f" [{row.unit}]")
            cause = f": {row.cause}" if row.cause else ""
            cells = (where, quantity, row.unit, printed, derived, off, corrected)
            lines.append(f"| {' | '.join(cells)} | {verdict}{cause} |")
    return lines


def _answer(answer: Reconciliation) -> list[str]:
    lines = [answer.status.value, ""]
    for explanation in answer.explanations:
        mark = "**" if explanation in answer.equally_good else ""
        inferred = [
            f"{name} = {value:.4g}"
            for name, value in explanation.values.items()
            if name in ("L", "k_scaling")
        ]
        rest = f", then {', '.join(inferred)}" if inferred else ""
        changes = ", ".join(map(_change, explanation.changes))
        lines.append(f"- {mark}{changes}{mark}{rest} (size {explanation.size:.3g})")
        if mark:
            lines += [
                f"  - {c.name} between {c.low:.4g} and {c.high:.4g}"
                for c in explanation.changes
            ]
    return lines


def _change(change: Change) -> str:
    # The smallest size is found to one part in a thousand: four digits, not more.
    share = 100 * (change.factor - 1)
    return f"{change.name} {change.printed:.4g} → {change.value:.4g} ({share:+.3g} %)"


def _counts(found: Audit) -> str:
    parts = [f"{found.count(verdict)} {verdict}" for verdict in Verdict]
    return f"{len(found.rows)} results: {', '.join(parts)}."


def _cells(row: Row) -> tuple[str, ...]:
    off = row.relative_difference
    return (
        row.where,
        f"{row.quantity} [{row.unit}]",
        _digits(row.printed),
        "" if row.derived is None else _digits(row.derived),
        "" if off is None else _percent(off),
        "" if row.corrected is None else _digits(row.corrected),
        str(row.verdict),
    )


def _percent(share: float) -> str:
    # The last bit of an exact agreement must not decide between +0 and -0.
    return f"{round(100 * share, 2) + 0.0:+.2f} %"


def _digits(value: float) -> str:
    return f"{value:.5g}"
