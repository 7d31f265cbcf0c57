"""What is said where no causality is right, and in which order choices are made."""

import pytest
import sympy

from bondgraph import (
    GY,
    TF,
    BondGraph,
    C,
    CausalPreference,
    I,
    IField,
    R,
    RField,
    Se,
    Sf,
    Wanted,
    assign_causality,
    e,
    f,
    p,
    q,
)
from bondgraph.errors import CausalConflictError
from bondgraph.fitting.estimate import prepare

a, b = sympy.symbols("a b", real=True)
FREE_ONE = "Change or free one of the elements named here."


def refused(graph: BondGraph) -> CausalConflictError:
    with pytest.raises(CausalConflictError) as caught:
        assign_causality(graph.finish())
    return caught.value


def test_a_transformer_between_two_efforts() -> None:
    graph = BondGraph("clash")
    graph.zero("left", Se("a"))
    graph.zero("right", Se("b"))
    graph.join("left", TF("n"), "right")
    error = refused(graph)
    assert error.problem == (
        "TF 'n' gets effort from both sides, 'left' and 'right'. This follows from: "
        "Se 'a' imposes its effort; Se 'b' imposes its effort; 0-junction 'left' has "
        "its effort from 'a'; 0-junction 'right' has its effort from 'b'."
    )
    assert error.about == ("n", "left", "right", "a", "b")
    assert error.remedy == FREE_ONE


def test_a_transformer_between_two_flows() -> None:
    graph = BondGraph("clash")
    graph.one("left", Sf("a"))
    graph.one("right", Sf("b"))
    graph.join("left", TF("n"), "right")
    error = refused(graph)
    assert error.problem.startswith("TF 'n' gets flow from both sides, 'left' and ")


def test_a_gyrator_between_effort_and_flow() -> None:
    graph = BondGraph("clash")
    graph.zero("left", Se("a"))
    graph.one("right", Sf("b"))
    graph.join("left", GY("r"), "right")
    error = refused(graph)
    assert error.problem.startswith(
        "GY 'r' gets effort from one side and flow from the other, 'left' and 'right'."
    )
    assert error.about == ("r", "left", "right", "a", "b")
    assert error.remedy == FREE_ONE


@pytest.mark.parametrize("kind", ["effort", "flow"])
def test_a_gyrator_turns_effort_into_flow(kind: str) -> None:
    graph = BondGraph("motor")
    graph.one("left", Se("u") if kind == "effort" else Sf("u"), R("r"))
    graph.one("right", I("j"))
    graph.join("left", GY("k"), "right")
    causality = assign_causality(graph.finish())
    (step,) = (s for s in causality.steps if s.reason == "GY 'k' passes causality on")
    # The inertia gives the right its flow, so the gyrator gives the left its effort:
    # it receives effort on neither side, or else on both.
    assert causality.integral == ("j",)
    strokes = [causality.stroke_of(name) for name in ("left>k", "k>right")]
    assert [stroke.at for stroke in strokes] == ["left", "right"]
    assert [stroke.away for stroke in strokes] == ["k", "k"]
    assert step.stroke in strokes


def test_a_source_at_the_wrong_junction() -> None:
    graph = BondGraph("clash")
    graph.one("j", Se("a"))
    error = refused(graph)
    assert error.problem == (
        "Se 'a' imposes effort where 'j' imposes it already. This follows from: only "
        "'a' is left to give 1-junction 'j' its flow."
    )
    assert error.remedy.startswith("Remove one of them")
    graph = BondGraph("clash")
    graph.zero("j", Sf("a"))
    assert refused(graph).problem.startswith("Sf 'a' imposes flow where 'j' imposes it")


def test_two_ways_in_are_told_with_what_parts_them() -> None:
    graph = BondGraph("clash")
    graph.zero("left", Se("a"))
    graph.zero("right", Se("b"))
    graph.join("left", "right")
    error = refused(graph)
    assert error.problem.startswith(
        "0-junction 'right' gets its effort 2 times, from 'b' and 'left'. This follows"
    )
    assert error.remedy == (
        "Remove all but one of them, or part them by a 1-junction with an I or R."
    )
    assert error.about == ("right", "b", "left", "a")


def test_nothing_gives_an_effort() -> None:
    graph = BondGraph("idle")
    graph.zero("j", Sf("a"), Sf("b"))
    error = refused(graph)
    assert error.problem == (
        "Nothing gives 0-junction 'j' its effort. This follows from: Sf 'a' imposes "
        "its flow; Sf 'b' imposes its flow."
    )
    assert error.about == ("j", "a", "b")
    assert error.remedy == "Put a source, a storage or an R on 'j'."


