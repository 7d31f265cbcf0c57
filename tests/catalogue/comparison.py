"""A case against its answers, and a graph against its raw equations."""

from collections.abc import Mapping

import numpy as np
import pytest

from bondgraph import FinishedGraph, assign_causality, derive, linearise
from bondgraph.equations.reduction import reduce
from bondgraph.structure.graph import Measurement
from catalogue.cases import Case, agree, expression
from catalogue.evaluation import Observed, number, observed
from catalogue.raw_equations import Raw


def check_answers(case: Case) -> None:
    """Compare the states, rates, transfer functions and relations with the case's."""
    graph = case.graph()
    equations = derive(graph)
    assert {s.symbol.name for s in equations.states} == set(case.states)
    assert assign_causality(graph).derivative == case.derivative
    if case.rates:
        rates = reduce(equations).explicit()
        for state, rate in zip(equations.states, rates, strict=True):
            assert agree(rate, expression(case.rates[state.symbol.name])), state
    if case.transfers:
        system = linearise(equations)
        for (output, source), text in case.transfers.items():
            found = system.transfer_function(output, source)
            assert agree(found.expression, expression(text)), found
    if case.relations:
        seen = observed(graph, case.where)
        known = {symbol.name: value for symbol, value in seen.at.items()} | seen.outputs
        for text in case.relations:
            relation = expression(text)
            put = {x: known[x.name] for x in relation.free_symbols}
            assert number(relation, put) == pytest.approx(0.0, abs=1e-8), text


def compare_with_raw(
    graph: FinishedGraph, where: Mapping[str, float] | None = None
) -> None:
    """Compare every effort, flow and dependent store with the raw equations."""
    raw = Raw(graph)
    probes = [Measurement(n, signal, "1") for n, signal in raw.integrated.items()]
    probed = FinishedGraph(
        name=graph.name,
        nodes=graph.nodes,
        bonds=graph.bonds,
        domains=graph.domains,
        measurements=(*graph.measurements, *probes),
        parameters=graph.parameters,
        preferences=graph.preferences,
    )
    seen = observed(probed, where)
    free = [n for n in raw.stored if n in assign_causality(probed).derivative]
    ours = [seen.signal("effort", b.name) for b in graph.bonds]
    ours += [seen.signal("flow", b.name) for b in graph.bonds]
    ours += [_stored(seen, n) for n in free]
    put = dict(seen.at) | {
        raw.stored[n]: seen.outputs[n] if n in raw.integrated else _stored(seen, n)
        for n in raw.stored
        if n not in free
    }
    disturbed = np.array(ours) * (1 + 0.03 * np.cos(np.arange(len(ours))))
    theirs, alone = raw.solve(free, put, disturbed)
    assert alone, "the raw equations leave something open"
    assert np.array(ours) == pytest.approx(theirs, rel=1e-6, abs=1e-8)


def _stored(seen: Observed, label: str) -> float:
    for quantity in ("momentum", "displacement"):
        if (quantity, label) in seen.equations.signals:
            return seen.signal(quantity, label)
    raise AssertionError(f"{label} stores nothing")
