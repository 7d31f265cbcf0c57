"""Sub-graphs, arrays, sensors on junctions, domains along bonds, causal wishes."""

import pytest
import sympy
from catalogue import agree

from bondgraph import (
    GY,
    TF,
    BondGraph,
    C,
    De,
    Df,
    Dp,
    Dq,
    I,
    R,
    Se,
    Sf,
    assign_causality,
    derive,
    displacement,
    flow,
    linearise,
    momentum,
    q,
)
from bondgraph.errors import EquationError, ParameterError, StructureError, UnitError
from bondgraph.structure.elements import OneJunction
from bondgraph.structure.graph import CausalPreference, Wanted


def stage() -> BondGraph:
    graph = BondGraph("stage", domain="electrical")
    graph.one("series", R("r"), I("l"))
    graph.zero("node", C("c"), De("u"))
    graph.join("series", "node")
    graph.expose("series", "node")
    graph.parameter("r", 2.0, "ohm")
    return graph


def ladder(count: int, **keywords: object) -> BondGraph:
    graph = BondGraph("ladder", domain="electrical")
    graph.zero("start", Se("source"))
    parts = graph.repeat(stage(), count, "s", chain=("node", "series"), **keywords)  # type: ignore[arg-type]
    graph.join("start", parts[0]["series"])
    return graph


def test_an_array_of_stages_is_the_ladder_written_out() -> None:
    written = BondGraph("ladder", domain="electrical")
    written.zero("start", Se("source"))
    for i in (1, 2):
        written.one(f"s{i}_series", R(f"s{i}_r"), I(f"s{i}_l"))
        written.zero(f"s{i}_node", C(f"s{i}_c"))
        written.join(f"s{i}_series", f"s{i}_node")
        written.measure(f"s{i}_u", effort=f"s{i}_node")
        written.parameter(f"s{i}_r", 2.0, "ohm")
    written.join("s1_node", "s2_series")
    written.join("start", "s1_series")
    assert set(ladder(2).finish().nodes) == set(written.finish().nodes)
    one, other = (linearise(derive(g.finish())) for g in (ladder(2), written))
    assert (one.A, one.B, one.C) == (other.A, other.B, other.C)


def test_a_shared_parameter_is_one_parameter() -> None:
    graph = ladder(3, shared=("r",)).finish()
    assert graph.parameters["r"].value == 2.0
    assert [name for name in graph.parameters if "_r" in name] == []
    written = linearise(derive(ladder(1, shared=("r",)).finish()))
    alone = linearise(derive(ladder(1).finish()))
    names = {sympy.Symbol("s1_r", real=True): sympy.Symbol("r", real=True)}
    assert alone.A.xreplace(names) == written.A


def test_only_exposed_junctions_can_be_joined() -> None:
    wheel = BondGraph("wheel")
    wheel.one("hub", I("inertia"))
    wheel.one("inside", R("bearing"))
    wheel.join("hub", "inside")
    wheel.expose("hub")
    car = BondGraph("car")
    left = car.include(wheel, "left")
    assert dict(left) == {"hub": "left_hub"}
    with pytest.raises(StructureError, match="exposes no junction 'inside'"):
        left["inside"]
    with pytest.raises(StructureError, match="no junction 'spoke'"):
        wheel.expose("spoke")


def test_graphs_join_under_their_own_names() -> None:
    motor = BondGraph("motor", domain="rotation")
    motor.one("shaft", Se("torque"), I("rotor"))
    load = BondGraph("load", domain="rotation")
    load.one("joint", R("friction"))
    whole = BondGraph("drive")
    whole.include(motor)
    whole.include(load.finish())
    whole.join("shaft", "joint")
    names = [node.name for node in whole.finish().nodes]
    assert names == ["shaft", "torque", "rotor", "joint", "friction"]
    assert whole.finish().domain_at("joint").name == "rotation"


def test_two_declarations_of_one_parameter_are_refused() -> None:
    one, other = BondGraph("one"), BondGraph("other")
    for value, graph in ((1.0, one), (2.0, other)):
        graph.one(f"shaft{value:.0f}", R("r", law=sympy.Symbol("k") * flow("x")))
        graph.parameter("k", value)
    whole = BondGraph("whole")
    whole.include(one)
    with pytest.raises(ParameterError, match="'k' has two declarations"):
        whole.include(other)


def test_a_sub_graph_keeps_its_signals_and_wishes() -> None:
    part = BondGraph("part")
    part.one("crank", I("j"))
    part.one("slide", I("m"), C("spring"))
    part.join("crank", TF("arm", sympy.cos(displacement("crank"))), "slide")
    part.prefer("m", "integral")
    whole = BondGraph("whole")
    whole.include(part, "x")
    graph = whole.finish()
    assert str(graph.node("x_arm").modulus) == 'cos(displacement("x_crank"))'
    assert graph.preferences == (CausalPreference("x_m", Wanted.INTEGRAL),)


