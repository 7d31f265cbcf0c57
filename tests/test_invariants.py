"""First integrals that follow from the structure, and states one can do without."""

import random
from dataclasses import replace

import pytest
import sympy
from catalogue import CASES, Case, agree, expression, somewhere

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.power.invariants import invariants
from bondgraph.equations.reduction import reduce
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.elements import GY, TF, C, I, R, Se, Sf
from bondgraph.structure.fields import IField
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.signals import displacement, f


def integrals(graph: BondGraph) -> list[str]:
    found = invariants(graph.finish())
    return [str(integral.expression) for integral in found.first_integrals]


def same(one: sympy.Expr, other: sympy.Expr) -> bool:
    """Return whether long expressions agree at numbers; `agree` substitutes slowly."""
    put = {
        x: sympy.Float(v)
        for x, v in somewhere(one.free_symbols | other.free_symbols).items()
    }
    first, second = (complex(x.xreplace(put)) for x in (one, other))
    return abs(first - second) <= 1e-9 * max(1.0, abs(first), abs(second))


def rate(total: sympy.Expr, graph: FinishedGraph) -> sympy.Expr:
    """Return the time derivative of an expression in states and inputs."""
    equations = derive(graph)
    rates = reduce(equations).explicit()
    terms = [
        total.diff(s.symbol) * x for s, x in zip(equations.states, rates, strict=True)
    ]
    terms += [
        total.diff(u) * du
        for u, du in zip(equations.inputs, equations.input_rates, strict=True)
    ]
    return sympy.Add(*terms)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_what_is_said_to_be_constant_is(case: Case) -> None:
    graph = case.graph()
    found = invariants(graph)
    claimed = [integral.expression for integral in found.first_integrals]
    claimed += [expression(r.state) - r.through for r in found.redundant]
    claimed += [found.energy] if found.energy is not None else []
    for total in claimed:
        assert same(rate(total, graph), sympy.S.Zero), total


def test_the_catalogue_has_the_integrals_that_are_known() -> None:
    by_name = {case.name: case for case in CASES}

    def found(name: str) -> list[sympy.Expr]:
        graph = by_name[name].graph()
        return [i.expression for i in invariants(graph).first_integrals]

    (water,) = found("u_tube")
    assert agree(water, expression("q_left + q_right"))
    (charge,) = found("capacitors_in_series")
    assert agree(charge, expression("q_c2 - q_c1"))
    assert found("rlc_series") == []
    assert found("dc_motor") == []


def test_momentum_is_conserved_whatever_acts_between() -> None:
    """Two carts with a spring and any friction between them: p1 + p2."""
    graph = BondGraph("two carts")
    graph.one("first", I("m1"))
    graph.zero("between")
    graph.one("buffer", C("c"), R("rub", law=sympy.Symbol("mu") * sympy.sign(f)))
    graph.one("second", I("m2"))
    for tail, head in (("first", "between"), ("between", "buffer")):
        graph.join(tail, head)
    graph.join("between", "second")
    found = invariants(graph.finish())
    (momentum,) = found.first_integrals
    assert agree(momentum.expression, expression("p_m1 + p_m2"))
    assert momentum.places == ("m1", "m2")
    (redundant,) = found.redundant
    assert redundant.state == "p_m2"
    assert agree(redundant.through, expression("-p_m1"))
    assert found.energy is None


def test_a_gear_scales_the_momentum() -> None:
    """TF with w_a = k w_b: k p_a + p_b feels no torque between the two."""
    graph = BondGraph("geared wheels")
    graph.one("fast", I("ja"))
    graph.zero("shaft", C("c"))
    graph.one("slow", I("jb"))
    graph.join("fast", "shaft")
    graph.join("shaft", TF("k"), "slow")
    (integral,) = invariants(graph.finish()).first_integrals
    total = integral.expression / integral.expression.coeff(
        sympy.Symbol("p_jb", real=True)
    )
    assert agree(total, expression("k*p_ja + p_jb"))


