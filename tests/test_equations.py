"""State equations: right answers, laws of every graph, and refusals."""

import random
from dataclasses import replace
from operator import attrgetter

import numpy as np
import pytest
import sympy
from catalogue import CASES, Case, agree, expression, somewhere

from bondgraph import (
    TF,
    BondGraph,
    C,
    FinishedGraph,
    I,
    R,
    Se,
    Sf,
    derive,
    displacement,
    e,
    effort,
    f,
    q,
)
from bondgraph.equations.reduction import reduce
from bondgraph.equations.rendering import as_latex, as_text
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError
from bondgraph.structure.elements import Gyrator, OneJunction, Transformer, ZeroJunction
from bondgraph.structure.graph import Bond, is_one_port
from bondgraph.structure.signals import t

every_case = pytest.mark.parametrize("case", CASES, ids=attrgetter("name"))


@every_case
def test_states_are_those_known(case: Case) -> None:
    equations = derive(case.graph())
    assert {s.symbol.name for s in equations.states} == set(case.states)
    loops = [r for r in equations.reasons if r.startswith("algebraic loop")]
    assert len(loops) == case.loops


@pytest.mark.parametrize("case", [c for c in CASES if c.rates], ids=attrgetter("name"))
def test_rates_are_those_derived_by_hand(case: Case) -> None:
    equations = derive(case.graph())
    rates = reduce(equations).explicit()
    for state, rate in zip(equations.states, rates, strict=True):
        assert agree(rate, expression(case.rates[state.symbol.name])), state


@every_case
def test_nothing_leaks_into_the_reduced_form(case: Case) -> None:
    equations = derive(case.graph())
    reduced = reduce(equations)
    known = {t, *equations.inputs, *equations.input_rates, *equations.parameters}
    known |= {s.symbol for s in equations.states} | set(reduced.unknowns)
    for force in (*reduced.explicit(), *reduced.mass):
        assert force.free_symbols <= known


@every_case
def test_assignments_that_read_rates_come_last(case: Case) -> None:
    equations = derive(case.graph())
    early, late = equations.around_rates()
    rates = {s.rate for s in equations.states}
    assert early + late == equations.assignments
    assert all(rates.isdisjoint(a.expression.free_symbols) for a in early)
    later = {a.symbol for a in late}
    for rate in equations.rates:
        assert later.isdisjoint(rate.free_symbols)


# Numbers for a law: the record evaluated in its own order -------------------------


def evaluated(
    equations: StateEquations, put: dict[sympy.Symbol, float]
) -> dict[sympy.Symbol, float]:
    """Return the value of every symbol, the unknowns found by Newton's method."""

    def walk(z: np.ndarray) -> tuple[dict[sympy.Symbol, float], np.ndarray]:
        at = {**put, **dict(zip(equations.unknowns, map(float, z), strict=True))}
        early, late = equations.around_rates()
        for a in early:
            at[a.symbol] = float(a.expression.xreplace(at))
        for state, rate in zip(equations.states, equations.rates, strict=True):
            at[state.rate] = float(rate.xreplace(at))
        for a in (*late, *equations.further):
            at[a.symbol] = float(a.expression.xreplace(at))
        left = [float(r.xreplace(at)) for r in equations.residuals]
        return at, np.array(left)

    start = np.zeros(len(equations.unknowns))
    if not len(start):
        return walk(start)[0]
    z = start + 0.1
    for _ in range(50):
        at, left = walk(z)
        if np.max(np.abs(left)) < 1e-12:
            return at
        steps = 1e-6 * np.eye(len(z))
        slopes = [(walk(z + h)[1] - walk(z - h)[1]) / 2e-6 for h in steps]
        z = z - np.linalg.solve(np.array(slopes).T, left)
    assert np.max(np.abs(left)) < 1e-10
    return at


def some_values(equations: StateEquations) -> dict[sympy.Symbol, float]:
    independent = {t, *equations.inputs, *equations.input_rates, *equations.parameters}
    independent |= {s.symbol for s in equations.states}
    return somewhere(independent)


@every_case
def test_junctions_and_two_ports_conserve_power(case: Case) -> None:
    graph = case.graph()
    equations = derive(graph)
    at = evaluated(equations, some_values(equations))
    powers = {}
    for bond in graph.bonds:
        power = equations.signal("effort", bond.name) * equations.signal(
            "flow", bond.name
        )
        powers[bond.name] = float(power.xreplace(at))
    for node in graph.nodes:
        if isinstance(node, ZeroJunction | OneJunction | Transformer | Gyrator):
            into = [
                powers[b.name] * (1 if b.head == node.name else -1)
                for b in graph.bonds_at(node.name)
            ]
            assert sum(into) == pytest.approx(0.0, abs=1e-9), node


