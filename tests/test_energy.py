"""Energy: the laws of every storage integrated, and a balance that closes."""

import re
from pathlib import Path

import pytest
import sympy
from catalogue import CASES, Case, agree, expression, random_graph, somewhere

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.deriving.inversion import Laws
from bondgraph.equations.insertion import signal_values
from bondgraph.equations.power.energy import BalanceStatus, energy
from bondgraph.equations.power.power_proof import PowerProof
from bondgraph.equations.power.stored_energy import EnergyForm, energy_function
from bondgraph.equations.reduction import reduce
from bondgraph.errors import BondGraphError, EquationError
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.elements import TF, C, I, R, Se, Sf
from bondgraph.structure.fields import CField, IField, RField
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import displacement, e, effort, flow, p, ports, q, t

k, m, c, a, b = sympy.symbols("k m c a b", real=True)


def graph_with(storage: I | C) -> FinishedGraph:
    graph = BondGraph("one storage")
    graph.one("port", Se("u"), R("r"), storage)
    return graph.finish()


def same(one: sympy.Expr, other: sympy.Expr) -> bool:
    """Return whether long expressions agree at numbers; `agree` substitutes slowly."""
    put = {
        x: sympy.Float(v)
        for x, v in somewhere(one.free_symbols | other.free_symbols).items()
    }
    first, second = (complex(x.xreplace(put)) for x in (one, other))
    return abs(first - second) <= 1e-9 * max(1.0, abs(first), abs(second))


def time_derivative(total: sympy.Expr, graph: FinishedGraph) -> sympy.Expr:
    """Return dH/dt by the chain rule over states, inputs and time."""
    equations = derive(graph)
    rates = reduce(equations).explicit()
    terms = [
        total.diff(s.symbol) * r for s, r in zip(equations.states, rates, strict=True)
    ]
    terms += [
        total.diff(u) * du
        for u, du in zip(equations.inputs, equations.input_rates, strict=True)
    ]
    return sympy.Add(*terms, total.diff(t))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_balance_is_shown_exactly(case: Case) -> None:
    balance = energy(case.graph())
    assert balance.status is BalanceStatus.EXACT
    assert balance.unproven == ()
    assert len(balance.stored) >= len(case.derivative)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_energy_changes_by_the_powers(case: Case) -> None:
    """Compare dH/dt from H(x) and the rates with the sum of the powers."""
    graph = case.graph()
    equations = derive(graph)
    if reduce(equations).unknowns:
        pytest.skip("its rates have no formula to compare with")
    balance = energy(graph, equations).in_states()
    allowed = {
        *(s.symbol for s in balance.equations.states),
        *balance.equations.inputs,
        *balance.equations.input_rates,
        *balance.equations.parameters,
        t,
    }
    assert balance.total.free_symbols <= allowed
    assert same(time_derivative(balance.total, graph), balance.rate)


def test_random_graphs_conserve_power() -> None:
    tried = 0
    for seed in range(120):
        try:
            graph = random_graph(seed).finish()
            equations = derive(graph)
        except BondGraphError:
            continue
        tried += 1
        assert energy(graph, equations).status is BalanceStatus.EXACT, seed
    assert tried > 40


