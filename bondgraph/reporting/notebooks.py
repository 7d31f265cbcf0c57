"""What a notebook shows for a graph or a diagnosis: HTML that stands by itself.

A notebook calls ``_repr_html_`` of an object; the functions here make that text.
Styles of a picture begin with ``.bondgraph`` and those of an answer with
``.bondgraph-answer``, so that a cell never restyles the notebook around it.
"""

from collections.abc import Mapping
from html import escape

from bondgraph.causality.records import CausalAssignment
from bondgraph.diagnosis.records import Diagnosis
from bondgraph.reporting.drawing import draw_svg
from bondgraph.reporting.report import diagnosis_picture
from bondgraph.reporting.wording import (
    headline,
    percent,
    sentence_start,
    with_deviation,
)
from bondgraph.structure.graph import FinishedGraph

_STYLE = """<style>
.bondgraph-answer{font:14px/1.5 system-ui,sans-serif;max-width:900px}
.bondgraph-answer td,.bondgraph-answer th{text-align:left;padding:2px 14px 2px 0}
.bondgraph-scroll{overflow-x:auto}
</style>"""
# What scrolls is reached by the keyboard.
_SCROLLED = '<div class="bondgraph-scroll" tabindex="0">{}</div>'


def graph_html(
    graph: FinishedGraph,
    *,
    assignment: CausalAssignment | Mapping[str, str] | None = None,
) -> str:
    """Return the picture of a graph for a notebook, with its signals; see `draw_svg`.

    Parameters
    ----------
    graph
        The graph.
    assignment
        The causality to show, if any.
    """
    picture = draw_svg(graph, assignment=assignment, signals=True)
    return f"{_STYLE}{_SCROLLED.format(picture)}"


def diagnosis_html(diagnosis: Diagnosis) -> str:
    """Return a diagnosis in short: verdict, picture, candidates and what to do next."""
    rows = "".join(
        f"<tr><th>{escape(sentence_start(one.name))} at "
        f"{escape(one.place)}</th><td>{escape(one.support.value)}</td>"
        f"<td>{escape(with_deviation(100 * one.gain, 100 * one.gain_std))} %</td></tr>"
        for one in diagnosis.candidates
    )
    table = (
        "<table><thead><tr><th>Considered</th><th>Support</th><th>Gain on left-out "
        f"blocks</th></tr></thead><tbody>{rows}</tbody></table>"
        if rows
        else ""
    )
    errors = (
        f"Error on held-out recordings: before "
        f"{percent(diagnosis.held_out.before.nrmse)}, after "
        f"{percent(diagnosis.held_out.after.nrmse)} of the signal."
    )
    next_step = (
        f"<p><b>Next experiment:</b> {escape(diagnosis.next_experiment)}</p>"
        if diagnosis.next_experiment
        else ""
    )
    return (
        f'{_STYLE}<div class="bondgraph-answer"><h3>{headline(diagnosis)}</h3>'
        f"<p>{escape(diagnosis.statement)}</p><p>{errors}</p>"
        f"{_SCROLLED.format(diagnosis_picture(diagnosis))}{table}{next_step}</div>"
    )
