"""Recovered laws on the page: the cloud, the law found, and the others judged there."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bondgraph.diagnosis.records import Finding, RecoveredLaw
from bondgraph.physics.names import name_of
from bondgraph.reporting.charts import Array, Chart, Curve, chart
from bondgraph.reporting.wording import number_words, unit_words

TABLE_ROWS = 9
FOUND = "the law found"
SMOOTH = 6  # times up and down through its range, and still a function


@dataclass(frozen=True, slots=True)
class LawPicture:
    """A recovered law: its chart, the key to it, and the same as numbers.

    Parameters
    ----------
    key
        CSS class and words of each line.
    rows
        Argument, law and other laws at some places of the range visited.
    later
        What was found afterwards and is not in the model that the points come from.
    """

    law: RecoveredLaw
    chart: Chart
    key: tuple[tuple[str, str], ...]
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    later: tuple[str, ...]

    @property
    def as_points(self) -> bool:
        """Whether the law found reads other variables too, and is shown as points."""
        return any(words == FOUND and css.endswith("dots") for css, words in self.key)


def law_picture(law: RecoveredLaw, findings: Sequence[Finding] = ()) -> LawPicture:
    """Return everything the page shows of a recovered law, one of `findings`."""
    drawn = [(FOUND, "after", law.curve_argument, law.curve_value)]
    drawn += [
        (f"{name_of(other.physics)} instead", f"rival{k}", other.argument, other.value)
        for k, other in enumerate(law.others)
    ]
    lines = [
        (words, css, *_sorted(x, y))
        for words, css, x, y in drawn
        if np.isfinite(y).any()
    ]
    cloud = Curve("recovered", "cloud", law.argument, law.value, dots=True)
    curves = [cloud] if law.argument.size else []
    key = [("cloud", "recovered from the recordings")] if curves else []
    # The law found is drawn last, over the others.
    for words, css, x, y in reversed(lines):
        dots = not _is_a_function(y)
        curves.append(Curve(words, f"{css} dots" if dots else css, x, y, dots))
    names = {curve.name: curve.css for curve in curves}
    return LawPicture(
        law=law,
        chart=_chart(law, curves),
        key=(*key, *((names[words], words) for words, *_ in lines)),
        headings=tuple(words for words, *_ in lines),
        rows=_rows(lines),
        later=_later(law, findings),
    )


def _later(law: RecoveredLaw, findings: Sequence[Finding]) -> tuple[str, ...]:
    places = [finding.place for finding in findings]
    if law.place not in places:
        return ()
    after = findings[places.index(law.place) + 1 :]
    return tuple(f"{one.name} at {one.place}" for one in after)


def _chart(law: RecoveredLaw, curves: list[Curve]) -> Chart:
    found = [curve.name for curve in curves if curve.name != "recovered"][::-1]
    told = f" and {', '.join(found)}." if found else "; no law was found."
    return chart(
        curves,
        title=f"{law.value_name} at {law.place}",
        description=f"{law.value_name} recovered at {law.place}, against "
        f"{law.argument_name}: {len(law.argument)} points{told}",
        x_label=f"{law.argument_name} [{unit_words(law.argument_unit)}]",
        y_label=f"{law.value_name} [{unit_words(law.value_unit)}]",
        frame=("recovered", FOUND),
    )


def _rows(lines: list[tuple[str, str, Array, Array]]) -> tuple[tuple[str, ...], ...]:
    """Return what the laws give at even distances; none where one is no function."""
    if not lines or not all(_is_a_function(y) for _, _, _, y in lines):
        return ()
    first = lines[0][2]
    return tuple(
        (
            number_words(float(at), 3),
            *(number_words(float(np.interp(at, x, y)), 3) for _, _, x, y in lines),
        )
        for at in np.linspace(first[0], first[-1], TABLE_ROWS)
    )


def _sorted(argument: Array, value: Array) -> tuple[Array, Array]:
    known = np.isfinite(argument) & np.isfinite(value)
    order = np.argsort(argument[known], kind="stable")
    return argument[known][order], value[known][order]


def _is_a_function(values: Array) -> bool:
    """Return whether a law is a function of the one argument it is shown against.

    One that also depends on a load jumps up and down from point to point, and is shown
    as points.
    """
    return float(np.abs(np.diff(values)).sum()) <= SMOOTH * float(np.ptp(values))
