"""The catalogue: right answers, and the raw equations as a second route."""

from operator import attrgetter

import numpy as np
import pytest
import sympy
from catalogue import CASES, Case, agree, expression, random_graph, somewhere
from catalogue.evaluation import Observed, number, observed
from catalogue.raw_equations import Raw

from bondgraph import FinishedGraph, assign_causality, derive, linearise
from bondgraph.errors import (
    BondGraphError,
    CausalConflictError,
    EquationError,
    StructureError,
)
from bondgraph.structure.graph import Measurement

every_case = pytest.mark.parametrize("case", CASES, ids=attrgetter("name"))


def test_there_are_many_cases_and_each_says_where_it_is_from() -> None:
    assert len(CASES) >= 70
    assert len({case.name for case in CASES}) == len(CASES)
    assert all(case.source for case in CASES)


@every_case
def test_every_case_has_an_answer(case: Case) -> None:
    assert case.rates or case.transfers or case.relations


@pytest.mark.parametrize(
    "case", [c for c in CASES if c.relations], ids=attrgetter("name")
)
def test_relations_derived_by_hand_hold(case: Case) -> None:
    seen = observed(case.graph())
    known = {symbol.name: value for symbol, value in seen.at.items()} | seen.outputs
    for text in case.relations:
        relation = expression(text)
        put = {x: known[x.name] for x in relation.free_symbols}
        assert number(relation, put) == pytest.approx(0.0, abs=1e-8), text


@pytest.mark.parametrize("case", [c for c in CASES if c.active], ids=attrgetter("name"))
def test_transfer_functions_of_active_graphs(case: Case) -> None:
    system = linearise(derive(case.graph()))
    for (output, source), text in case.transfers.items():
        found = system.transfer_function(output, source)
        assert agree(found.expression, expression(text)), found


# The independent route ------------------------------------------------------------


def compare_with_raw(graph: FinishedGraph) -> None:
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
    seen = observed(probed)
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


@every_case
def test_every_variable_is_that_of_the_raw_equations(case: Case) -> None:
    compare_with_raw(case.graph())


# Random graphs --------------------------------------------------------------------


def refused(graph: FinishedGraph) -> BondGraphError | None:
    """Return the refusal of a graph, or None where it has equations."""
    try:
        derive(graph)
    except (CausalConflictError, EquationError) as refusal:
        return refusal
    return None


def check_random(seed: int) -> str:
    """Compare a random graph with its raw equations; return how it ended."""
    try:
        graph = random_graph(seed).finish()
    except StructureError:
        return "not a graph"  # a junction without a bond
    raw = Raw(graph)
    put = somewhere({sympy.Symbol(name, real=True) for name in graph.parameters})
    refusal = refused(graph)
    assert (refusal is None) == raw.is_regular(put), refusal
    if refusal is not None:
        assert refusal.about
        return "refused"
    compare_with_raw(graph)
    return "solved"


@pytest.mark.parametrize("first", range(0, 200, 20))
def test_random_graphs_are_solved_rightly_or_refused(first: int) -> None:
    ends = [check_random(seed) for seed in range(first, first + 20)]
    assert ends.count("solved") >= 2