@pytest.mark.parametrize(
    ("element", "expected"),
    [
        (I("m"), p**2 / (2 * m)),
        (C("c"), q**2 / (2 * c)),
        (C("s", law=k * (q - a)), k * (q - a) ** 2 / 2 - k * a**2 / 2),
        (C("s", law=k * q + b * q**3), k * q**2 / 2 + b * q**4 / 4),
        (C("s", law=k * sympy.sin(q)), k * (1 - sympy.cos(q))),
        (C("s", law=a * sympy.tanh(b * q)), a * sympy.log(sympy.cosh(b * q)) / b),
        (C("s", law=k * sympy.sign(q)), k * sympy.Abs(q)),
        (C("stop", law=k * sympy.Max(0, q - a)), k * sympy.Max(0, q - a) ** 2 / 2),
        (C("s", law=2 * k * q * sympy.Abs(q)), 2 * k * sympy.Abs(q) ** 3 / 3),
        (C("s", law=a * e), q**2 / (2 * a)),
        (
            I("i", law=p / sympy.sqrt(m**2 + (p / c) ** 2)),
            c**2 * (sympy.sqrt(m**2 + p**2 / c**2) - m),
        ),
        # a vapour: e = k/q has its zero of energy at q = 1
        (C("s", law=k / q), k * sympy.log(q)),
    ],
    ids=str,
)
def test_laws_are_integrated(element: I | C, expected: sympy.Expr) -> None:
    function = energy_function(element, Laws(graph_with(element)))
    assert function.form is EnergyForm.CLOSED
    assert agree(function.expression, expected)


def test_a_law_of_the_co_variable_gives_the_legendre_transform() -> None:
    """q = a e + b e³ stores ∫ e dq = a e²/2 + 3 b e⁴/4, and not ∫ q de."""
    element = C("s", law=a * e + b * e**3)
    function = energy_function(element, Laws(graph_with(element)))
    assert function.variables == (e,)
    assert agree(function.expression, a * e**2 / 2 + 3 * b * e**4 / 4)


def test_what_has_no_closed_form_stays_an_integral_and_is_true() -> None:
    law = k * sympy.exp(sympy.sin(q)) / (1 + q**4)
    element = C("s", law=law)
    function = energy_function(element, Laws(graph_with(element)))
    assert function.form is EnergyForm.INTEGRAL
    slope = function.expression.diff(q).subs({k: 1.3, q: 0.7})
    assert float(slope) == pytest.approx(float(law.subs({k: 1.3, q: 0.7})))


LAWS = {
    "the larger of two": (sympy.Max(q - a, 2 * q - b), EnergyForm.INTEGRAL),
    "at least a number": (sympy.Max(a, q), EnergyForm.INTEGRAL),
    "at most a number": (sympy.Min(b, q), EnergyForm.INTEGRAL),
    "a modulus and a sign": (
        sympy.Abs(q) * sympy.sign(q - a),
        EnergyForm.INTEGRAL,
    ),
    "a wave in a modulus": (
        k * sympy.exp(sympy.Abs(sympy.sin(q))),
        EnergyForm.INTEGRAL,
    ),
    "pieces": (
        sympy.Piecewise((k * q, q < a), (2 * k * q, True)),
        EnergyForm.INTEGRAL,
    ),
    "a step up at a place": (k * sympy.sign(q - a) + q, EnergyForm.CLOSED),
    "a cube of a modulus": (k * sympy.Abs(q) ** 3, EnergyForm.CLOSED),
    "a modulus elsewhere": (sympy.Abs(a * q - b), EnergyForm.CLOSED),
    "a stop that hardens": (k * sympy.Max(0, q - a) ** 2, EnergyForm.CLOSED),
    "a wave of some length": (k * sympy.cos(a * q), EnergyForm.CLOSED),
    "a diode": (k * (sympy.exp(b * q) - 1), EnergyForm.CLOSED),
    "infinite at nothing": (k / q**2, EnergyForm.CLOSED),
}


@pytest.mark.parametrize(("law", "form"), LAWS.values(), ids=LAWS)
def test_an_energy_has_its_law_as_slope_and_is_none_where_empty(
    law: sympy.Expr, form: EnergyForm
) -> None:
    element = C("s", law=law)
    function = energy_function(element, Laws(graph_with(element)))
    assert (function.form, function.variables) == (form, (q,))
    assert function.reads_stored
    numbers = {k: 1.3, a: 0.4, b: 1.1}
    whole = sympy.lambdify(q, function.expression.subs(numbers), ["scipy", "numpy"])
    assert whole(float(function.empty)) == pytest.approx(0.0, abs=1e-12)
    for place in (0.2, 0.7, 1.9):
        step = 1e-4
        slope = (whole(place + step) - whole(place - step)) / (2 * step)
        expected = float(law.subs({**numbers, q: place}))
        assert slope == pytest.approx(expected, rel=1e-4)


