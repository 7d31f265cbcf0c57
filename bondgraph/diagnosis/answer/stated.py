"""Stated values that the recordings contradict: a finding about a number, not a law.

A parameter that is known to within a standard deviation, and that the best model needs
far from there, says that the number is wrong or that something moves along with the
element that the model does not have. Both are told in the words of the element.
"""

import math
from collections.abc import Sequence

from bondgraph.diagnosis.answer.wording import listed, to_digits_of
from bondgraph.diagnosis.records import Finding
from bondgraph.fitting.natural_bounds import AT, gone_words
from bondgraph.fitting.result import Estimate
from bondgraph.structure.elements import (
    Compliance,
    Inertance,
    Node,
    OneJunction,
    OnePort,
    Resistance,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.nodes import parameters_of
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import parameters_in

FAR = 5.0
"""Standard deviations, stated and estimated together, beyond which a value is wrong."""

MANY, KNOWN = 3.0, 0.1
"""An element that does so many times what it does as stated does far more, where its
value is known to within this share of it.
"""


def contradicted(
    graph: FinishedGraph, estimates: Sequence[Estimate]
) -> tuple[Finding, ...]:
    """Return a finding for every stated value that the fit has left.

    Parameters
    ----------
    graph
        The user's model, with the values and standard deviations as stated.
    estimates
        Of the best model.
    """
    found = []
    for estimate in estimates:
        stated = graph.parameters.get(estimate.name)
        away = None if stated is None else estimate.away_from(stated)
        if stated is not None and away is not None and abs(away) > FAR:
            found.append(_finding(graph, estimate, stated, away))
    return tuple(found)


def at_bounds(graph: FinishedGraph, estimates: Sequence[Estimate]) -> tuple[str, ...]:
    """Return a sentence on the values that end at the bounds the model states."""
    ended = ended_at_bounds(graph, estimates)
    told = gone_words(graph, estimates)
    if not ended:
        return told
    return (
        *told,
        f"The fit ends at bounds that the model states: {listed(ended, 'and')}. Either "
        "they are too narrow, or these values stand in for something that is missing; "
        "what is said of the rest rests on them.",
    )


def ended_at_bounds(
    graph: FinishedGraph, estimates: Sequence[Estimate]
) -> tuple[str, ...]:
    """Return the values that end at bounds the model states, in words.

    A bound of zero is one of nature and not of knowledge; it does not count.
    """
    return tuple(
        f"{estimate.name} at {bound:.4g}{_unit_of(estimate)}"
        for estimate in estimates
        if estimate.name in graph.parameters
        for bound in graph.parameters[estimate.name].bounds
        if math.isfinite(bound) and bound != 0.0
        if math.isclose(estimate.value, bound, rel_tol=AT)
    )


def driven_away(
    graph: FinishedGraph, before: Sequence[Estimate], after: Sequence[Estimate]
) -> tuple[str, ...]:
    """Return a sentence on each element that does far more only with what was found.

    A law that takes back what it makes of a weight three times as large is no law but
    the first terms of a series. That an element does less beside a law is as it should
    be, and so is that a value comes back which had run away for want of one.

    Parameters
    ----------
    graph
        The user's model, with the values as stated.
    before, after
        What was fitted without what was found, and with it.
    """
    without = {one.name: one for one in before}
    told = []
    for one in after:
        first, parameter = without.get(one.name), graph.parameters.get(one.name)
        if first is None or parameter is None or not parameter.value:
            continue
        stated, unit = parameter.value, _unit_of(one)
        power = _does_more(graph, one.name)
        now, then = (_times(it.value / stated, power) for it in (one, first))
        if now > MANY > then > 1.0 / MANY and _is_known(one) and _is_known(first):
            told.append(
                f"With what was found {one.name} is {one.value:.4g}{unit}, without it "
                f"{first.value:.4g}{unit}, near the stated {stated:.4g}{unit}: what "
                "was found may do no more than take that back."
            )
    return tuple(told)


def _times(ratio: float, power: int) -> float:
    """Return how many times what it does as stated an element does."""
    return float(ratio**power) if ratio > 0.0 else 0.0


def _does_more(graph: FinishedGraph, parameter: str) -> int:
    """Return 1 where an element does more with more of it, -1 with less, else 0.

    At a common flow an effort is more, and with a stiffer spring; at a common effort a
    flow.
    """
    node = _node_with(graph, parameter)
    if not isinstance(node, OnePort):
        return 0
    (bond,) = graph.bonds_at(node.name)
    at_one = isinstance(graph.node(bond.other(node.name)), OneJunction)
    match node:
        case Compliance():
            return -1 if at_one else 1
        case Inertance() | Resistance():
            return 1 if at_one else -1
    return 1


def _node_with(graph: FinishedGraph, parameter: str) -> Node | None:
    return next((n for n in graph.nodes if parameter in parameters_of(n)), None)


def _is_known(estimate: Estimate) -> bool:
    return estimate.std is not None and estimate.std < KNOWN * abs(estimate.value)


def _unit_of(estimate: Estimate) -> str:
    return "" if estimate.unit == "1" else f" {estimate.unit}"


def _finding(
    graph: FinishedGraph, estimate: Estimate, stated: Parameter, away: float
) -> Finding:
    node = _node_with(graph, estimate.name)
    name = _reader(graph, estimate.name) if node is None else node.name
    unit = _unit_of(estimate)
    needed = f"{estimate.value:.4g}"
    if estimate.std is not None:
        needed = to_digits_of(estimate.value, estimate.std)
    return Finding(
        physics=_word(node, away > 0.0),
        place=name,
        element=name,
        statement=(
            f"{estimate.name} is not what it is said to be: the recordings need "
            f"{needed}{unit}, {abs(away):.0f} standard deviations "
            f"from the stated {stated.value:.4g} ± {stated.std:.2g}{unit}. That is a "
            "value and not a law: either the number is wrong, or something acts beside "
            f"{name} that does the same."
        ),
        law=f"{estimate.name} = {estimate.value:.6g}",
        indistinguishable_places=tuple(
            bond.other(name) for bond in graph.bonds_at(name)
        ),
        estimates=(estimate,),
        domain=next((domain.name for domain in graph.domains_at(name)), ""),
    )


def _reader(graph: FinishedGraph, parameter: str) -> str:
    """Return the sensor that reads with a parameter of its own."""
    return next(
        (
            m.name
            for m in graph.measurements
            if parameter in parameters_in(m.expression)
        ),
        parameter,
    )


def _word(node: Node | None, larger: bool) -> str:
    """Return what would do the same as the change of the value."""
    match node:
        case None:
            return "sensor_scale"
        case Inertance() if larger:
            return "added_inertia"
        case Compliance():
            return "added_compliance" if larger else "spring"
        case Resistance():
            return "viscous_friction"
    return "unknown_relation"