def flows_at_both_ends(junctions: int) -> BondGraph:
    """Return a chain of transformers that two sources of flow fight over."""
    graph = BondGraph("clash")
    for i in range(junctions):
        graph.one(f"j{i}")
    for i in range(junctions - 1):
        graph.join(f"j{i}", TF(f"n{i}"), f"j{i + 1}")
    graph.put(Sf("a"), on="j0")
    graph.put(Sf("b"), on=f"j{junctions - 1}")
    return graph


def reasons_of(graph: BondGraph) -> list[str]:
    return refused(graph).problem.split("This follows from: ")[1].split("; ")


def test_of_a_long_chain_the_ends_are_told() -> None:
    reasons = reasons_of(flows_at_both_ends(8))
    assert len(reasons) == 13
    assert reasons[6] == "…"
    assert reasons[:2] == ["Sf 'a' imposes its flow", "Sf 'b' imposes its flow"]
    assert reasons[-1] == "1-junction 'j4' has its flow from 'n4'."
    # Twelve reasons and no more are told in full.
    reasons = reasons_of(flows_at_both_ends(6))
    assert len(reasons) == 12
    assert "…" not in reasons


# Order of choices -----------------------------------------------------------------


LAWS = {
    "never": a * p**5 + p,
    "seldom": b * (sympy.exp(a * p) - 1),
    "linear": p / a,
    "given": a * f**3 + f,
}


@pytest.mark.parametrize("first", LAWS)
@pytest.mark.parametrize("second", LAWS)
def test_the_inertia_that_is_hardest_to_invert_is_integral(first, second) -> None:
    order = ["never", "seldom", "linear", "given"]
    if first == second or {first, second} == {"linear", "given"}:
        expected = "one"  # as easy: the author's order
    else:
        expected = "one" if order.index(first) < order.index(second) else "two"
    graph = BondGraph("rigid")
    graph.one("shaft", Se("u"), I("one", law=LAWS[first]), I("two", law=LAWS[second]))
    assert assign_causality(graph.finish()).integral == (expected,)


def test_the_same_holds_of_compliances_with_and_without_a_law() -> None:
    graph = BondGraph("parallel")
    graph.zero("node", Sf("u"), C("plain"), C("bent", law=a * q**5 + q))
    assert assign_causality(graph.finish()).integral == ("bent",)
    graph = BondGraph("parallel")
    graph.zero("node", Sf("u"), C("plain"), C("given", law=a * e**3 + e))
    assert assign_causality(graph.finish()).integral == ("plain",)


RESISTANCES = {
    "level": b * sympy.tanh(a * f),  # of an effort beyond b there is no flow
    "rising": a * f**5 + f,  # solved for the flow by iteration only
    "linear": a * f,
    "plain": None,
}


@pytest.mark.parametrize("first", RESISTANCES)
@pytest.mark.parametrize("second", RESISTANCES)
def test_resistances_that_work_one_way_only_choose_first(first, second) -> None:
    order = list(RESISTANCES)
    chosen = "one" if order.index(first) <= order.index(second) else "two"
    graph = BondGraph("loop")
    ports = [
        R(name, law=RESISTANCES[kind])
        for name, kind in (("one", first), ("two", second))
    ]
    graph.one("loop", Se("u"), *ports)
    causality = assign_causality(graph.finish())
    assert causality.arbitrary == (chosen,)
    # It keeps the direction that its law is written in: it gives effort.
    assert causality.stroke_of(f"loop>{chosen}").at == "loop"


def test_a_resistance_written_for_its_flow_gives_flow() -> None:
    graph = BondGraph("loop")
    graph.one("loop", Se("u"), R("r1"), R("r2", law=a * e**5 + e))
    causality = assign_causality(graph.finish())
    assert causality.arbitrary == ("r2",)
    assert causality.stroke_of("loop>r2").at == "r2"


def ring() -> BondGraph:
    """Return a ring in which the R can give flow only, which nothing but it shows."""
    graph = BondGraph("ring")
    graph.one("left", C("c1"), C("c2"))
    graph.zero("middle", R("r"), I("m"))
    graph.one("right", C("c3"))
    graph.join("left", "middle")
    graph.join("left", "right")
    graph.join("left", GY("g"), "right")
    return graph