def test_a_gyrator_ties_momentum_to_displacement() -> None:
    """A charge on C behind a gyrator: dp/dt = -r dq/dt, so p + r q stays."""
    graph = BondGraph("gyrated")
    graph.one("coil", I("l"))
    graph.one("plate", C("c"), R("r1"))
    graph.join("coil", GY("r"), "plate")
    (integral,) = invariants(graph.finish()).first_integrals
    total = integral.expression / integral.expression.coeff(
        sympy.Symbol("p_l", real=True)
    )
    assert agree(total, expression("p_l + r*q_c"))
    assert integral.statement.startswith("The combination")


def test_two_integrals_of_one_motion_are_redundant() -> None:
    graph = BondGraph("gearbox with two encoders")
    graph.one("motor", Se("torque"), I("jm"))
    graph.one("load", R("b"))
    graph.join("motor", TF("k"), "load")
    graph.measure("motor_angle", displacement="motor")
    graph.measure("load_angle", displacement="load")
    found = invariants(graph.finish())
    (redundant,) = found.redundant
    assert redundant.state == "q_motor"
    assert agree(redundant.through, expression("k*q_load"))
    assert found.measured_only == ("q_motor", "q_load")


def test_a_dependent_storage_takes_part() -> None:
    """Two inertias on a free shaft: p1 + j2/j1 p1 stays."""
    graph = BondGraph("free shaft")
    graph.one("shaft", I("j1"), I("j2"))
    found = invariants(graph.finish())
    (integral,) = found.first_integrals
    assert agree(integral.expression, expression("p_j1 + j2*p_j1/j1"))
    assert found.redundant == ()
    assert found.energy is not None


def test_a_modulus_that_moves_binds_nothing() -> None:
    graph = BondGraph("crank")
    law = sympy.Symbol("l") * sympy.sin(displacement("wheel"))
    graph.one("wheel", I("j"))
    graph.zero("rod", C("c"))
    graph.one("slider", I("m"))
    graph.join("wheel", TF("arm", law=1 / law), "rod")
    graph.join("rod", "slider")
    found = invariants(graph.finish())
    assert found.first_integrals == ()
    assert found.energy is not None


def test_a_source_ends_conservation() -> None:
    graph = BondGraph("pushed carts")
    graph.one("first", Se("push"), I("m1"))
    graph.zero("between", C("c"))
    graph.one("second", I("m2"))
    graph.join("first", "between")
    graph.join("between", "second")
    assert integrals(graph) == []


def test_rings_of_ratios_are_multiplied_exactly() -> None:
    """Round a ring of gears 2 · 3 · 1/6 = 1: the two ways give one motion."""
    graph = BondGraph("two ways")
    graph.zero("start", C("c0"), Sf("turn"))
    graph.one("upper", C("c1"))
    graph.one("lower", C("c2"))
    graph.join("start", TF("two", law=sympy.Integer(2)), "upper")
    graph.join("start", TF("k"), "lower")
    found = invariants(graph.finish())
    assert found.first_integrals == ()
    graph = BondGraph("two readings")
    graph.one("axle", Sf("turn"), R("r"))
    graph.one("upper", C("c1"), R("r1"))
    graph.one("lower", C("c2"), R("r2"))
    a, b = sympy.symbols("a b")
    graph.join("axle", TF("up", law=a + b), "upper")
    graph.join("axle", TF("down", law=(a**2 - b**2) / (a - b)), "lower")
    (same,) = invariants(graph.finish()).first_integrals
    assert agree(same.expression, expression("q_c2 - q_c1"))