def test_an_unknown_shared_parameter_is_refused() -> None:
    with pytest.raises(StructureError, match="no parameter 'rr' to share"):
        ladder(2, shared=("rr",))


def test_sensors_hang_on_junctions() -> None:
    graph = BondGraph("cart", domain="translation")
    graph.one("cart", Se("force"), I("m"), Df("speed"), Dq("position"))
    graph.zero("contact", De("push"), Dp("impulse"), R("b"))
    graph.join("cart", "contact")
    finished = graph.finish()
    units = {m.name: m.unit for m in finished.measurements}
    assert units == {"speed": "m/s", "position": "m", "push": "N", "impulse": "N*s"}
    reads = {m.name: m.expression for m in finished.measurements}
    assert reads["position"] == displacement("cart")
    assert reads["impulse"] == momentum("contact")
    assert len(finished.bonds) == 4  # a sensor takes no power: no bond


def test_a_sensor_must_read_what_its_junction_has_in_common() -> None:
    graph = BondGraph("cart")
    graph.one("cart", Se("force"), I("m"), De("push"))
    with pytest.raises(StructureError, match="has only its flow in common"):
        graph.finish()


def test_where_an_effort_can_be_read_instead_is_told() -> None:
    graph = BondGraph("cart", domain="translation")
    graph.one("cart", Se("force"), I("m"))
    graph.zero("coupling", C("spring"))
    graph.join("cart", "coupling")
    graph.measure("push", effort="cart")
    with pytest.raises(StructureError, match="or at 'coupling' beside it"):
        graph.finish()


def test_bonds_join_equal_domains_only() -> None:
    graph = BondGraph("mixed")
    graph.one("shaft", Se("torque"), I("j"), domain="rotation")
    graph.one("coil", R("r"), domain="electrical")
    graph.join("shaft", "coil")
    with pytest.raises(UnitError, match=r"two energy domains.*electrical.*rotation"):
        graph.finish()


@pytest.mark.parametrize(
    ("two_port", "unit", "right"),
    [(TF("k"), "m", True), (TF("k"), "kg", False), (GY("k"), "m/s", False)],
)
def test_moduli_have_the_unit_between_their_domains(
    two_port: TF | GY, unit: str, right: bool
) -> None:
    graph = BondGraph("rack")
    graph.one("rack", Se("force"), I("m"), domain="translation")
    graph.one("pinion", I("j"), domain="rotation")
    graph.join("rack", two_port, "pinion")  # torque = k force: k in metres
    graph.parameter("k", 0.05, unit)
    if right:
        assert graph.finish().parameters["k"].unit == "m"
    else:
        with pytest.raises(UnitError, match="'k' is in"):
            graph.finish()


def test_undeclared_parameters_get_the_unit_of_their_domain() -> None:
    graph = BondGraph("cart", domain="translation")
    graph.one("cart", Se("force"), I("m"), R("b"), C("k"))
    finished = graph.finish()
    units = [finished.parameters[name].unit for name in ("m", "b", "k")]
    assert units == ["(N*s)/(m/s)", "(N)/(m/s)", "(m)/(N)"]
    assert finished.with_parameters({"m": 2.0}).parameters["m"].value == 2.0


def test_two_bonds_between_the_same_ports_are_refused() -> None:
    graph = BondGraph("double")
    graph.one("a", Se("u"))
    graph.zero("b", C("c"))
    graph.join("a", "b")
    graph.join("a", "b")
    with pytest.raises(StructureError, match="2 bonds 'a>b'"):
        graph.finish()


def rigid_pair() -> BondGraph:
    graph = BondGraph("pair")
    graph.one("shaft", Se("torque"), I("one"), I("two"), R("b"))
    return graph


def test_a_wish_decides_which_storage_is_the_state() -> None:
    for name in ("one", "two"):
        graph = rigid_pair()
        graph.prefer(name, "integral")
        causality = assign_causality(graph.finish())
        assert causality.integral == (name,)
        assert causality.unmet == ()
        reasons = [s.reason for s in causality.steps if name in s.reason]
        assert reasons[0] == f"I {name!r} gives flow, as its author prefers"


def test_a_wish_may_be_for_derivative_causality() -> None:
    wish = (CausalPreference("one", Wanted.DERIVATIVE),)
    causality = assign_causality(rigid_pair().finish(), prefer=wish)
    assert (causality.integral, causality.derivative) == (("two",), ("one",))


