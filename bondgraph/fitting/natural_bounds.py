"""Natural bounds: what a store holds and a loss takes keeps the sign that is stated.

A mass, a capacity or a resistance below zero gives power without end, and fits what a
model leaves out better than any true value would: a fit that may go there explains
nothing, and no law helps from there. Bounds that the author states come before these.
"""

import math
from collections.abc import Iterable, Iterator

from bondgraph.fitting.certainty.combinations import listed
from bondgraph.fitting.result import Estimate
from bondgraph.structure.elements import Compliance, Inertance, Resistance
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.nodes import is_linear

LEAST = 1e-3
"""Of the stated value: a linear store of nothing has no equations."""

AT = 1e-6
"""Within this share of a bound a value is at it."""


def bounds_by_name(graph: FinishedGraph) -> dict[str, tuple[float, float]]:
    """Return the least and largest value of every parameter of `graph`.

    As stated; where nothing is stated of the parameter of a linear I, C or R, values of
    the other sign than its own are left out, and zero with them.
    """
    bounds = {one.name: one.bounds for one in graph.parameters.values()}
    for name in _natural(graph):
        value = graph.parameters[name].value
        if value:
            least = LEAST * value
            bounds[name] = (least, math.inf) if value > 0.0 else (-math.inf, least)
    return bounds


def gone(graph: FinishedGraph, estimates: Iterable[Estimate]) -> list[str]:
    """Return the names of estimates that have come down to their natural bound.

    Parameters
    ----------
    graph
        The model that was fitted.
    """
    natural = set(_natural(graph))
    return [
        one.name
        for one in estimates
        if one.name in natural and one.start
        if math.isclose(one.value, LEAST * one.start, rel_tol=AT)
    ]


def gone_words(graph: FinishedGraph, estimates: Iterable[Estimate]) -> tuple[str, ...]:
    """Return one sentence on the estimates that have come down so; none if none has."""
    lost = gone(graph, estimates)
    if not lost:
        return ()
    verb, them = ("has", "it") if len(lost) == 1 else ("have", "them")
    return (
        f"{listed(lost)} {verb} come down to a thousandth of what is stated and would "
        f"go below zero: these recordings give {them} no value, or something that is "
        "missing takes the place.",
    )


def _natural(graph: FinishedGraph) -> Iterator[str]:
    """Yield the parameters of linear I, C and R of which no bound is stated."""
    for node in graph.elements:
        if not isinstance(node, Inertance | Compliance | Resistance):
            continue
        if not is_linear(node):
            continue
        if not any(map(math.isfinite, graph.parameters[node.name].bounds)):
            yield node.name
