"""Graphs that look for trouble: whatever is derived must satisfy the raw equations.

No answer is written here. Each graph puts together what a careless derivation would
get wrong: moduli that read inputs, time or efforts; laws that read what they bring
about; stores that depend on one another through curved laws; fields held from outside.
"""

from collections.abc import Callable

import pytest
import sympy
from catalogue.comparison import compare_with_raw
from sympy import Abs, Heaviside, Piecewise, cos, exp, sin, sinh, tanh

from bondgraph import (
    GY,
    TF,
    BondGraph,
    C,
    CField,
    De,
    Df,
    Dp,
    Dq,
    I,
    ICField,
    IField,
    R,
    RField,
    Se,
    Sf,
    displacement,
    e,
    effort,
    f,
    flow,
    momentum,
    q,
    t,
)
from bondgraph.structure.signals import port, ports

a, b, c, d, m, mu = sympy.symbols("a b c d m mu")
WRITERS: list[Callable[[BondGraph], None]] = []


def probe(write: Callable[[BondGraph], None]) -> Callable[[BondGraph], None]:
    WRITERS.append(write)
    return write


@pytest.mark.parametrize("write", WRITERS, ids=lambda write: write.__name__)
def test_what_is_derived_satisfies_the_raw_equations(
    write: Callable[[BondGraph], None],
) -> None:
    graph = BondGraph(write.__name__)
    write(graph)
    compare_with_raw(graph.finish())


# Moduli that move -----------------------------------------------------------------


def geared(g: BondGraph, modulus: sympy.Expr) -> None:
    g.one("left", Se("u"), I("j1"))
    g.one("right", I("j2"), R("b"))
    g.join("left", TF("gear", law=modulus), "right")
    g.measure("y", effort="j2")


@probe
def ratio_set_by_an_input(g: BondGraph) -> None:
    g.zero("command", Se("ratio"))
    geared(g, effort("command"))


@probe
def ratio_that_follows_time(g: BondGraph) -> None:
    geared(g, 1 + sin(t) / 2)


@probe
def ratio_by_a_momentum(g: BondGraph) -> None:
    geared(g, 1 + momentum("j1") ** 2)


@probe
def ratio_by_a_flow(g: BondGraph) -> None:
    geared(g, 1 + flow("left") ** 2)


@probe
def ratio_by_the_position_behind_it(g: BondGraph) -> None:
    geared(g, cos(displacement("right")))


@probe
def ratio_by_its_own_effort(g: BondGraph) -> None:
    g.one("left", Se("u"), I("m"))
    g.zero("right", C("store"))
    g.join("left", TF("k", law=1 + effort("k>right") ** 2), "right")


@probe
def ratio_by_its_own_flow(g: BondGraph) -> None:
    g.one("left", Se("u"), I("m"))
    g.one("right", R("r"))
    g.join("left", TF("k", law=1 + flow("k>right") ** 2), "right")


@probe
def gyrator_by_a_flow_in_its_loop(g: BondGraph) -> None:
    g.one("left", Se("u"), R("r1"))
    g.one("right", R("r2"))
    g.join("left", GY("k", law=1 + flow("right") ** 2), "right")


@probe
def position_of_a_source_moves_a_ratio(g: BondGraph) -> None:
    g.one("cam", Sf("u"), R("r"))
    g.one("rod", I("j"))
    g.join("rod", TF("k", law=cos(displacement("cam"))), "cam")
    g.measure("y", effort="u")


@probe
def two_moving_gears_in_a_row(g: BondGraph) -> None:
    g.one("first", Se("u"), I("m1"))
    g.one("second", I("m2"))
    g.one("third", I("m3"), R("r"))
    for tail, head in (("first", "second"), ("second", "third")):
        law = 1 + sin(displacement(tail)) / 2
        g.join(tail, TF(f"by_{tail}", law=law), head)
    g.measure("y", effort="m3")


@probe
def chain_of_dependent_stores(g: BondGraph) -> None:
    g.zero("first", C("c1"), Sf("i"))
    g.zero("second", C("c2"))
    g.zero("third", C("c3"), R("r"))
    g.join("first", TF("k1", law=1 + sin(t) / 3), "second")
    g.join("second", TF("k2", law=1 + momentum("first") ** 2), "third")
    g.measure("z", flow="c3")


@probe
def moving_gyrator_to_a_dependent_store(g: BondGraph) -> None:
    g.one("left", Se("u"), I("m"))
    g.zero("right", C("store"))
    g.join("left", GY("k", law=1 + displacement("left")), "right")
    g.measure("z", flow="store")


# Laws that read elsewhere ---------------------------------------------------------


@probe
def resistance_that_reads_an_effort_of_its_loop(g: BondGraph) -> None:
    g.one("source", Se("u"), R("r1"))
    g.zero("middle", R("r3", law=f * (1 + effort("r1") ** 2)))
    g.one("branch", R("r2"), C("store"))
    g.join("source", "middle")
    g.join("middle", "branch")


