"""Curves without a name in a terminal: a few points, and where they lie."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.records import Diagnosis, RecoveredLaw
from bondgraph.reporting.tables import Cell, Column, text_table
from bondgraph.reporting.wording import number_words, unit_words

POINTS = 11
WIDTH = 25
"""Characters of the picture beside the numbers."""

CURVE = "unknown_relation"


def curve_tables(
    diagnosis: Diagnosis, *, colour: bool = False, width: int | None = None
) -> Iterator[str]:
    """Yield for every finding without a name its curve over the range visited."""
    places = {one.place for one in diagnosis.findings if one.physics == CURVE}
    for law in diagnosis.recovered:
        if law.place in places and law.curve_argument.size > 1:
            beside = "beside what fitted elements take in proportion"
            yield f"The curve at {law.place}, {beside}"
            yield _curve_table(law, colour, width)


def _curve_table(law: RecoveredLaw, colour: bool, width: int | None) -> str:
    order = np.argsort(law.curve_argument)
    x = np.linspace(law.curve_argument.min(), law.curve_argument.max(), POINTS)
    y = np.interp(x, law.curve_argument[order], law.curve_value[order])
    columns = (
        Column(f"{law.argument_name} [{unit_words(law.argument_unit)}]", numeric=True),
        Column(f"{law.value_name} [{unit_words(law.value_unit)}]", numeric=True),
        Column(""),
    )
    rows = [
        (Cell(number_words(at, 3)), Cell(number_words(value, 3)), Cell(dot, "dim"))
        for at, value, dot in zip(x, y, _dots(y), strict=True)
    ]
    return text_table(columns, rows, colour=colour, width=width)


def _dots(y: NDArray[np.float64]) -> Iterator[str]:
    """Yield a line for each value: where it lies between the least and the largest."""
    low, high = min(float(y.min()), 0.0), max(float(y.max()), 0.0)
    span = (high - low) or 1.0
    zero = round((0.0 - low) / span * (WIDTH - 1))
    for value in y:
        line = [" "] * WIDTH
        line[zero] = "│"
        line[round((value - low) / span * (WIDTH - 1))] = "●"
        yield "".join(line).rstrip()
