"""Graphs and diagnoses as pictures in a notebook."""

from html import escape

from bondgraph.causality.assignment import assign_causality
from bondgraph.errors import CausalConflictError
from bondgraph.reporting.notebooks import diagnosis_html, graph_html
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.graph import FinishedGraph

__all__ = ["builder_html", "diagnosis_html", "finished_html"]


def finished_html(graph: FinishedGraph) -> str:
    """Return the picture; without strokes, and why, where causality conflicts."""
    try:
        assignment = assign_causality(graph)
    except CausalConflictError as conflict:
        return f"{graph_html(graph)}<p>{escape(str(conflict))}</p>"
    return graph_html(graph, assignment=assignment)


def builder_html(graph: BondGraph) -> str:
    """Return the picture of a graph as far as it is drawn."""
    return finished_html(graph.finish())