@every_case
def test_one_ports_obey_their_laws(case: Case) -> None:
    graph = case.graph()
    equations = derive(graph)
    at = evaluated(equations, some_values(equations))
    for node in graph.nodes:
        if isinstance(node, R):
            own = {
                e: equations.signal("effort", node.name),
                f: equations.signal("flow", node.name),
            }
            law = node.relation.output - node.relation.expression
            residual = law.xreplace(own)
            for signal in [s for s in residual.free_symbols if hasattr(s, "place")]:
                value = equations.signal(signal.quantity, signal.place)
                residual = residual.xreplace({signal: value})
            assert float(residual.xreplace(at)) == pytest.approx(0.0, abs=1e-9), node


# Invariances ----------------------------------------------------------------------


def rates_by_state(graph: FinishedGraph) -> dict[str, float]:
    equations = derive(graph)
    at = evaluated(equations, some_values(equations))
    rates = {s.symbol.name: at[s.rate] for s in equations.states}
    outputs = {o.name: float(o.expression.xreplace(at)) for o in equations.outputs}
    return rates | outputs


def turned(graph: FinishedGraph, name: str) -> FinishedGraph:
    bonds = tuple(
        Bond(b.head, b.tail) if name in (b.head, b.tail) else b for b in graph.bonds
    )
    return replace(graph, bonds=bonds)


@every_case
def test_turning_the_arrow_of_a_one_port_changes_nothing_it_sees(case: Case) -> None:
    graph = case.graph()
    expected = rates_by_state(graph)
    for node in graph.nodes:
        if is_one_port(node):
            found = rates_by_state(turned(graph, node.name))
            assert found == pytest.approx(expected, rel=1e-9), node


def test_turning_an_arrow_changes_the_sign_of_the_bond_only() -> None:
    graph = next(c for c in CASES if c.name == "rc").graph()
    straight, reversed_ = derive(graph), derive(turned(graph, "r"))
    assert reversed_.signal("flow", "r>loop") == straight.signal("flow", "loop>r")
    (ours,), (theirs,) = (reduce(x).explicit() for x in (straight, reversed_))
    assert agree(ours, theirs)
    a, b = (evaluated(x, some_values(x)) for x in (straight, reversed_))
    one = float(straight.signal("effort", "loop>r").xreplace(a))
    other = float(reversed_.signal("effort", "r>loop").xreplace(b))
    assert one == pytest.approx(-other)
    assert one != 0


@every_case
def test_the_order_of_bonds_and_nodes_does_not_matter(case: Case) -> None:
    graph = case.graph()
    shuffle = random.Random(case.name)
    order = list(range(len(graph.bonds)))
    shuffle.shuffle(order)
    junctions = list(graph.junctions)
    shuffle.shuffle(junctions)
    mixed = replace(
        graph,
        nodes=(*graph.elements, *junctions),
        bonds=tuple(graph.bonds[i] for i in order),
        domains=tuple(graph.domains[i] for i in order),
    )
    assert rates_by_state(mixed) == pytest.approx(rates_by_state(graph), rel=1e-9)


@every_case
def test_deriving_twice_gives_the_same_record(case: Case) -> None:
    assert derive(case.graph()) == derive(case.graph())


# Signals --------------------------------------------------------------------------


def test_a_spring_provides_the_displacement_of_its_junction() -> None:
    graph = BondGraph("sprung", domain="translation")
    graph.one("mass", Se("force"), I("m"), C("c"))
    graph.measure("x", displacement="mass")
    equations = derive(graph.finish())
    assert [s.symbol.name for s in equations.states] == ["p_m", "q_c"]
    assert [s.unit for s in equations.states] == ["N*s", "m"]
    assert equations.outputs[0].expression == equations.states[1].symbol


def test_a_signal_that_does_not_exist_is_refused_with_the_closest() -> None:
    equations = derive(next(c for c in CASES if c.name == "rc").graph())
    with pytest.raises(EquationError, match=r"no flow at 'lop'.*Did you mean loop"):
        equations.signal("flow", "lop")


def test_an_unneeded_dependent_effort_asks_for_no_input_rate() -> None:
    graph = BondGraph("moved")
    graph.one("mass", Sf("v"), I("m"), R("b"))
    graph.measure("drag", effort="b")
    equations = derive(graph.finish())
    assert equations.unknowns == ()
    (rate,) = equations.input_rates
    mass = sympy.Symbol("m", real=True)
    assert [a.expression for a in equations.further if a.symbol.name == "e_m"] == [
        mass * rate
    ]


