"""Answers as tables for a terminal.

Every table is returned as text, so that nothing here prints; colour is a choice of the
caller, and the same words carry the meaning without it. Cells are plain text: a unit
in brackets or a hostile name is never read as markup.
"""

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from io import StringIO
from typing import TextIO

from bondgraph.diagnosis.records import Evidence, Support
from bondgraph.fitting.result import Estimate
from bondgraph.recordings.recording import Recording
from bondgraph.reporting.wording import (
    NOTHING,
    blind_words,
    interval_words,
    number_words,
    percent,
    sentence_start,
    unit_words,
    with_deviation,
)
from bondgraph.structure.parameters import (
    Assumed,
    Fitted,
    Measured,
    Parameter,
    ParameterSet,
    Provenance,
    Published,
    Reconciled,
)

_STYLES = {
    Support.SUPPORTED: "green",
    Support.UNDECIDED: "yellow",
    Support.REFUTED: "dim",
}
HEADING_LINES = 2
INTERVAL = "95 % interval"
"""The heading of a column that is left out where lines are too short for it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckRow:
    """One check to show: what was declared, with which tolerance, and derived."""

    name: str
    declared: str
    derived: str
    tolerance: str
    ok: bool


@dataclass(frozen=True, slots=True)
class Cell:
    """Text with a style that adds nothing to its meaning."""

    text: str
    style: str = ""


@dataclass(frozen=True, slots=True)
class Column:
    """A heading; numbers are set flush right."""

    heading: str
    numeric: bool = False


def wants_colour(stream: TextIO) -> bool:
    """Return whether text written to `stream` should be coloured.

    A terminal is, unless ``NO_COLOR`` is set or the terminal calls itself dumb.
    """
    refused = bool(os.environ.get("NO_COLOR")) or os.environ.get("TERM") == "dumb"
    return stream.isatty() and not refused


def parameters_table(
    parameters: ParameterSet, *, colour: bool = False, width: int | None = None
) -> str:
    """Return the parameters of a model: value, what is known, and its source."""
    columns = (
        Column("parameter"),
        Column("value", numeric=True),
        Column("unit"),
        Column("source"),
    )
    rows = [
        (
            Cell(p.name),
            Cell(_value(p)),
            Cell(_unit(p.unit)),
            Cell(_source(p.source), "dim"),
        )
        for p in parameters.members
    ]
    return text_table(columns, rows, colour=colour, width=width)


def estimates_table(
    estimates: Iterable[Estimate], *, colour: bool = False, width: int | None = None
) -> str:
    """Return fitted parameters: where the fit started, and where it ended.

    The 95 % interval has a column where it is known and no line must be broken for it.
    """
    columns = (
        Column("parameter"),
        Column("start", numeric=True),
        Column("estimate", numeric=True),
        Column("unit"),
    )
    rows, intervals = [], []
    for one in estimates:
        blind = one.std is None
        value = Cell(with_deviation(one.value, one.std))
        if blind:
            value = Cell(blind_words(one.value, one.start), "yellow")
        start = Cell(number_words(one.start), "dim")
        rows.append((Cell(one.name), start, value, Cell(_unit(one.unit))))
        intervals.append(Cell(_interval(one.interval)))
    if any(cell.text != NOTHING for cell in intervals):
        wider = (*columns[:3], Column(INTERVAL), columns[3])
        longer = [
            (*row[:3], interval, row[3])
            for row, interval in zip(rows, intervals, strict=True)
        ]
        table = text_table(wider, longer, colour=colour, width=width)
        if len(table.splitlines()) <= len(rows) + HEADING_LINES:
            return table
    return text_table(columns, rows, colour=colour, width=width)


def _interval(interval: tuple[float, float] | None) -> str:
    if interval is None:
        return NOTHING
    return interval_words(*interval)


def candidates_table(
    candidates: Iterable[Evidence], *, colour: bool = False, width: int | None = None
) -> str:
    """Return what a diagnosis considered, with its evidence, in the given order."""
    listed = tuple(candidates)
    shown = any(one.held_out_nrmse is not None for one in listed)
    columns = (
        Column("physics"),
        Column("at"),
        Column("support"),
        Column("gain", numeric=True),
        *((Column("held-out error", numeric=True),) if shown else ()),
        Column("why"),
    )
    rows = [
        (
            Cell(sentence_start(one.name)),
            Cell(one.place),
            Cell(one.support.value, _STYLES[one.support]),
            Cell(f"{with_deviation(100 * one.gain, 100 * one.gain_std)} %"),
            *((Cell(percent(one.held_out_nrmse)),) if shown else ()),
            Cell(one.reason, "dim"),
        )
        for one in listed
    ]
    return text_table(columns, rows, colour=colour, width=width)


def checks_table(
    checks: Iterable[CheckRow], *, colour: bool = False, width: int | None = None
) -> str:
    """Return checks, each with the words ``ok`` or ``OFF``."""
    columns = (
        Column(""),
        Column("check"),
        Column("declared", numeric=True),
        Column("tolerance"),
        Column("derived", numeric=True),
    )
    rows = [
        (
            Cell("ok", "green") if one.ok else Cell("OFF", "bold red"),
            Cell(one.name),
            Cell(one.declared),
            Cell(one.tolerance, "dim"),
            Cell(one.derived, "" if one.ok else "bold red"),
        )
        for one in checks
    ]
    return text_table(columns, rows, colour=colour, width=width)


def recordings_table(
    recordings: Iterable[Recording], *, colour: bool = False, width: int | None = None
) -> str:
    """Return recordings: how long, how fast, and what is in them."""
    columns = (
        Column("recording"),
        Column("samples", numeric=True),
        Column("duration", numeric=True),
        Column("step", numeric=True),
        Column("channels"),
    )
    rows = [
        (
            Cell(one.name),
            Cell(str(len(one.time))),
            Cell(NOTHING if one.steady else f"{number_words(one.duration)} s"),
            Cell(NOTHING if one.steady else f"{number_words(one.step, 3)} s"),
            Cell(", ".join(f"{c.name} [{_unit(c.unit)}]" for c in one.channels)),
        )
        for one in recordings
    ]
    return text_table(columns, rows, colour=colour, width=width)


def text_table(
    columns: Sequence[Column],
    rows: Iterable[Sequence[Cell]],
    *,
    colour: bool,
    width: int | None,
) -> str:
    """Return a table of plain cells under headings."""
    from rich import box  # noqa: PLC0415  (0.1 s, and only terminals need it)
    from rich.console import Console  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for column in columns:
        table.add_column(
            Text(column.heading), justify="right" if column.numeric else "left"
        )
    for row in rows:
        table.add_row(*(Text(cell.text, style=cell.style) for cell in row))
    console = Console(
        file=StringIO(),
        width=width,
        force_terminal=colour,
        color_system="standard" if colour else None,
        legacy_windows=False,
    )
    with console.capture() as captured:
        console.print(table)
    return "\n".join(line.rstrip() for line in captured.get().splitlines()) + "\n"


def _value(parameter: Parameter) -> str:
    if parameter.value is None:
        return NOTHING
    if parameter.exact:
        return f"{number_words(parameter.value, 6)} (exact)"
    return with_deviation(parameter.value, parameter.std)


def _unit(unit: str) -> str:
    return NOTHING if unit in {"", "1"} else unit_words(unit)


def _source(source: Provenance) -> str:
    match source:
        case Assumed(reason):
            return f"assumed: {reason}" if reason else "assumed"
        case Measured(recording, method):
            return ", ".join(part for part in ("measured", recording, method) if part)
        case Published(reference):
            return f"published: {reference}"
        case Fitted(recordings):
            return f"fitted: {', '.join(recordings)}" if recordings else "fitted"
        case Reconciled(reason):
            return f"reconciled: {reason}"