@probe
def friction_under_the_effort_of_a_dependent_inertia(g: BondGraph) -> None:
    rub = R("rub", law=mu * Abs(effort("load")) * tanh(f))
    g.one("left", Se("u"), I("j1"), rub)
    g.one("right", I("load"), R("b"))
    g.join("left", TF("n"), "right")


@probe
def friction_under_the_effort_of_a_bond(g: BondGraph) -> None:
    g.one("left", Se("u"), I("j1"), R("rub", law=mu * effort("n>right") * tanh(f)))
    g.one("right", I("load"), R("b"))
    g.join("left", TF("n"), "right")


@probe
def resistance_that_reads_its_own_effort(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r", law=f * (1 + effort("r") ** 2)), C("store"))


@probe
def store_that_reads_its_own_displacement(g: BondGraph) -> None:
    g.one("loop", Se("u"), C("store", law=q * (1 + displacement("store"))), R("r"))


@probe
def dependent_store_that_reads_a_position(g: BondGraph) -> None:
    g.zero("node", Se("u"), C("store", law=a * q * (1 + displacement("axis"))))
    g.one("axis", Se("w"), I("m"))
    g.measure("i", flow="store")


@probe
def source_that_reads_its_own_flow(g: BondGraph) -> None:
    g.one("loop", Se("u"), Se("w", value=-a * flow("w")), I("m"))


@probe
def mass_that_grows_in_time(g: BondGraph) -> None:
    g.one("moved", Sf("u"), I("m", law=f * (1 + t)))
    g.measure("y", effort="u")


@probe
def law_that_switches_on_a_signal(g: BondGraph) -> None:
    steep = Piecewise((f, flow("loop") > 1), (2 * f, True))
    g.one("loop", Se("u"), I("m"), R("r", law=steep))


@probe
def law_that_starts_at_a_position(g: BondGraph) -> None:
    law = f * Heaviside(displacement("loop") - 1)
    g.one("loop", Se("u"), I("m"), R("r", law=law))


# Curved stores that depend on one another -----------------------------------------


@probe
def cubic_store_on_a_source(g: BondGraph) -> None:
    g.zero("node", Se("u"), C("store", law=q + q**3), R("r"))
    g.measure("i", flow="u")


@probe
def two_curved_stores_by_displacement(g: BondGraph) -> None:
    g.zero("node", Sf("i"), C("c1", law=q + q**3), C("c2", law=q + 2 * q**5))
    g.measure("i2", flow="c2")


@probe
def two_curved_stores_by_effort(g: BondGraph) -> None:
    g.zero("node", R("r"), C("c1", law=e + e**3), C("c2", law=e + 2 * e**5))
    g.measure("i2", flow="c2")


@probe
def two_curved_inertias_and_a_curved_friction(g: BondGraph) -> None:
    first, second = I("i1", law=f + f**3), I("i2", law=f + 2 * f**3)
    g.one("shaft", Se("u"), first, second, R("r", law=f + f**3))
    g.measure("y", effort="i2")


@probe
def two_diodes_and_a_resistance(g: BondGraph) -> None:
    g.parameter("a", 1.0)
    g.parameter("b", 1.0)
    one, other = (R(f"d{k}", law=x * (exp(e) - 1)) for k, x in enumerate((a, b)))
    g.one("loop", Se("u"), one, other, R("r"))


@probe
def exponential_and_logarithmic_stores(g: BondGraph) -> None:
    g.one("left", Se("u"), R("r"), C("c1", law=exp(q) - 1))
    g.zero("right", C("c2", law=sympy.log(1 + q)))
    g.join("left", "right")


# Integrals ------------------------------------------------------------------------


@probe
def integrals_of_inputs_and_elements(g: BondGraph) -> None:
    g.one("loop", Se("u"), I("m"), R("r"))
    g.measure("impulse", momentum("u"))
    g.measure("way", displacement("u"))
    g.measure("stored", momentum("m"))
    g.measure("lost", momentum("r"))


@probe
def sensors_of_all_four_kinds(g: BondGraph) -> None:
    g.one("mass", Se("u"), I("m"), Df("speed"), Dq("way"))
    g.zero("node", C("store"), De("force"), Dp("impulse"))
    g.join("mass", "node")


@probe
def names_that_other_symbols_have(g: BondGraph) -> None:
    g.one("loop", Se("q_store"), R("e_r"), C("store"), R("f_loop"), R("pi"))
    g.measure("y", effort="e_r")


@probe
def wishes_against_the_usual_choice(g: BondGraph) -> None:
    g.one("loop", Se("u"), I("m1"), I("m2"), R("r1"))
    g.zero("node", R("r2"), C("store"))
    g.join("loop", "node")
    g.prefer("m1", "derivative")
    g.prefer("r2", "effort")


# Fields ---------------------------------------------------------------------------


@probe
def mass_matrix_of_three_with_one_geared(g: BondGraph) -> None:
    matrix = [[a, b, 0], [b, c, d], [0, d, m]]
    g.one("x", Se("u"), R("r1"))
    g.one("y", R("r2"))
    g.one("z")
    g.join("x", TF("n"), "z")
    g.put(IField.from_matrix("M", matrix), on=("x", "y", "z"))
    g.measure("w", flow="z")


@probe
def compliance_field_beside_a_store(g: BondGraph) -> None:
    g.zero("x", Sf("u"), C("store"))
    g.zero("y", R("r"))
    g.put(CField.from_matrix("K", [[a, b], [b, c]]), on=("x", "y"))


@probe
def inertance_field_beside_an_inertia(g: BondGraph) -> None:
    g.one("x", Se("u"))
    g.one("y", I("j"))
    g.put(IField.from_matrix("M", [[a, b], [b, c]]), on=("x", "y"))


@probe
def resistance_field_in_a_loop(g: BondGraph) -> None:
    g.one("x", Se("u"), R("r"))
    g.zero("y", C("store"))
    g.put(RField.from_matrix("K", [[a, b], [b, c]]), on=("x", "y"))


@probe
def gyrating_resistance_field(g: BondGraph) -> None:
    g.one("x", Se("u"), I("j"))
    g.zero("y", Sf("w"))
    g.put(RField.from_matrix("K", [[a, b], [-b, c]]), on=("x", "y"))
    g.measure("y", effort="y")


@probe
def curved_resistance_field_in_mixed_causality(g: BondGraph) -> None:
    e1, e2 = ports("e", 2)
    g.parameter("c", 1.0)
    g.one("x", Se("u"), R("r"), I("l"))
    g.zero("y", C("store"))
    laws = (a * e1 + b * e2, b * e1 + c * sinh(e2))
    g.put(RField("K", laws), on=("x", "y"))


@probe
def solenoid_beside_an_inductance(g: BondGraph) -> None:
    energy = port("p", 1) ** 2 * (1 + port("q", 2) / d) / (2 * a)
    g.one("x", Se("u"), R("r"), I("l"))
    g.one("y", I("j"), C("k"), Se("w", value=-m * t))
    g.put(ICField.from_energy("coil", energy), on=("x", "y"))


@probe
def solenoid_driven_by_a_current(g: BondGraph) -> None:
    flux, x = port("p", 1), port("q", 2)
    g.one("x", Sf("u"))
    g.one("y", I("j"))
    energy = flux**2 * (1 + x) + x**2
    g.put(ICField.from_energy("coil", energy), on=("x", "y"))
    g.measure("v", effort="u")


@probe
def plates_held_by_a_voltage(g: BondGraph) -> None:
    charge, x = ports("q", 2)
    g.zero("x", Se("u"))
    g.one("y", I("j"), R("r"))
    g.put(CField.from_energy("plates", charge**2 * (d + x) / a), on=("x", "y"))
    g.measure("i", flow="u")


@probe
def plates_moved_by_a_source(g: BondGraph) -> None:
    charge, x = ports("q", 2)
    g.one("x", Se("u"), R("r"))
    g.one("y", Sf("v"))
    g.put(CField.from_energy("plates", charge**2 * (d + x) / a), on=("x", "y"))
    g.measure("force", effort="v")


# Parts in parts -------------------------------------------------------------------


@probe
def chain_of_chains(g: BondGraph) -> None:
    cell = BondGraph("cell")
    cell.zero("node", C("store"))
    cell.one("link", R("r"), I("l"))
    cell.join("node", "link")
    pair = BondGraph("pair")
    pair.repeat(cell, 2, "cell", chain=("link", "node"))
    first, _ = g.repeat(pair, 2, "pair", chain=("cell2_link", "cell1_node"))
    g.put(Sf("i"), on=first["cell1_node"])


@probe
def parts_with_laws_that_read_signals(g: BondGraph) -> None:
    part = BondGraph("part")
    law = mu * tanh(f / a) * displacement("axis")
    part.one("axis", I("inertia"), R("rub", law=law))
    part.measure("way", displacement="axis")
    g.zero("hub", C("store"), Sf("i"))
    for name in ("left", "right"):
        g.join("hub", g.include(part, name, shared=("mu",))["axis"])


@probe
def parts_with_fields(g: BondGraph) -> None:
    q1, q2 = ports("q", 2)
    part = BondGraph("part")
    part.one("wire")
    part.one("arm", R("r"))
    energy = q1**2 * (1 + q2) + q2**2
    part.put(CField.from_energy("plates", energy), on=("wire", "arm"))
    part.expose("wire")
    g.one("circuit", Se("u"), R("inner"))
    for name in ("left", "right"):
        g.join("circuit", g.include(part, name)["wire"])


def test_there_are_enough_of_them() -> None:
    assert len(WRITERS) >= 40