def test_a_law_without_a_formula_in_the_needed_direction_stays_implicit() -> None:
    a, b = sympy.symbols("a b")
    graph = BondGraph("cubic")
    graph.zero("node", C("c"), R("r", law=a * f + b * f**3))
    graph.parameter("a", 1.0)
    graph.parameter("b", 2.0)
    equations = derive(graph.finish())
    assert len(equations.unknowns) == 1
    at = evaluated(equations, dict.fromkeys(_leaves(equations), 0.7))
    drop = float(equations.signal("effort", "r").xreplace(at))
    through = float(equations.signal("flow", "r").xreplace(at))
    assert drop == pytest.approx(0.7 * through + 0.7 * through**3)


@pytest.mark.parametrize("law", [sympy.tanh, sympy.sinh, sympy.atan])
def test_a_saturating_law_written_backwards_is_solved(law: object) -> None:
    graph = BondGraph("choke")
    graph.one("loop", Se("u"), R("r"), I("coil", law=sympy.Symbol("k") * law(f)))
    equations = derive(graph.finish())
    put = dict.fromkeys(_leaves(equations), 0.6) | {sympy.Symbol("k", real=True): 1.5}
    at = evaluated(equations, put)
    current = float(equations.signal("flow", "coil").xreplace(at))
    assert 1.5 * float(law(current)) == pytest.approx(0.6)
    implicit = "0 = " in as_text(equations).split("reduced")[1]
    assert implicit == (law is not sympy.tanh)  # whose inverse is a logarithm


def test_a_storage_law_without_an_inverse_is_refused_by_name() -> None:
    graph = BondGraph("choke")
    graph.one("loop", Se("u"), R("r"), I("coil", law=sympy.Symbol("k") * f**2))
    with pytest.raises(EquationError, match=r"I 'coil' gives p, but here f is wanted"):
        derive(graph.finish())


def _leaves(equations: StateEquations) -> set[sympy.Symbol]:
    return {*equations.inputs, *equations.parameters} | {
        s.symbol for s in equations.states
    }


def test_a_storage_behind_a_loop_gets_the_rate_of_the_loop() -> None:
    # Hand: both R see the node; f_m = (u r2 - ...)... the C is set by the divider:
    # q = c v, v = u r2/(r1 + r2), so the current is c du/dt r2/(r1 + r2).
    graph = BondGraph("held")
    graph.one("loop", Se("u"), R("r1"), R("r2"))
    graph.zero("copy", Se("held", value=effort("r2")), C("c"))
    graph.measure("i", flow="c")
    equations = derive(graph.finish())
    reduced = reduce(equations)
    c, r1, r2 = sympy.symbols("c r1 r2", real=True)
    (rate,) = equations.input_rates
    assert agree(reduced.outputs[0].expression, c * rate * r2 / (r1 + r2))


# Refusals -------------------------------------------------------------------------


def test_friction_that_has_no_inverse_is_refused_by_name() -> None:
    graph = BondGraph("slider")
    graph.zero("node", C("c"), R("slip", law=sympy.Symbol("tau") * sympy.sign(f)))
    with pytest.raises(EquationError) as caught:
        derive(graph.finish())
    assert "R 'slip'" in caught.value.problem
    assert caught.value.about == ("slip",)
    assert "Write the law as an expression in e" in caught.value.remedy


def test_an_input_and_a_parameter_of_one_name_are_refused() -> None:
    graph = BondGraph("twice")
    graph.one("m", Se("u"), R("r", law=sympy.Symbol("u") * f))
    with pytest.raises(EquationError, match="both an input and a parameter"):
        derive(graph.finish())


def test_a_ring_that_only_passes_an_effort_round_is_refused() -> None:
    graph = BondGraph("ring")
    for name in "abc":
        graph.zero(name * 2)
    for tail, head in (("aa", "bb"), ("bb", "cc"), ("cc", "aa")):
        graph.join(tail, head)
    with pytest.raises(EquationError, match="Nothing in 'ring' determines 'e_aa'"):
        derive(graph.finish())


def side_by_side(one: sympy.Symbol, other: sympy.Symbol) -> FinishedGraph:
    graph = BondGraph("double")
    graph.one("left", Se("u"), I("m"))
    graph.one("right", R("b"))
    graph.join("left", TF("first", law=one), "right")
    graph.join("left", TF("second", law=other), "right")
    graph.measure("speed", flow="right")
    return graph.finish()


