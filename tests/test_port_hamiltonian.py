"""The port-Hamiltonian form: the same rates, from structure, energy and dissipation."""

from functools import cache

import pytest
import sympy
from catalogue import CASES, Case, agree, expression, random_graph, somewhere
from catalogue.evaluation import observed

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.power.port_hamiltonian import PortHamiltonian, port_hamiltonian
from bondgraph.equations.reduction import reduce
from bondgraph.errors import BondGraphError
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.elements import GY, TF, C, I, R, Se, Sf
from bondgraph.structure.fields import CField, IField, RField
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import displacement, e, effort, f, ports, q

a, b = sympy.symbols("a b", real=True)


def symbol(name: str) -> sympy.Symbol:
    return sympy.Symbol(name, real=True)


def at_numbers(expression: sympy.Expr) -> complex:
    """Return the value at arbitrary numbers, the same for the same names."""
    values = somewhere(expression.free_symbols)
    return complex(expression.xreplace({x: sympy.Float(v) for x, v in values.items()}))


def close(first: complex, second: complex) -> bool:
    return abs(first - second) <= 1e-9 * max(1.0, abs(first), abs(second))


def same(one: sympy.Expr, other: sympy.Expr) -> bool:
    """Return whether two expressions agree at one point."""
    return close(at_numbers(one), at_numbers(other))


def check(graph: FinishedGraph, form: PortHamiltonian) -> None:
    """Compare rates, gradient, power and symmetries with the derived equations."""
    equations, seen = derive(graph), observed(graph)
    assert not reduce(equations).unknowns
    names = [s.symbol.name for s in equations.states]
    assert {*form.states, *form.left_out} == set(names)
    values = {symbol(name): value for name, value in form.input_values.items()}
    for name, rate in zip(form.states, form.rates, strict=True):
        assert close(at_numbers(rate.xreplace(values)), seen.rates[name]), name
    for name, slope in zip(form.states, form.gradient, strict=True):
        assert same(form.H.diff(symbol(name)), slope), name
    assert sympy.zeros(*form.J.shape) == form.J + form.J.T
    assert sympy.zeros(*form.R.shape) == form.R - form.R.T
    for name, output in zip(form.inputs, form.outputs, strict=True):
        power = (symbol(name) * output).xreplace(values)
        assert close(at_numbers(power), seen.power(name)), name


@cache
def form_of(name: str) -> PortHamiltonian:
    (graph,) = (case.graph() for case in CASES if case.name == name)
    return port_hamiltonian(graph)


FORMLESS = {
    "no state": {"divider", "wheatstone_bridge", "moved_mass"},
    "set by an input": {"driven_capacitor_divider", "capacitive_divider"},
    "not proportional": {"quadratic_drag", "diode_and_resistance", "van_der_pol"},
    "more than a state": {"electromagnet_by_modulation", "spring_pendulum"},
    "no power": {"wall_with_mass"},
}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_form_gives_the_rates(case: Case) -> None:
    form = form_of(case.name)
    assert form.exists or form.reasons
    if form.exists:
        check(case.graph(), form)
    else:
        assert form.J.shape == (0, 0)
        assert all(reason.endswith(".") for reason in form.reasons)


def test_most_of_the_catalogue_has_the_form() -> None:
    found = {case.name: form_of(case.name).exists for case in CASES}
    assert sum(found.values()) > 0.6 * len(found)
    for names in FORMLESS.values():
        assert not any(found[name] for name in names)


def test_random_graphs_have_the_form_that_gives_their_rates() -> None:
    found = 0
    for seed in range(50):
        try:
            graph = random_graph(seed).finish()
            derive(graph)
        except BondGraphError:
            continue
        form = port_hamiltonian(graph)
        if form.exists:
            check(graph, form)
            found += 1
    assert found > 8


def test_a_motor_in_textbook_form() -> None:
    """J = [[0, -k], [k, 0]], R = diag(ra, b), as in van der Schaft's DC motor."""
    graph = BondGraph("dc motor")
    graph.one("armature", Se("u"), R("ra"), I("la"))
    graph.one("shaft", I("j"), R("b"))
    graph.join("armature", GY("k"), "shaft")
    form = port_hamiltonian(graph.finish())
    k, ra = symbol("k"), symbol("ra")
    assert form.states == ("p_la", "p_j")
    assert sympy.Matrix([[0, -k], [k, 0]]) == form.J
    assert sympy.diag(ra, b) == form.R
    assert sympy.Matrix([1, 0]) == form.G
    assert form.P.is_zero_matrix
    assert form.D.is_zero_matrix


