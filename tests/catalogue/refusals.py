"""Graphs that have no equations, with the names that a refusal must give."""

from collections.abc import Callable
from dataclasses import dataclass

import sympy

from bondgraph import (
    GY,
    TF,
    BondGraph,
    C,
    I,
    R,
    Se,
    Sf,
    displacement,
    e,
    effort,
    f,
    q,
)
from bondgraph.errors import (
    BondGraphError,
    CausalConflictError,
    EquationError,
    StructureError,
)
from bondgraph.structure.fields import CField, IField, RField
from bondgraph.structure.signals import ports


@dataclass(frozen=True)
class Refusal:
    """One graph, the kind of refusal, and names that its message must contain.

    ``write`` may itself raise, where the author's call is what is wrong.
    """

    name: str
    write: Callable[[BondGraph], None]
    error: type[BondGraphError]
    names: tuple[str, ...]


REFUSALS: list[Refusal] = []


def refused(
    error: type[BondGraphError], *names: str
) -> Callable[[Callable[[BondGraph], None]], None]:
    """Add the decorated writer to the list."""

    def add(write: Callable[[BondGraph], None]) -> None:
        REFUSALS.append(Refusal(write.__name__, write, error, names))

    return add


# Causal conflicts -----------------------------------------------------------------


@refused(CausalConflictError, "node", "'one'", "'two'")
def two_efforts_on_a_node(g: BondGraph) -> None:
    g.zero("node", Se("one"), Se("two"), R("r"))


@refused(CausalConflictError, "loop", "'one'", "'two'")
def two_flows_in_a_loop(g: BondGraph) -> None:
    g.one("loop", Sf("one"), Sf("two"), I("m"))


@refused(CausalConflictError, "'one'", "'two'", "gear")
def two_flows_across_a_transformer(g: BondGraph) -> None:
    g.one("fast", Sf("one"), R("b"))
    g.one("slow", Sf("two"), I("j"))
    g.join("fast", TF("gear"), "slow")


@refused(CausalConflictError, "'one'", "'two'", "motor")
def effort_and_flow_across_a_gyrator(g: BondGraph) -> None:
    g.zero("wire", Se("one"))
    g.one("shaft", Sf("two"))
    g.join("wire", GY("motor"), "shaft")


@refused(CausalConflictError, "shaft")
def nothing_gives_a_flow(g: BondGraph) -> None:
    g.one("shaft", Se("one"), Se("two"))


@refused(CausalConflictError, "node")
def nothing_gives_an_effort(g: BondGraph) -> None:
    g.zero("node", Sf("one"), Sf("two"))


@refused(CausalConflictError, "'supply'", "'held'")
def a_source_across_a_chain_of_equal_efforts(g: BondGraph) -> None:
    g.zero("left", Se("supply"))
    g.zero("middle", C("c"))
    g.zero("right", Se("held"))
    g.join("left", "middle")
    g.join("middle", "right")


# Structure ------------------------------------------------------------------------


@refused(StructureError, "'r'", "2 times")
def one_name_for_two_elements(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r"))
    g.put(I("r"), on="loop")


@refused(StructureError, "'lop'", "loop")
def a_junction_that_is_not_there(g: BondGraph) -> None:
    g.one("loop", Se("u"))
    g.put(R("r"), on="lop")


@refused(StructureError, "'alone'")
def a_junction_without_a_bond(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r"))
    g.zero("alone")


@refused(StructureError, "loop")
def a_junction_joined_to_itself(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r"))
    g.join("loop", "loop")


@refused(StructureError, "'r'", "e, f")
def a_law_of_both_variables(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r", law=e * f))


@refused(StructureError, "'c'", "f")
def a_capacitor_written_in_its_flow(g: BondGraph) -> None:
    g.one("loop", Se("u"), C("c", law=f))


@refused(StructureError, "'drive'", "elsewhere")
def a_source_that_reads_a_place_that_is_not_there(g: BondGraph) -> None:
    g.one("loop", Se("drive", value=effort("elsewhere")), R("r"))


@refused(StructureError, "'look'", "shaft")
def the_effort_of_a_common_flow(g: BondGraph) -> None:
    g.one("shaft", Se("u"), I("j"))
    g.measure("look", effort="shaft")


@refused(StructureError, "'gear'")
def a_transformer_as_a_one_port(g: BondGraph) -> None:
    g.one("shaft", Se("u"), I("j"))
    g.put(TF("gear"), on="shaft")  # type: ignore[arg-type]


@refused(StructureError, "'2nd'")
def a_name_that_is_none(g: BondGraph) -> None:
    g.one("shaft", Se("u"), I("2nd"))


@refused(StructureError, "'pair'", "reciprocal")
def a_storage_field_that_makes_energy(g: BondGraph) -> None:
    k, a = sympy.symbols("k a")
    q1, q2 = ports("q", 2)
    g.one("left", Se("u"))
    g.one("right", R("b"))
    g.put(CField("pair", (k * q1 + a * q2, k * q2)), on=("left", "right"))


@refused(StructureError, "'pair'")
def a_field_on_too_few_junctions(g: BondGraph) -> None:
    m = sympy.Symbol("m")
    g.one("left", Se("u"))
    g.put(IField.from_matrix("pair", [[m, 0], [0, m]]), on="left")


@refused(StructureError, "'pair'")
def a_resistance_field_of_mixed_laws(g: BondGraph) -> None:
    e1, _ = ports("e", 2)
    _, f2 = ports("f", 2)
    g.one("left", Se("u"))
    g.one("right", Se("v"))
    g.put(RField("pair", (e1, f2)), on=("left", "right"))


# Equations ------------------------------------------------------------------------


@refused(EquationError, "'slip'")
def dry_friction_that_must_give_its_speed(g: BondGraph) -> None:
    g.zero("node", C("c"), R("slip", law=sympy.Symbol("tau") * sympy.sign(f)))


@refused(EquationError, "'store'")
def a_store_that_has_two_contents(g: BondGraph) -> None:
    g.zero("node", Se("u"), C("store", law=sympy.Symbol("k") * q**2))


@refused(EquationError, "first", "second")
def one_ratio_given_twice(g: BondGraph) -> None:
    n = sympy.Symbol("n")
    g.one("left", Se("u"), I("m"))
    g.one("right", R("b"))
    g.join("left", TF("first", law=n), "right")
    g.join("left", TF("second", law=n), "right")


@refused(EquationError, "aa")
def a_ring_that_passes_an_effort_round(g: BondGraph) -> None:
    for name in ("aa", "bb", "cc"):
        g.zero(name)
    for tail, head in (("aa", "bb"), ("bb", "cc"), ("cc", "aa")):
        g.join(tail, head)


@refused(EquationError, "'u'")
def one_name_for_an_input_and_a_parameter(g: BondGraph) -> None:
    g.one("loop", Se("u"), R("r", law=sympy.Symbol("u") * f))


@refused(EquationError, "gain")
def an_amplifier_that_follows_itself(g: BondGraph) -> None:
    g.zero("node", Se("gain", value=effort("node")), R("r"))


@refused(EquationError, "'m'")
def a_second_derivative(g: BondGraph) -> None:
    g.one("moved", Sf("v"), I("m"))
    g.zero("copy", Se("held", value=effort("m")), C("c"))
    g.measure("i", flow="c")


@refused(EquationError, "law", "'valve'")
def a_valve_that_is_shut_and_must_pass(g: BondGraph) -> None:
    shut = sympy.Max(displacement("tank"), 0) * 0 + sympy.Heaviside(f)
    g.zero("node", C("tank"), R("valve", law=shut))