def test_two_ratios_side_by_side_lock_the_shafts() -> None:
    n1, n2 = sympy.symbols("n1 n2")
    equations = derive(side_by_side(n1, n2))
    assert equations.states == ()
    at = evaluated(equations, some_values(equations))
    assert float(equations.outputs[0].expression.xreplace(at)) == pytest.approx(0.0)


def test_a_constraint_given_twice_is_refused() -> None:
    n = sympy.Symbol("n")
    with pytest.raises(EquationError, match="given twice") as caught:
        derive(side_by_side(n, n))
    assert "'double' does not determine" in caught.value.problem


def test_a_storage_that_follows_a_rate_of_a_dependent_one_is_refused() -> None:
    graph = BondGraph("third order")
    graph.one("moved", Sf("v"), I("m"))
    graph.zero("copy", Se("held", value=effort("m")), C("c"))
    graph.measure("i", flow="c")
    with pytest.raises(
        EquationError, match="itself follows from a rate: I 'm'"
    ) as told:
        derive(graph.finish())
    # Nobody wished for it, and a wish about another element is none about this one.
    assert told.value.remedy.startswith("Put an R or a C")
    graph.prefer("c", "derivative")
    with pytest.raises(EquationError, match="itself follows") as told:
        derive(graph.finish())
    assert told.value.remedy.startswith("Put an R or a C")
    graph.prefer("m", "derivative")
    with pytest.raises(EquationError, match="itself follows") as told:
        derive(graph.finish())
    assert told.value.remedy == "Drop the wish that 'm' be derivative."


def test_a_force_that_is_what_the_masses_need_leaves_the_motion_open() -> None:
    """Whatever the acceleration a is, the force is (m1 + m2) a: a rate tells."""
    m1, m2 = sympy.symbols("m1 m2")
    graph = BondGraph("carried along")
    graph.one("body", I("m1"), I("m2"), Se("held", value=effort("m2") * (1 + m1 / m2)))
    with pytest.raises(EquationError, match="does not determine"):
        derive(graph.finish())
    graph = BondGraph("held back")
    graph.one("body", I("m1"), I("m2"), Se("held", value=effort("m2") * m1 / m2))
    graph.measure("v", flow="body")
    assert len(derive(graph.finish()).unknowns) == 1


# Reading --------------------------------------------------------------------------


@every_case
def test_every_case_can_be_read(case: Case) -> None:
    equations = derive(case.graph())
    text = as_text(equations)
    for state in equations.states:
        assert f"d({state.symbol})/dt" in text
    assert as_latex(equations).startswith(r"\begin{aligned}")


def test_text_of_a_small_model() -> None:
    equations = derive(next(c for c in CASES if c.name == "rc").graph())
    assert as_text(equations) == (
        "rc\n\n"
        "states\n  q_c [1] at c\n\n"
        "inputs\n  u [1]\n\n"
        "assignments\n"
        "  e_c = q_c/c\n"
        "  e_r = -e_c + u\n"
        "  f_loop = e_r/r\n\n"
        "rates\n  d(q_c)/dt = f_loop\n\n"
        "outputs\n  v [1] = e_c\n  i [1/s] = f_loop\n\n"
        "reduced\n  d(q_c)/dt = (u - q_c/c)/r\n"
    )


def test_a_moving_modulus_gives_its_own_force() -> None:
    # The slider's inertia force m (l sin θ · θ')' = m l (cos θ θ'² + sin θ θ'').
    graph = next(c for c in CASES if c.name == "crank_and_slider").graph()
    equations = derive(graph)
    at = evaluated(equations, some_values(equations))
    number = {str(k): v for k, v in at.items()}
    speed = number["p_j"] / number["j"]
    angle = number["q_crank"]
    acceleration = number["dp_j"] / number["j"]
    expected = (
        number["m"]
        * number["l"]
        * (np.cos(angle) * speed**2 + np.sin(angle) * acceleration)
    )
    push = next(o for o in equations.outputs if o.name == "push")
    # The slider's flow is l sin θ θ', so its I receives the rate of m l sin θ θ'.
    assert float(push.expression.xreplace(at)) == pytest.approx(expected)
    assert TF  # the case's arm is a TF whose modulus reads a displacement
    assert displacement("crank") in graph.node("arm").modulus.free_symbols
    assert q not in graph.node("arm").modulus.free_symbols


@every_case
def test_what_is_only_another_name_is_no_assignment(case: Case) -> None:
    for assignment in derive(case.graph()).assignments:
        expression = assignment.expression
        assert not expression.is_Symbol
        assert not (-expression).is_Symbol
        assert not expression.is_number