def test_turning_arrows_leaves_energy_and_powers_as_they_are() -> None:
    def made(turned: bool) -> FinishedGraph:
        graph = BondGraph("drive")
        graph.one("motor", Se("torque"), I("j1"))
        graph.zero("coupling", C("c"))
        graph.one("load", I("j2"), R("d"))
        pairs = [("motor", "coupling"), ("coupling", "load")]
        for tail, head in pairs:
            graph.join(*((head, tail) if turned else (tail, head)))
        return graph.finish()

    one, other = (energy(made(turned)).in_states() for turned in (False, True))
    # turning the arrow at the coupling turns the sign of what crosses it
    assert agree(one.total, other.total)
    assert agree(one.supplied[0].power, other.supplied[0].power)
    assert agree(one.dissipated[0].power, other.dissipated[0].power)


def test_a_resistance_dissipates_and_a_source_supplies() -> None:
    balance = energy(graph_with(I("m"))).in_states()
    (source,), (resistance,) = balance.supplied, balance.dissipated
    assert agree(source.power, expression("u*p_m/m"))
    assert agree(resistance.power, expression("r*p_m**2/m**2"))
    assert agree(balance.rate, expression("u*p_m/m - r*p_m**2/m**2"))
    assert not balance.is_closed


def test_fields_store_and_dissipate() -> None:
    x, charge = ports("q", 2)
    graph = BondGraph("condenser microphone")
    graph.one("circuit", Se("u"))
    graph.one("plate", I("m"))
    graph.put(
        CField.from_energy("air", charge**2 * (sympy.Symbol("d") + x) / 2 / c),
        on=("plate", "circuit"),
    )
    r1, r12, r2 = sympy.symbols("r1 r12 r2")
    graph.put(
        RField.from_matrix("damping", [[r1, r12], [r12, r2]]), on=("plate", "circuit")
    )
    finished = graph.finish()
    balance = energy(finished).in_states()
    assert balance.status is BalanceStatus.EXACT
    assert same(time_derivative(balance.total, finished), balance.rate)
    held = expression("p_m**2/(2*m) + q_air_2**2*(d + q_air_1)/(2*c)")
    assert agree(balance.total, held)


def test_a_field_in_both_causalities_keeps_its_energy() -> None:
    graph = BondGraph("coupled coils on a motor")
    graph.one("first", Se("u"), R("r1"), I("l3"))
    graph.one("second", R("r2"))
    l1, l2, mutual = sympy.symbols("l1 l2 mutual")
    coils = IField.from_matrix("coils", [[l1, mutual], [mutual, l2]])
    graph.put(coils, on=("first", "second"))
    finished = graph.finish()
    balance = energy(finished).in_states()
    assert same(time_derivative(balance.total, finished), balance.rate)


def test_a_spring_whose_stiffness_moves_exchanges_power() -> None:
    """dH/dt = e q̇ + q²/2 dk/dt, where k = k0 z follows another displacement."""
    graph = BondGraph("parametric spring")
    spring = C("spring", law=k * displacement("wheel") * q)
    graph.one("mass", Se("force"), I("m"), spring)
    graph.one("wheel", Sf("turn"), R("r"))
    finished = graph.finish()
    balance = energy(finished).in_states()
    (exchanged,) = balance.exchanged
    assert agree(exchanged.power, expression("k*q_spring**2*turn/2"))
    assert exchanged.is_power
    assert same(time_derivative(balance.total, finished), balance.rate)