def test_dependent_storage_enters_the_energy() -> None:
    """Two inertias on one shaft: H = p1²/2j1 (1 + j2/j1), J stays empty."""
    graph = BondGraph("shaft")
    graph.one("shaft", Se("torque"), I("j1"), I("j2"), R("b"))
    form = port_hamiltonian(graph.finish())
    assert agree(form.H, expression("p_j1**2/(2*j1) + j2*p_j1**2/(2*j1**2)"))
    assert agree(form.R[0, 0], expression("b*j1**2/(j1 + j2)**2"))
    assert agree(form.G[0, 0], expression("j1/(j1 + j2)"))


def two_link_arm() -> FinishedGraph:
    """Two joints that move one mass along x and y: J + m ∂x/∂θ ∂x/∂θᵀ as inertia."""
    arm = BondGraph("two links")
    first, second = displacement("shoulder"), displacement("elbow")
    arm.one("shoulder", Se("torque1"), I("j1"), R("b1"))
    arm.one("elbow", Se("torque2"), I("j2"))
    slopes = {
        "x": (-a * sympy.sin(first) - b * sympy.sin(first + second),
              -b * sympy.sin(first + second)),
        "y": (a * sympy.cos(first) + b * sympy.cos(first + second),
              b * sympy.cos(first + second)),
    }  # fmt: skip
    for axis, (by_first, by_second) in slopes.items():
        arm.one(f"along_{axis}", I(f"m_{axis}"))
        arm.zero(f"sum_{axis}")
        arm.join(f"sum_{axis}", f"along_{axis}")
        for joint, slope in (("shoulder", by_first), ("elbow", by_second)):
            arm.one(f"{joint}_{axis}")
            arm.join(f"{joint}_{axis}", f"sum_{axis}")
            arm.join(joint, TF(f"{joint}_to_{axis}", law=1 / slope), f"{joint}_{axis}")
    return arm.finish()


def test_a_modulus_that_moves_adds_gyroscopic_terms() -> None:
    graph = two_link_arm()
    form = port_hamiltonian(graph)
    assert form.states[:2] == ("p_j1", "p_j2")
    assert set(form.states[2:]) == {"q_shoulder", "q_elbow"}
    check(graph, form)
    coriolis = form.J[0, 1]
    assert coriolis != 0
    assert coriolis.has(sympy.sin)


def test_resistances_between_source_and_storage_make_a_feedthrough() -> None:
    """ẋ = (u - q/c)/r: u acts through r alone, y = (u - q/c)/r."""
    graph = BondGraph("rc")
    graph.one("loop", Se("u"), R("r"), C("c"))
    form = port_hamiltonian(graph.finish())
    r = symbol("r")
    assert form.G.is_zero_matrix
    assert agree(form.P[0, 0], -1 / r)
    assert agree(form.D[0, 0], 1 / r)
    assert agree(form.outputs[0], expression("(u - q_c/c)/r"))


def test_fields_have_the_form() -> None:
    x, charge = ports("q", 2)
    graph = BondGraph("condenser microphone")
    graph.one("circuit", Se("u"), R("r"))
    graph.one("plate", I("m"))
    law = charge**2 * (a + x) / 2 / b
    graph.put(CField.from_energy("air", law), on=("plate", "circuit"))
    r1, r12, r21, r2 = sympy.symbols("r1 r12 r21 r2")
    losses = RField.from_matrix("losses", [[r1, r12], [r21, r2]])
    graph.put(losses, on=("plate", "circuit"))
    finished = graph.finish()
    check(finished, port_hamiltonian(finished))


def test_a_field_that_follows_enters_the_energy() -> None:
    graph = BondGraph("two wheels on a plate")
    graph.one("left", Se("force"), I("m1"), R("d"))
    graph.one("right", I("m2"))
    k1, k12, k2 = sympy.symbols("k1 k12 k2")
    plate = IField.from_matrix("plate", [[k1, k12], [k12, k2]])
    graph.put(plate, on=("left", "right"))
    finished = graph.finish()
    check(finished, port_hamiltonian(finished))


