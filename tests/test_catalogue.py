"""The catalogue: right answers, and the raw equations as a second route."""

from operator import attrgetter

import numpy as np
import pytest
import sympy
from catalogue import (
    CASES,
    FIELDS,
    Case,
    random_graph,
    random_nonlinear_graph,
    somewhere,
)
from catalogue.comparison import check_answers, compare_with_raw
from catalogue.evaluation import observed
from catalogue.raw_equations import Raw
from catalogue.refusals import REFUSALS, Refusal

from bondgraph import (
    BondGraph,
    C,
    CField,
    FinishedGraph,
    I,
    R,
    Se,
    derive,
    displacement,
    e,
    effort,
    q,
)
from bondgraph.errors import (
    BondGraphError,
    CausalConflictError,
    EquationError,
    StructureError,
)
from bondgraph.numeric.model import compile_model, evaluate
from bondgraph.structure.signals import t

every_case = pytest.mark.parametrize("case", CASES + FIELDS, ids=attrgetter("name"))


def test_there_are_many_cases_and_each_says_where_it_is_from() -> None:
    assert len(CASES) >= 70
    assert len({case.name for case in CASES}) == len(CASES)
    assert all(case.source for case in CASES)


@every_case
def test_every_case_has_an_answer(case: Case) -> None:
    assert case.rates or case.transfers or case.relations


@every_case
def test_answers_are_those_derived_by_hand(case: Case) -> None:
    check_answers(case)


# The independent route ------------------------------------------------------------


@every_case
def test_every_variable_is_that_of_the_raw_equations(case: Case) -> None:
    compare_with_raw(case.graph(), case.where)


@every_case
def test_the_compiled_model_gives_the_same_numbers(case: Case) -> None:
    seen = observed(case.graph(), case.where)
    equations = seen.equations
    model = compile_model(equations)
    variables = [s.symbol for s in equations.states]
    variables += [s.rate for s in equations.states]
    variables += [*equations.unknowns, *equations.inputs, *equations.input_rates]
    point = np.array([seen.at[x] for x in (*variables, *equations.parameters, t)])
    none = np.zeros((len(point), 0))
    values, _ = evaluate(model.dynamics, point, none)
    rates = [seen.at[s.rate] for s in equations.states]
    zeros = [0.0] * len(equations.unknowns)
    assert values == pytest.approx([*rates, *zeros], rel=1e-9, abs=1e-8)
    outputs, _ = evaluate(model.output, point, none)
    expected = [*seen.outputs.values()]
    assert outputs == pytest.approx(expected, rel=1e-9, abs=1e-9)


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


@pytest.mark.parametrize("first", range(0, 40, 10))
def test_random_nonlinear_graphs_are_solved_rightly_or_refused(first: int) -> None:
    seeds = range(first, first + 10)
    graphs = [random_nonlinear_graph(seed).finish() for seed in seeds]
    solved = [graph for graph in graphs if refused(graph) is None]
    assert len(solved) >= 5
    for graph in solved:
        compare_with_raw(graph)


# Refusals -------------------------------------------------------------------------


@pytest.mark.parametrize("case", REFUSALS, ids=attrgetter("name"))
def test_what_has_no_equations_is_refused_by_name(case: Refusal) -> None:
    def whole() -> None:
        graph = BondGraph(case.name)
        case.write(graph)
        derive(graph.finish())

    with pytest.raises(case.error) as caught:
        whole()
    assert all(name in str(caught.value) for name in case.names), caught.value
    assert caught.value.remedy


# Known gaps -----------------------------------------------------------------------


def test_a_dependent_store_may_read_its_own_displacement() -> None:
    graph = BondGraph("own")
    curved = q * (1 + displacement("store") ** 2)
    graph.zero("node", Se("u"), C("store", law=curved), R("r"))
    compare_with_raw(graph.finish())


def test_an_orifice_may_be_given_its_flow() -> None:
    # kv sign(e) sqrt|e| = f, so e = sign(f) (f/kv)²; the line's inertia sets f.
    graph = BondGraph("line and orifice")
    law = sympy.Symbol("kv") * sympy.sign(e) * sympy.sqrt(sympy.Abs(e))
    graph.one("line", Se("supply"), I("oil"), R("orifice", law=law))
    seen = observed(graph.finish())
    known = {symbol.name: value for symbol, value in seen.at.items()}
    through = known["p_oil"] / known["oil"]
    drop = (through / known["kv"]) ** 2
    assert seen.rates["p_oil"] == pytest.approx(known["supply"] - drop)


def test_a_port_of_a_field_may_be_measured() -> None:
    k = sympy.Symbol("k")
    graph = BondGraph("pair")
    graph.one("left", Se("u"), R("b"))
    graph.one("right", Se("w"), R("d"))
    pair = CField.from_stiffness("pair", [[k, 0], [0, k]])
    graph.put(pair, on=("left", "right"))
    graph.measure("pull", effort("pair[2]"))
    assert observed(graph.finish()).outputs["pull"] != 0.0
