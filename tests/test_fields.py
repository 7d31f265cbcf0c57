"""Multiport fields: their laws in every causality, and what is refused."""

import pickle

import pytest
import sympy
from catalogue import agree

from bondgraph import (
    BondGraph,
    C,
    CField,
    FinishedGraph,
    I,
    ICField,
    IField,
    R,
    RField,
    Se,
    Sf,
    assign_causality,
    derive,
    linearise,
    port,
    ports,
    to_python,
)
from bondgraph.equations.reduction import reduce
from bondgraph.errors import BondGraphError, EquationError, StructureError
from bondgraph.numeric.model import compile_model
from bondgraph.structure.renaming import Renaming

L1, L2, M, r1, r2 = sympy.symbols("L1 L2 M r1 r2", real=True)
s = sympy.Symbol("s")


def coupled_coils() -> BondGraph:
    graph = BondGraph("coupled coils", domain="electrical")
    graph.one("a", Se("u"), R("r1"))
    graph.one("b", R("r2"))
    graph.put(IField.from_matrix("coils", [[L1, M], [M, L2]]), on=("a", "b"))
    graph.measure("i2", flow="b")
    return graph


def rates_of(graph: FinishedGraph) -> dict[str, sympy.Expr]:
    reduced = reduce(derive(graph))
    states = [state.symbol.name for state in reduced.equations.states]
    return dict(zip(states, reduced.explicit(), strict=True))


def test_a_mass_matrix_couples_its_ports() -> None:
    # Kirchhoff: u = r1 i1 + L1 i1' + M i2', 0 = r2 i2 + L2 i2' + M i1'.
    system = linearise(derive(coupled_coils().finish()))
    transfer = system.transfer_function("i2", "u").expression
    determinant = (r1 + L1 * s) * (r2 + L2 * s) - M**2 * s**2
    assert agree(transfer, -M * s / determinant)


def test_a_field_from_an_energy_has_its_derivatives_as_laws() -> None:
    # Condenser microphone (after Karnopp, Margolis, Rosenberg, multiport fields):
    # E = k x²/2 + q² (d - x) / (2 c); force k x - q²/2c, voltage q (d - x)/c.
    k, c, d = sympy.symbols("k c d", real=True)
    x, charge = ports("q", 2)
    field = CField.from_energy("plates", k * x**2 / 2 + charge**2 * (d - x) / (2 * c))
    graph = BondGraph("microphone")
    graph.one("plate", Se("force"), I("m"), R("b"))
    graph.one("circuit", Se("u"), R("r"))
    graph.put(field, on=("plate", "circuit"))
    found = rates_of(graph.finish())
    q1, q2, p, m, b, u, force, r = sympy.symbols(
        "q_plates_1 q_plates_2 p_m m b u force r", real=True
    )
    assert agree(found["p_m"], force - b * p / m - k * q1 + q2**2 / (2 * c))
    assert agree(found["q_plates_1"], p / m)
    assert agree(found["q_plates_2"], (u - q2 * (d - q1) / c) / r)


def test_a_solenoid_stores_flux_and_position_in_one_energy() -> None:
    # E = p² (1 + a x²) / 2 L: current p (1 + a x²)/L, force a x p²/L.
    L, a = sympy.symbols("L a", real=True)
    flux, x = port("p", 1), port("q", 2)
    field = ICField.from_energy("gap", flux**2 * (1 + a * x**2) / (2 * L))
    graph = BondGraph("solenoid")
    graph.one("coil", Se("u"), R("r"))
    graph.one("core", I("m"))
    graph.put(field, on=("coil", "core"))
    found = rates_of(graph.finish())
    p1, q2, r, u = sympy.symbols("p_gap_1 q_gap_2 r u", real=True)
    assert agree(found["p_gap_1"], u - r * p1 * (1 + a * q2**2) / L)
    assert agree(found["p_m"], -a * q2 * p1**2 / L)


def test_a_port_of_a_field_may_be_dependent() -> None:
    # A current source on coil a: p1 = L1 i + M i2 is no state; i2 = (p2 - M i)/L2.
    graph = BondGraph("held coil")
    graph.one("a", Sf("i"))
    graph.one("b", R("r2"))
    graph.put(IField.from_matrix("coils", [[L1, M], [M, L2]]), on=("a", "b"))
    graph.measure("u", effort="i")
    causality = assign_causality(graph.finish())
    assert causality.integral == ("coils[2]",)
    assert causality.derivative == ("coils[1]",)
    system = linearise(derive(graph.finish()))
    # Kirchhoff in s: u = s L1 i + s M i2, i2 = -s M i / (r2 + s L2).
    expected = s * L1 - s**2 * M**2 / (r2 + s * L2)
    assert agree(system.transfer_function("u", "i").expression, expected)