def test_measured_integrals_are_left_out() -> None:
    graph = BondGraph("cart")
    graph.one("mass", Se("force"), I("m"), R("b"))
    graph.measure("x", displacement="mass")
    form = port_hamiltonian(graph.finish())
    assert form.states == ("p_m",)
    assert form.left_out == ("q_mass",)
    assert "left out" in form.as_text()


def test_a_source_with_a_value_is_a_port_and_says_its_value() -> None:
    graph = BondGraph("lift")
    m, g = sympy.symbols("m g")
    graph.one("mass", Se("force"), Se("weight", value=-m * g), I("m"))
    form = port_hamiltonian(graph.finish())
    assert form.inputs == ("force", "weight")
    assert agree(form.input_values["weight"], expression("-m*g"))


@pytest.mark.parametrize(
    ("element", "word"),
    [
        (R("drag", law=b * f * sympy.Abs(f)), "'drag'"),
        (R("offset", law=a + b * f), "'offset'"),
        (C("moved", law=a * displacement("wheel") * q), "'moved'"),
        (C("bent", law=e + e**5), "'bent'"),
    ],
    ids=["drag", "offset", "moved", "bent"],
)
def test_what_excludes_the_form_is_named(element: R | C, word: str) -> None:
    graph = BondGraph("with one strange element")
    graph.one("mass", Se("force"), I("m"), element)
    graph.one("wheel", Sf("turn"), I("j"), R("r"))
    graph.measure("theta", displacement="wheel")
    form = port_hamiltonian(graph.finish())
    assert not form.exists
    assert not form.is_passive
    assert {m.shape for m in (form.J, form.R, form.G, form.P, form.D)} == {(0, 0)}
    assert any(word in reason for reason in form.reasons)
    assert word in form.as_text()
    assert r"\text" in form.as_latex()


def test_a_dependent_storage_set_by_an_input_excludes_the_form() -> None:
    graph = BondGraph("moved mass on a spring")
    graph.one("mass", Sf("v"), I("m"))
    graph.one("other", I("m2"), C("c"))
    graph.zero("between", R("r"))
    graph.join("mass", "between")
    graph.join("between", "other")
    form = port_hamiltonian(graph.finish())
    assert form.reasons == (
        "The storage 'm' is dependent and follows more than the states: an input, "
        "time, or another rate.",
    )


@pytest.mark.parametrize(
    ("value", "bounds", "passive"),
    [
        (2.0, (float("-inf"), float("inf")), True),
        (None, (0.0, 5.0), True),
        (None, (float("-inf"), float("inf")), False),
        (-2.0, (float("-inf"), float("inf")), False),
    ],
)
def test_passivity_is_shown_from_values_or_bounds(
    value: float | None, bounds: tuple[float, float], passive: bool
) -> None:
    graph = BondGraph("cart")
    graph.one("mass", Se("force"), I("m"), R("b"))
    graph.parameter("b", value, "1", bounds=bounds)
    form = port_hamiltonian(graph.finish())
    assert form.exists
    assert form.is_passive is passive
    assert ("semidefinite where" in form.as_text()) is not passive


def test_it_is_written_as_latex() -> None:
    graph = BondGraph("cart")
    graph.one("mass", Se("force"), I("m"), C("c"), R("b"))
    latex = port_hamiltonian(graph.finish())._repr_latex_()
    for part in (r"\dot{x}", r"\nabla H", "force"):
        assert part in latex


def test_a_source_may_have_the_name_of_a_parameter() -> None:
    """Then the port of the source is called otherwise."""
    graph = BondGraph("lift")
    weight = Se("weight", value=-9.81 * sympy.Symbol("weight"))
    graph.one("mass", Se("force"), weight, I("m"))
    form = port_hamiltonian(graph.finish())
    assert form.inputs == ("force", "weight_")
    assert agree(form.input_values["weight_"], expression("-9.81*weight"))


def test_a_feedthrough_is_taken_from_the_gain_where_there_is_one() -> None:
    def driven(*elements: R | C | I) -> str:
        graph = BondGraph("loop")
        graph.one("loop", Se("u"), *elements)
        shown = port_hamiltonian(graph.finish()).as_latex()
        return shown.split(r"\nabla H + ")[1].splitlines()[0]

    assert " - " in driven(R("r"), C("c"))
    assert " - " not in driven(I("m"), R("b"))