def test_what_was_turned_by_a_conflict_is_no_free_choice() -> None:
    causality = assign_causality(ring().finish())
    assert causality.arbitrary == ()
    (reason,) = (s.reason for s in causality.steps if s.node.name == "r")
    assert reason == "R 'r' gives flow, because otherwise there was a conflict"


@pytest.mark.parametrize("wanted", Wanted)
def test_wishes_for_storages(wanted: Wanted) -> None:
    graph = BondGraph("rigid")
    graph.one("shaft", Se("u"), I("one"), I("two"))
    wish = (CausalPreference("two", wanted),)
    causality = assign_causality(graph.finish(), prefer=wish)
    # An inertia is integral where it gives flow.
    integral = wanted in (Wanted.INTEGRAL, Wanted.GIVES_FLOW)
    assert causality.integral == (("two",) if integral else ("one",))
    assert causality.unmet == ()
    told = [s.reason for s in causality.steps if s.reason.endswith("prefers")]
    gives = "flow" if integral else "effort"
    assert told == [f"I 'two' gives {gives}, as its author prefers"]


def test_a_wish_in_the_call_goes_before_the_one_in_the_graph() -> None:
    graph = BondGraph("rigid")
    graph.one("shaft", Se("u"), I("one"), I("two"))
    graph.prefer("one", "integral")
    finished = graph.finish()
    assert assign_causality(finished).integral == ("one",)
    wishes = (
        CausalPreference("one", Wanted.DERIVATIVE),
        CausalPreference("two", Wanted.INTEGRAL),
    )
    assert assign_causality(finished, prefer=wishes).integral == ("two",)


def test_a_wish_that_led_to_a_conflict_is_unmet_and_says_so() -> None:
    graph = ring()
    graph.prefer("r", "effort")
    causality = assign_causality(graph.finish())
    assert causality.unmet == ("r",)
    assert [s.reason for s in causality.steps if s.node.name == "r"] == [
        "R 'r' gives flow against the author's wish, which led to a conflict"
    ]


def test_a_dependent_storage_that_was_turned_says_so() -> None:
    # Both inertias of a rigid ring: the second would be integral until the ring closes.
    graph = BondGraph("ring")
    graph.one("left", C("c1"), C("c2"))
    graph.zero("middle", C("c"), I("m"))
    graph.one("right", C("c3"))
    graph.join("left", "middle")
    graph.join("left", "right")
    graph.join("left", GY("g"), "right")
    causality = assign_causality(graph.finish())
    told = {s.node.name: s.reason for s in causality.steps}
    assert causality.derivative == ("c3",)
    assert told["c3"] == "C 'c3' is derivative, because integral led to a conflict"


# Fields ---------------------------------------------------------------------------


def field_graph(field, *others) -> BondGraph:
    graph = BondGraph("field")
    graph.one("first", Se("u"), *others)
    graph.one("second", R("r"))
    graph.put(field, on=("first", "second"))
    return graph


def test_the_ports_of_a_linear_field_yield_to_a_bent_storage_and_no_other() -> None:
    linear = IField.from_matrix("m", [[2, 1], [1, 3]])
    bent = I("bent", law=a * p**5 + p)
    causality = assign_causality(field_graph(linear, bent).finish())
    assert (causality.integral, causality.derivative) == (("bent", "m[2]"), ("m[1]",))
    plain = assign_causality(field_graph(linear, I("plain")).finish())
    assert plain.derivative in (("plain",), ("m[1]",))
    assert len(plain.integral) == 2


def test_the_ports_of_a_resistive_field_are_chosen_with_their_names() -> None:
    field = RField.from_matrix("w", [[2, 1], [1, 3]])
    causality = assign_causality(field_graph(field, R("s")).finish())
    assert set(causality.arbitrary) <= {"s", "r", "w[1]", "w[2]"}
    assert causality.arbitrary


@pytest.mark.parametrize("order", [1, -1])
def test_beside_a_limit_the_law_that_rises_is_solved(order) -> None:
    limit = b * (f - sympy.Max(-a, sympy.Min(f, a)))
    ports = [R("tube", law=a * f + b * f * sympy.Abs(f)), R("limit", law=limit)]
    graph = BondGraph("lung")
    graph.one("airway", Se("push"), *ports[::order], C("lung"))
    for name in "ab":
        graph.parameter(name, 1.0, bounds=(0, 10))
    graph.parameter("lung", 1.0, "m/N")
    graph.measure("flow", flow="airway")
    assert assign_causality(graph.finish()).arbitrary == ("limit",)
    assert prepare(graph.finish()).n_states == 1  # It has equations.