def test_a_resistive_field_works_in_both_directions() -> None:
    matrix = [[r1 + r2, -r2], [-r2, r1 + r2]]
    found = {}
    for source in (Se("u"), Sf("u")):
        graph = BondGraph("two port")
        graph.one("a", source)
        graph.one("b", R("load"))
        graph.put(RField.from_matrix("net", matrix), on=("a", "b"))
        graph.measure("y", flow="b")
        transfer = linearise(derive(graph.finish())).transfer_function("y", "u")
        found[type(source)] = transfer.expression
    load = sympy.Symbol("load", real=True)
    # Mesh equations: 0 = -r2 i1 + (r1 + r2 + load) i2, u = (r1 + r2) i1 - r2 i2.
    per_flow = r2 / (r1 + r2 + load)
    impedance = (r1 + r2) - r2 * per_flow
    assert agree(found[Sf], per_flow)
    assert agree(found[Se], per_flow / impedance)


def test_a_reaction_is_a_two_port_resistance() -> None:
    # A <=> B with mass action: a' = -k (ka a - kb b) (Oster, Perelson, Katchalsky).
    graph = BondGraph("reaction")
    for name in "AB":
        k = sympy.Symbol(f"k{name}")
        graph.zero(name, C(f"c{name}", law=sympy.log(k * sympy.Symbol("q"))))
    forward, backward = ports("e", 2)
    rate = sympy.Symbol("k") * (sympy.exp(forward) - sympy.exp(backward))
    graph.put(RField("re", (rate, -rate)), on=("A", "B"))
    found = rates_of(graph.finish())
    a, b, k, ka, kb = sympy.symbols("q_cA q_cB k kA kB", real=True)
    assert agree(found["q_cA"], -k * (ka * a - kb * b))
    assert agree(found["q_cB"], k * (ka * a - kb * b))


def test_a_field_runs_as_arrays_and_as_text() -> None:
    graph = coupled_coils().finish()
    namespace: dict[str, object] = {}
    exec(to_python(graph), namespace)
    made = namespace["model"]()  # type: ignore[operator]
    assert made.finish() == graph
    assert pickle.loads(pickle.dumps(graph)) == graph
    assert compile_model(derive(graph)).n_states == 2


def test_renaming_reaches_ports_and_laws() -> None:
    field = IField.from_matrix("coils", [[L1, M], [M, L2]])
    renamed = Renaming({"coils": "x"}, {"M": "N"}).node(field)
    N = sympy.Symbol("N", real=True)
    assert renamed == IField.from_matrix("x", [[L1, N], [N, L2]])


x, y = ports("q", 2)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: CField("c", (x + y, y)), "not reciprocal"),
        (lambda: CField("c", (port("f", 1),)), "use f"),
        (lambda: CField("c", (x, port("q", 3))), "it has 2 ports"),
        (lambda: CField("c", ()), "no port"),
        (lambda: CField.from_energy("c", y**2), "depends on the ports"),
        (lambda: IField.from_matrix("m", [[1, 2]]), "1 x 2"),
        (lambda: RField("r", (port("q", 1),)), "use q"),
        (lambda: port("z", 1), "no variable 'z'"),
    ],
)
def test_laws_that_cannot_be_a_field_are_refused(make: object, said: str) -> None:
    with pytest.raises(StructureError, match=said):
        make()  # type: ignore[operator]


def test_a_field_needs_a_junction_for_every_port() -> None:
    graph = BondGraph("half")
    graph.one("a", Se("u"))
    graph.put(IField.from_matrix("coils", [[L1, M], [M, L2]]), on=("a",))
    with pytest.raises(StructureError, match="has 1 bonds and needs 2"):
        graph.finish()


def test_nonlinear_laws_that_need_not_be_unique_are_refused_by_name() -> None:
    graph = BondGraph("double well")
    graph.zero("a", Se("u"))
    graph.zero("b", R("r"))
    wells = x**4 / 4 - x**2 + x * y + y**2
    graph.put(CField.from_energy("wells", wells), on=("a", "b"))
    with pytest.raises(EquationError, match=r"wells.*need not be unique") as refusal:
        derive(graph.finish())
    assert "wells" in refusal.value.about
    assert isinstance(refusal.value, BondGraphError)


def two_springs_in_one(energy: sympy.Expr) -> FinishedGraph:
    """Return a field of which one port is a state and the other follows a source."""
    graph = BondGraph("two springs in one")
    graph.one("a", Sf("v"), R("r1"))
    graph.zero("b", Se("u"))
    graph.put(CField.from_energy("field", energy), on=("a", "b"))
    graph.measure("force", effort="field[1]")
    return graph.finish()


def test_only_ports_that_follow_need_a_law_that_is_unique() -> None:
    # The first port is a state, so that its stiffness may be negative.
    first, second = ports("q", 2)
    field = second**2 / 2 + second**4 / 4 - first**2 / 2
    assert derive(two_springs_in_one(field)).unknowns
    with pytest.raises(EquationError, match="need not be unique"):
        derive(two_springs_in_one(first**2 / 2 - second**2 / 2 + second**4 / 4))


def test_laws_that_fall_at_both_ports_are_refused_too() -> None:
    # The determinant of their slopes is positive, and neither slope is.
    first, second = ports("q", 2)
    graph = BondGraph("falling")
    graph.zero("a", Se("u"))
    graph.zero("b", Se("w"))
    falling = -(first**2) / 2 - first**4 - second**2 / 2 - second**4
    graph.put(CField.from_energy("field", falling), on=("a", "b"))
    with pytest.raises(EquationError, match="need not be unique"):
        derive(graph.finish())