def test_a_storage_that_nothing_else_sets_cannot_be_wished_dependent() -> None:
    graph = BondGraph("coil")
    graph.one("loop", Se("u"), R("r"), I("l"))
    graph.prefer("l", "derivative")
    with pytest.raises(EquationError, match=r"Drop the wish that 'l' be derivative"):
        derive(graph.finish())


def test_a_resistance_gives_what_one_wishes() -> None:
    transfers = []
    for gives in ("effort", "flow"):
        graph = BondGraph("divider")
        graph.one("loop", Se("u"), R("r1"), R("r2"), Df("i"))
        graph.prefer("r1", gives)
        causality = assign_causality(graph.finish())
        at = causality.stroke_of("loop>r1").at
        assert at == ("loop" if gives == "effort" else "r1")
        transfers.append(linearise(derive(graph.finish())).transfer_function())
    assert agree(transfers[0].expression, transfers[1].expression)


def test_a_resistance_does_not_take_a_state_away() -> None:
    graph = BondGraph("coil")
    graph.one("loop", Se("u"), R("r"), I("l"))
    graph.prefer("r", "flow")
    causality = assign_causality(graph.finish())
    assert (causality.integral, causality.unmet) == (("l",), ("r",))


def test_a_wish_that_cannot_be_met_is_said() -> None:
    graph = BondGraph("held")
    graph.one("shaft", Sf("speed"), I("j"))
    graph.prefer("j", "integral")
    causality = assign_causality(graph.finish())
    assert causality.derivative == ("j",)
    assert causality.unmet == ("j",)


@pytest.mark.parametrize(
    ("element", "wanted", "said"),
    [
        ("torque", "integral", "has no causality to prefer"),
        ("nobody", "integral", "has no causality to prefer"),
        ("b", "integral", "Prefer effort or flow"),
        ("one", "sideways", "is no causality"),
    ],
)
def test_wishes_for_nothing_are_refused(element: str, wanted: str, said: str) -> None:
    def wish() -> None:
        graph = rigid_pair()
        graph.prefer(element, wanted)
        graph.finish()

    with pytest.raises(StructureError, match=said):
        wish()


HELD = sympy.Symbol("k") * q


@pytest.mark.parametrize(
    "law",
    [
        pytest.param(HELD * sympy.Abs(q), id="square"),
        pytest.param(HELD * q**2, id="cubic"),
        pytest.param(HELD + sympy.exp(q), id="exponential"),
    ],
)
def test_a_nonlinear_storage_held_by_an_input_follows_its_rate(law: sympy.Expr) -> None:
    # e = law(q) = u, so the flow is q' = u' / law'(q), at the q with law(q) = u.
    graph = BondGraph("held")
    graph.zero("node", Se("u"), C("c", law=law))
    graph.measure("i", flow="c")
    graph.parameter("k", 2.0)
    equations = derive(graph.finish())
    assert not equations.states
    at = {sympy.Symbol("k"): 2.0, q: 0.8}
    u, slope = float(law.subs(at)), float(law.diff(q).subs(at))
    values = {"u": u, "du": 0.3 * slope, "k": 2.0, "q_c": 0.8, "dq_c": 0.3, "f_c": 0.3}
    groups = (equations.inputs, equations.input_rates, equations.parameters)
    known = {x: values[x.name] for g in (*groups, equations.unknowns) for x in g}
    for assignment in (*equations.assignments, *equations.further):
        known[assignment.symbol] = assignment.expression.xreplace(known)
    assert float(equations.signal("flow", "c").xreplace(known)) == pytest.approx(0.3)
    for residual in equations.residuals:
        assert float(residual.xreplace(known)) == pytest.approx(0.0, abs=1e-12)


def test_bonds_may_be_drawn_one_by_one_in_any_direction() -> None:
    drawn = BondGraph("rc")
    drawn.add(OneJunction("loop"), Se("u"), R("r"), C("c"))
    drawn.bond("u", "loop")
    drawn.bond("r", "loop")  # out of the R: signs change, the physics does not
    drawn.bond("loop", "c")
    drawn.measure("v", effort="c")
    usual = BondGraph("rc")
    usual.one("loop", Se("u"), R("r"), C("c"))
    usual.measure("v", effort="c")
    one, other = (
        linearise(derive(g.finish())).transfer_function() for g in (drawn, usual)
    )
    assert agree(one.expression, other.expression)


def test_elements_may_be_bonded_without_a_junction() -> None:
    graph = BondGraph("tower", domain="hydraulic")
    graph.add(C("tank"), TF("ram"), R("brake"))
    graph.bond("tank", "ram")
    graph.bond("ram", "brake", domain="translation")
    # p = q/C drives F = K p; v = F/R; q' = -K v.
    system = linearise(derive(graph.finish()))
    ram, brake, tank = sympy.symbols("ram brake tank", real=True)
    assert agree(system.A[0, 0], -(ram**2) / (brake * tank))