@pytest.mark.parametrize(
    ("mutual", "passive"), [(0.5, True), (1.5, False), (-1.5, False)]
)
def test_a_field_is_passive_where_its_matrix_is(mutual: float, passive: bool) -> None:
    """The symmetric part of [[1, 2m], [0, 1]] is positive as long as |m| <= 1."""
    graph = BondGraph("rubbing plates")
    graph.one("left", Se("force"), I("m1"))
    graph.one("right", I("m2"))
    losses = RField.from_matrix("losses", [[1, 2 * sympy.Rational(mutual)], [0, 1]])
    graph.put(losses, on=("left", "right"))
    form = port_hamiltonian(graph.finish())
    assert form.exists
    assert form.dissipation["losses"].shape == (2, 2)
    assert form.is_passive is passive


def test_a_field_without_losses_of_its_own_has_the_form() -> None:
    """[[0, r], [-r, 0]] is a gyrator in other words."""
    graph = BondGraph("two wheels")
    graph.one("left", Se("force"), I("m1"), R("rub"))
    graph.one("right", I("m2"), C("c"))
    turn = sympy.Symbol("turn")
    graph.put(
        RField.from_matrix("field", [[0, turn], [-turn, 0]]), on=("left", "right")
    )
    graph.parameter("rub", 1.0, "1")
    finished = graph.finish()
    form = port_hamiltonian(finished)
    check(finished, form)
    assert form.is_passive


def test_heat_is_no_power_and_has_no_form() -> None:
    graph = BondGraph("oven")
    graph.zero("body", Sf("heating"), C("heat"), R("loss"), domain="thermal")
    form = port_hamiltonian(graph.finish())
    assert not form.exists
    assert form.reasons == ("Effort times flow is no power in the thermal domain.",)


def test_a_field_of_which_a_part_follows_has_no_form() -> None:
    graph = BondGraph("coupled coils")
    graph.one("first", Se("u"), R("r1"))
    graph.one("third", Sf("i"))
    l1, l2, mutual = sympy.symbols("l1 l2 mutual")
    coils = IField.from_matrix("coils", [[l1, mutual], [mutual, l2]])
    graph.put(coils, on=("first", "third"))
    form = port_hamiltonian(graph.finish())
    assert form.reasons == ("Some ports of I 'coils' are states and some follow.",)


def test_a_modulus_may_read_what_a_loop_of_resistances_gives() -> None:
    k = sympy.Symbol("k")
    graph = BondGraph("field winding behind a divider")
    graph.one("supply", Se("u"), R("r1"))
    graph.zero("divider", R("r2"))
    graph.one("coil", I("l"))
    graph.one("shaft", I("j"), R("rub"))
    graph.join("supply", "divider")
    graph.join("divider", "coil")
    graph.join("coil", GY("motor", law=k * effort("divider")), "shaft")
    finished = graph.finish()
    form = port_hamiltonian(finished)
    check(finished, form)
    # The divider's voltage, in terms of the source and of the coil's current.
    assert form.J[0, 1].has(symbol("r1"), symbol("p_l"))


def test_a_ratio_that_an_input_moves_carries_the_input_into_the_rates() -> None:
    """What follows changes its content with the ratio, and the source pays for it."""
    graph = BondGraph("crank of a length that is set")
    arm = TF("arm", law=a * sympy.sin(displacement("wheel")))
    graph.one("crank", Se("torque"), I("j"))
    graph.one("slider", I("m"), R("rub"))
    graph.join("slider", arm, "crank")
    graph.one("wheel", Sf("turn"), R("r"))
    finished = graph.finish()
    form = port_hamiltonian(finished)
    check(finished, form)
    assert form.G[0, form.inputs.index("turn")] != 0


@pytest.mark.parametrize("read", ["gear>coupling", "crank", "slip"])
def test_a_ratio_may_read_the_way_of_a_bond_a_junction_or_an_element(read: str) -> None:
    graph = BondGraph("crank on a coupling")
    graph.one("crank", Se("torque"), I("j"))
    graph.zero("coupling", R("slip"), C("spring"))
    graph.one("slider", I("m"), R("rub"))
    graph.join("crank", TF("gear"), "coupling")
    arm = TF("arm", law=a * sympy.sin(displacement(read)))
    graph.join("coupling", arm, "slider")
    finished = graph.finish()
    form = port_hamiltonian(finished)
    assert len(form.states) == 4
    check(finished, form)