def test_fields_take_part_by_port() -> None:
    graph = BondGraph("coupled carts")
    graph.one("left", C("c1"))
    graph.one("right", C("c2"))
    graph.zero("rope")
    graph.join("left", "rope")
    graph.join("rope", "right")
    k1, k12, k2 = sympy.symbols("k1 k12 k2")
    graph.put(IField.from_matrix("mass", [[k1, k12], [k12, k2]]), on=("left", "right"))
    found = invariants(graph.finish())
    assert len(found.first_integrals) == 1
    assert "c1" in found.first_integrals[0].places


def test_energy_is_constant_where_nothing_changes_it() -> None:
    graph = BondGraph("oscillator")
    graph.one("mass", I("m"), C("c"))
    found = invariants(graph.finish())
    assert found.energy is not None
    assert agree(found.energy, expression("p_m**2/(2*m) + q_c**2/(2*c)"))
    assert "is constant" in found.as_text()


def test_what_nothing_reads_is_named() -> None:
    graph = BondGraph("counter")
    graph.one("loop", Se("u"), C("weight", law=sympy.Symbol("k")), R("r"))
    found = invariants(graph.finish())
    assert found.unread == ("q_weight",)
    assert "read by nothing" in found.as_text()


def chain(length: int, turned: random.Random) -> FinishedGraph:
    graph = BondGraph("train")
    graph.one("cart0", I("m0"))
    for i in range(length):
        graph.zero(f"hook{i}")
        graph.one(f"buffer{i}", C(f"c{i}"), R(f"r{i}"))
        graph.one(f"cart{i + 1}", I(f"m{i + 1}"))
        for pair in (
            (f"cart{i}", f"hook{i}"),
            (f"hook{i}", f"buffer{i}"),
            (f"hook{i}", f"cart{i + 1}"),
        ):
            graph.join(*turned.sample(pair, 2))
    return graph.finish()


@pytest.mark.parametrize("length", [10, 50, 200])
def test_a_train_keeps_its_momentum(length: int) -> None:
    graph = chain(length, random.Random(length))
    (integral,) = invariants(graph, derive(graph)).first_integrals
    terms = integral.expression.as_coefficients_dict()
    assert len(terms) == length + 1
    assert {abs(factor) for factor in terms.values()} == {1}


def test_latex_shows_the_integrals() -> None:
    graph = BondGraph("free cart")
    graph.one("mass", I("m"))
    assert "p_{m}" in invariants(graph.finish())._repr_latex_()
    driven = BondGraph("cart")
    driven.one("mass", Se("u"), I("m"))
    assert "no first integral" in invariants(driven.finish()).as_latex()


@pytest.mark.parametrize("turned", [(), ("c",), ("rub",), ("c", "rub")], ids=str)
def test_an_arrow_that_is_turned_turns_no_content(turned: tuple[str, ...]) -> None:
    """A mass gives its momentum to friction; two springs on it are stretched alike."""
    loop = BondGraph("loop")
    loop.one("loop", I("l"), C("first"), C("c"), R("r"))
    slowed = BondGraph("slowed")
    slowed.one("body", I("m"), R("rub"))
    slowed.measure("impulse", momentum="rub")
    for graph, expected in ((loop, "q_first - q_c"), (slowed, "p_m + p_rub")):
        finished = graph.finish()
        bonds = tuple(
            Bond(b.head, b.tail) if {b.head, b.tail} & set(turned) else b
            for b in finished.bonds
        )
        finished = replace(finished, bonds=bonds)
        (integral,) = invariants(finished).first_integrals
        assert agree(integral.expression**2, expression(expected) ** 2)
        assert same(rate(integral.expression, finished), sympy.S.Zero)


def test_an_integral_at_a_junction_takes_part() -> None:
    graph = BondGraph("slowed")
    graph.one("body", I("m"))
    graph.zero("node", R("r"))
    graph.join("body", "node")
    graph.measure("impulse", momentum="node")
    finished = graph.finish()
    (integral,) = invariants(finished).first_integrals
    assert agree(integral.expression**2, expression("p_m + p_node") ** 2)
    assert same(rate(integral.expression, finished), sympy.S.Zero)
