"""Causality, parameters and fits as tables in a notebook."""

from collections.abc import Iterable, Sequence
from dataclasses import fields
from html import escape

from bondgraph.causality.records import CausalAssignment
from bondgraph.fitting.result import Estimate, FitResult
from bondgraph.reporting.wording import (
    NOTHING,
    blind_words,
    number_words,
    relative_error,
    unit_words,
    with_deviation,
)
from bondgraph.structure.parameters import ParameterSet, Provenance

LISTED = 40
"""Strokes that are shown; a large graph says how many there are."""


def causality_html(assignment: CausalAssignment) -> str:
    """Return who is integral, and every stroke with its reason."""
    kinds = (
        ("integral", assignment.integral),
        ("derivative (dependent)", assignment.derivative),
        ("chosen freely", assignment.arbitrary),
        ("against the author's wish", assignment.unmet),
    )
    summary = "".join(
        f"<p><b>{kind}:</b> {escape(', '.join(names))}</p>"
        for kind, names in kinds
        if names
    )
    steps = assignment.steps[:LISTED]
    rows = [(s.stroke.bond.name, s.stroke.at, s.reason) for s in steps]
    more = len(assignment.steps) - len(steps)
    rest = f"<p>and {more} more strokes</p>" if more else ""
    return summary + table(("bond", "effort into", "because"), rows) + rest


def parameters_html(parameters: ParameterSet) -> str:
    """Return the parameters of a model: value, unit, bounds, source."""
    head = ("parameter", "value", "unit", "bounds", "source")
    rows = [
        (
            one.name,
            NOTHING if one.value is None else with_deviation(one.value, one.std),
            unit_words(one.unit),
            " to ".join(number_words(end) for end in one.bounds),
            _source(one.source),
        )
        for one in parameters.members
    ]
    return table(head, rows, numbers=(1,))


def _source(source: Provenance) -> str:
    """Return how a value is known, in the words of the author."""
    said = [str(getattr(source, field.name)) for field in fields(source)]
    return ", ".join(filter(None, (type(source).__name__.lower(), *said)))


def fit_html(result: FitResult) -> str:
    """Return how a fit ended, its estimates, and what it cannot know."""
    score = f"Error: {escape(relative_error(result.score, 'the measured spread'))}."
    cannot = "".join(
        f"<p>Not identifiable from these recordings: {escape(sentence)}.</p>"
        for sentence in result.unidentifiable
    ) + "".join(f"<p>Hardly {escape(one)}.</p>" for one in result.barely_known)
    head = ("parameter", "start", "estimate", "95 % interval", "unit")
    listed = table(head, map(_estimate, result.estimates), numbers=(1, 2, 3))
    return f"<p><b>{escape(result.status.value)}</b> {score}</p>{listed}{cannot}"


def _estimate(one: Estimate) -> tuple[str, ...]:
    ended = (
        blind_words(one.value, one.start)
        if one.std is None
        else with_deviation(one.value, one.std)
    )
    interval = (
        NOTHING
        if one.interval is None
        else " to ".join(number_words(end) for end in one.interval)
    )
    return (
        one.name,
        number_words(one.start),
        ended,
        interval,
        unit_words(one.unit),
    )


def table(
    head: Sequence[str], rows: Iterable[Sequence[str]], *, numbers: Sequence[int] = ()
) -> str:
    """Return an HTML table; columns of `numbers` are set flush right."""

    def side(column: int) -> str:
        return "right" if column in numbers else "left"

    heads = "".join(
        f'<th scope="col" style="text-align:{side(i)}">{escape(text)}</th>'
        for i, text in enumerate(head)
    )
    body = "".join(
        "<tr>"
        + "".join(
            f'<td style="text-align:{side(i)}">{escape(text)}</td>'
            for i, text in enumerate(row)
        )
        + "</tr>"
        for row in rows
    )
    return f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>"
