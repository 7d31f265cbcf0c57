"""Graphs and diagnoses as pictures in a notebook, after ``%load_ext bondgraph``.

The records know nothing of pictures, which are made on a higher floor; so a notebook is
told here how to show them.
"""

from html import escape
from typing import Any

from bondgraph.causality.assignment import assign_causality
from bondgraph.diagnosis.records import Diagnosis
from bondgraph.errors import CausalConflictError
from bondgraph.reporting.notebooks import diagnosis_html, graph_html
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.graph import FinishedGraph


def load_ipython_extension(shell: Any) -> None:
    """Let a notebook show graphs and diagnoses; ``%load_ext bondgraph`` calls this.

    Parameters
    ----------
    shell
        The IPython shell.
    """
    html = shell.display_formatter.formatters["text/html"]
    html.for_type(FinishedGraph, _graph)
    html.for_type(BondGraph, lambda graph: _graph(graph.finish()))
    html.for_type(Diagnosis, diagnosis_html)


def _graph(graph: FinishedGraph) -> str:
    """Return the picture; without strokes, and why, where causality conflicts."""
    try:
        assignment = assign_causality(graph)
    except CausalConflictError as conflict:
        return f"{graph_html(graph)}<p>{escape(str(conflict))}</p>"
    return graph_html(graph, assignment=assignment)