def test_a_stiffness_that_follows_time_exchanges_power() -> None:
    graph = BondGraph("pumped spring")
    graph.one("mass", I("m"), C("spring", law=k * (2 + sympy.cos(t)) * q))
    finished = graph.finish()
    balance = energy(finished).in_states()
    assert same(time_derivative(balance.total, finished), balance.rate)
    assert agree(balance.rate, -k * sympy.sin(t) * expression("q_spring") ** 2 / 2)


def test_heat_is_listed_and_left_out() -> None:
    graph = BondGraph("heated coil")
    graph.one("coil", Se("u"), R("r"), I("l"), domain="electrical")
    loss = flow("coil") ** 2 * sympy.Symbol("r")
    graph.zero("body", Sf("heating", value=loss), C("heat"), domain="thermal")
    finished = graph.finish()
    balance = energy(finished)
    pseudo = {x.element: x.is_power for x in (*balance.stored, *balance.supplied)}
    assert pseudo == {"l": True, "heat": False, "u": True, "heating": False}
    assert agree(balance.in_states().total, expression("p_l**2/(2*l)"))
    coil = time_derivative(balance.in_states().total, finished)
    assert agree(coil, balance.in_states().rate)
    assert "left out" in balance.as_text()


def test_a_closed_machine_keeps_its_energy() -> None:
    graph = BondGraph("crank without drive")
    arm = TF("arm", law=a * sympy.sin(displacement("crank")))
    graph.one("crank", I("j"))
    graph.one("slider", I("m"))
    graph.join("slider", arm, "crank")
    finished = graph.finish()
    balance = energy(finished)
    assert balance.is_closed
    assert balance.rate == 0
    assert same(time_derivative(balance.in_states().total, finished), sympy.S.Zero)


def test_a_long_chain_is_proven_exactly() -> None:
    graph = BondGraph("ladder")
    graph.one("s0", Se("u"), R("r0"), I("l0"))
    for i in range(100):
        graph.zero(f"n{i}", C(f"c{i}"))
        graph.join(f"s{i}", f"n{i}")
        graph.one(f"s{i + 1}", R(f"r{i + 1}"), I(f"l{i + 1}"))
        graph.join(f"n{i}", f"s{i + 1}")
    balance = energy(graph.finish())
    assert balance.status is BalanceStatus.EXACT
    assert len(balance.total.args) == 201


def test_a_modulation_without_a_rate_is_said_to_be_open() -> None:
    """The stiffness reads an effort that only a nonlinear equation gives."""
    graph = BondGraph("stiffness from a loop")
    diode = R("diode", law=a * (sympy.exp(e / b) - 1))
    graph.one("loop", Se("u"), diode, R("r"))
    graph.one("mass", I("m"), C("spring", law=effort("diode") * q))
    balance = energy(graph.finish())
    assert balance.status is BalanceStatus.OPEN


def test_text_and_latex_name_everything() -> None:
    balance = energy(graph_with(I("m")))
    text = balance.as_text()
    for line in ("in I m: p_m**2/(2*m)", "Se u:", "R r:", "exactly"):
        assert line in text
    assert r"\dot{H}" in balance.as_latex()
    assert balance._repr_latex_().startswith("$")


def test_the_page_on_energy_runs() -> None:
    page = (Path(__file__).parent.parent / "docs" / "energy.md").read_text("utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    assert len(blocks) >= 4
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "docs/energy.md", "exec"), names)
    shown = re.findall(r"```text\n(.*?)```", page, flags=re.DOTALL)
    texts = [str(x) for x in (names["balance"], names["form"], names["kept"])]
    assert [text.strip() for text in shown] == [text.strip() for text in texts]


def test_a_weight_stores_force_times_way() -> None:
    function = energy_function(C("weight", law=k), Laws(graph_with(C("c"))))
    assert agree(function.expression, k * q)


