"""Causality: strokes that satisfy every element, reasons, and refusals in words."""

from operator import attrgetter

import pytest
from catalogue import CASES, Case

from bondgraph import GY, TF, BondGraph, C, I, R, Se, Sf, assign_causality, f
from bondgraph.causality.assignment import _decide
from bondgraph.causality.choices import choices
from bondgraph.causality.propagation import StrokeBoard
from bondgraph.causality.records import Rule
from bondgraph.errors import CausalConflictError
from bondgraph.structure.elements import letter

every_case = pytest.mark.parametrize("case", CASES, ids=attrgetter("name"))

ALLOWED = {
    "Se": lambda received, ports: received == 0,
    "Sf": lambda received, ports: received == 1,
    "0": lambda received, ports: received == 1,
    "1": lambda received, ports: received == ports - 1,
    "TF": lambda received, ports: received == 1,
    "GY": lambda received, ports: received in (0, 2),
    "I": lambda received, ports: True,
    "C": lambda received, ports: True,
    "R": lambda received, ports: True,
}


@every_case
def test_every_node_receives_as_many_efforts_as_its_kind_allows(case: Case) -> None:
    graph = case.graph()
    causality = assign_causality(graph)
    for node in graph.nodes:
        strokes = [s for s in causality.strokes if s.bond in graph.bonds_at(node.name)]
        received = sum(s.at == node.name for s in strokes)
        assert ALLOWED[letter(node)](received, len(strokes)), node


@every_case
def test_integral_and_derivative_storages_are_those_known(case: Case) -> None:
    graph = case.graph()
    causality = assign_causality(graph)
    assert causality.derivative == case.derivative
    storages = {n.name for n in graph.nodes if letter(n) in "IC"}
    assert {*causality.integral, *causality.derivative} == storages


@every_case
def test_every_stroke_has_a_reason(case: Case) -> None:
    graph = case.graph()
    causality = assign_causality(graph)
    assert len(causality.steps) == len(graph.bonds)
    assert all(step.reason for step in causality.steps)


def test_reasons_tell_the_story_of_two_masses_on_one_shaft() -> None:
    graph = BondGraph("masses")
    graph.one("shaft", Se("force"), I("m1"), I("m2"))
    steps = assign_causality(graph.finish()).steps
    assert [step.reason for step in steps] == [
        "Se 'force' imposes its effort",
        "I 'm1' is integral, as preferred",
        "1-junction 'shaft' has its flow from 'm1'",
    ]
    assert [step.stroke.at for step in steps] == ["shaft", "m1", "shaft"]


def test_a_law_that_works_one_way_only_gets_that_way() -> None:
    graph = BondGraph("loop")
    graph.one("loop", Se("u"), R("linear"), R("cubic", law=f**3 * 2 + f))
    causality = assign_causality(graph.finish())
    assert causality.arbitrary == ("cubic",)
    assert causality.stroke_of("loop>cubic").at == "loop"


def ladder(stages: int) -> BondGraph:
    graph = BondGraph("ladder")
    graph.one("m0", Se("force"), I("mass0"), R("b0"))
    for k in range(1, stages):
        graph.one(f"m{k}", I(f"mass{k}"), R(f"b{k}"))
        graph.zero(f"s{k}", C(f"spring{k}"))
        graph.join(f"m{k - 1}", f"s{k}")
        graph.join(f"s{k}", f"m{k}")
    return graph


def visits(stages: int) -> tuple[int, int]:
    graph = ladder(stages).finish()
    board = StrokeBoard(graph)
    board.start(0)
    board.propagate()
    _decide(board, choices(board, ()))
    return board.visits, len(graph.bonds)


def test_work_grows_linearly_with_bonds() -> None:
    small, few = visits(10)
    large, many = visits(80)
    assert large / many == pytest.approx(small / few, rel=0.1)
    assert large <= 3 * many


def test_a_conflict_names_no_bond_whose_stroke_was_taken_back() -> None:
    graph = BondGraph("three resistances")
    graph.zero("node", R("a"), R("b"), R("c"))
    board = StrokeBoard(graph.finish())
    node = next(i for i, one in enumerate(board.nodes) if one.name == "node")
    first, second, third = board.at[node]
    board.set(first, node, Rule.CHOICE, node)
    board.undo(0)
    for bond in (second, third):  # Two efforts cannot both be the node's.
        board.set(bond, node, Rule.CHOICE, node)
    found = board.propagate()
    assert found is not None
    assert (found.node, found.bonds) == (node, (second, third))


def conflict(graph: BondGraph) -> CausalConflictError:
    with pytest.raises(CausalConflictError) as caught:
        assign_causality(graph.finish())
    return caught.value


def test_two_flow_sources_on_one_flow() -> None:
    graph = BondGraph("clash")
    graph.one("shaft", Sf("a"), Sf("b"), I("m"))
    error = conflict(graph)
    assert error.problem.startswith(
        "1-junction 'shaft' gets its flow 2 times, from 'a' and 'b'."
    )
    assert {"shaft", "a", "b"} <= set(error.about)
    assert "0-junction" in error.remedy


def test_two_efforts_on_one_effort() -> None:
    graph = BondGraph("clash")
    graph.zero("node", Se("a"), Se("b"))
    error = conflict(graph)
    assert "0-junction 'node' gets its effort 2 times, from 'a' and 'b'" in str(error)


def test_a_conflict_across_transformers_tells_the_chain() -> None:
    graph = BondGraph("clash")
    graph.one("left", Sf("a"), I("m"))
    graph.one("middle")
    graph.one("right", Sf("b"), R("r"))
    graph.join("left", TF("n1"), "middle")
    graph.join("middle", TF("n2"), "right")
    text = str(conflict(graph))
    for word in (
        "Sf 'a' imposes its flow",
        "Sf 'b' imposes its flow",
        "1-junction 'left' has its flow from 'a'",
        "TF 'n1' passes causality on",
        "TF 'n2' passes causality on",
    ):
        assert word in text


def test_a_gyrator_between_effort_and_flow() -> None:
    graph = BondGraph("clash")
    graph.zero("left", Se("a"))
    graph.one("right", Sf("b"))
    graph.join("left", GY("r"), "right")
    text = str(conflict(graph))
    assert "'r'" in text
    assert "Se 'a' imposes its effort" in text
    assert "Sf 'b' imposes its flow" in text


def test_a_flow_that_nothing_gives() -> None:
    graph = BondGraph("idle")
    graph.one("shaft", Se("a"), Se("b"))
    error = conflict(graph)
    assert error.problem.startswith("Nothing gives 1-junction 'shaft' its flow.")
    assert "'shaft'" in error.remedy


def test_a_choice_that_leads_to_a_conflict_is_taken_back() -> None:
    # In this ring the first choice, made bond by bond, cannot be completed.
    graph = BondGraph("ring")
    graph.zero("a", R("r1"))
    graph.one("b", R("r2"))
    graph.zero("c", R("r3"))
    graph.one("d", R("r4"))
    for tail, head in (("a", "b"), ("b", "c"), ("c", "d"), ("d", "a")):
        graph.join(tail, head)
    finished = graph.finish()
    strokes = assign_causality(finished).strokes
    for node in finished.junctions:
        at = [s for s in strokes if s.bond in finished.bonds_at(node.name)]
        received = sum(s.at == node.name for s in at)
        assert ALLOWED[letter(node)](received, len(at))