def test_power_that_crosses_from_heat_is_listed() -> None:
    """A TF from a thermal to an electrical junction: its power enters, no other."""
    graph = BondGraph("pyroelectric")
    graph.zero("body", C("heat"), domain="thermal")
    graph.one("loop", I("l"), R("r"), domain="electrical")
    graph.join("body", TF("k"), "loop")
    finished = graph.finish()
    balance = energy(finished).in_states()
    (crossing,) = balance.exchanged
    assert (crossing.element, crossing.is_power) == ("k", True)
    assert same(time_derivative(balance.total, finished), balance.rate)


def test_a_power_that_does_not_vanish_is_not_proven() -> None:
    equations = derive(graph_with(I("m")))
    prove = PowerProof(equations)
    supplied = equations.signal("effort", "u") * equations.signal("flow", "port")
    into_m = equations.signal("effort", "m") * equations.signal("flow", "port")
    into_r = equations.signal("effort", "r") * equations.signal("flow", "port")
    assert not prove(supplied - into_m, "port")
    assert prove(supplied - into_m - into_r, "port")


def test_equations_of_another_model_are_refused() -> None:
    graph = BondGraph("parametric spring")
    spring = C("spring", law=k * displacement("wheel") * q)
    graph.one("mass", Se("force"), I("m"), spring)
    graph.one("wheel", Sf("turn"), R("r"))
    with pytest.raises(EquationError, match="other states"):
        signal_values(
            graph.finish(), derive(graph_with(I("m"))), [displacement("wheel")]
        )


def test_the_residual_is_what_the_storages_do_not_take() -> None:
    """Power in from sources and from outside, less what is lost and what is stored."""
    graph = BondGraph("parametric spring")
    spring = C("spring", law=k * displacement("wheel") * q)
    graph.one("mass", Se("force"), I("m"), spring, R("rub"))
    graph.one("wheel", Sf("turn"), R("r"))
    balance = energy(graph.finish()).in_states()
    assert agree(balance.residual, sympy.S.Zero)


def test_a_node_whose_power_is_not_shown_to_vanish_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(PowerProof, "__call__", lambda *_: False)
    balance = energy(graph_with(I("m")))
    assert balance.status is BalanceStatus.PARTLY_SHOWN
    assert balance.unproven == ("port",)


def test_one_law_that_is_infinite_at_nothing_moves_the_begin_of_all() -> None:
    one, two = ports("q", 2)
    field = CField.from_energy("gas", k * sympy.log(one) + a * two**2 / 2)
    graph = BondGraph("vapour")
    graph.one("first", Se("u"), R("r"))
    graph.one("second", Se("v"), R("g"))
    graph.put(field, on=("first", "second"))
    function = energy_function(field, Laws(graph.finish()))
    assert function.empty == 1
    # From one at both ports.
    expected = k * sympy.log(one) + a * (two**2 - 1) / 2
    assert agree(sympy.expand_log(function.expression.doit(), force=True), expected)


def test_a_stiffness_that_follows_an_input_exchanges_the_power_of_its_rate() -> None:
    graph = BondGraph("tuned spring")
    spring = C("spring", law=k * flow("wheel") * q)
    graph.one("mass", Se("force"), I("m"), spring)
    graph.one("wheel", Sf("turn"), R("r"))
    finished = graph.finish()
    balance = energy(finished).in_states()
    assert same(time_derivative(balance.total, finished), balance.rate)
    (rate,) = [
        x for x in balance.rate.free_symbols if x in balance.equations.input_rates
    ]
    assert agree(balance.rate.coeff(rate), k * expression("q_spring**2/2"))


def test_a_ratio_that_follows_time_keeps_the_power() -> None:
    graph = BondGraph("gear that changes")
    graph.one("fast", Se("force"), I("m1"))
    graph.one("slow", I("m2"))
    graph.join("fast", TF("gear", law=a * (2 + sympy.sin(t))), "slow")
    finished = graph.finish()
    total = energy(finished).in_states().total
    supplied = expression("force*p_m1/m1")
    assert same(time_derivative(total, finished), supplied)
