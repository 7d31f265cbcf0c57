"""A graph printed as Python makes the same graph; two versions are told apart."""

from dataclasses import replace
from typing import Any

import pytest
import sympy

from bondgraph.errors import EquationError
from bondgraph.reporting.model_text import describe_difference, to_python
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.edits import (
    InsertElement,
    ReplaceMeasurement,
    ReplaceRelation,
)
from bondgraph.structure.elements import GY, TF, C, I, R, Se, Sf
from bondgraph.structure.graph import Bond, FinishedGraph
from bondgraph.structure.parameters import (
    Assumed,
    Fitted,
    Measured,
    Parameter,
    ParameterSet,
    Published,
    Reconciled,
)
from bondgraph.structure.signals import displacement, effort, f, flow, q, t
from flegx_models.models import (
    lowerleg_flight,
    lowerleg_stance,
    upperleg_flight,
    upperleg_stance,
)

mu, tau, v_s, k = sympy.symbols("mu tau v_s k")


def remade(text: str) -> FinishedGraph:
    namespace: dict[str, Any] = {}
    exec(compile(text, "model.py", "exec"), namespace)
    return namespace["model"]().finish()


def motor() -> FinishedGraph:
    """Two domains, sources, a gyrator, a transformer with a law, all provenances."""
    graph = BondGraph("a DC motor", domain="rotation")
    graph.one("armature", Se("u_supply"), R("R_a"), I("L_a"), domain="electrical")
    graph.one("shaft", I("J"), R("bearing", law=mu * f + tau * sympy.sign(f)))
    graph.zero("coupling", C("twist", law=k * q + 2.5 * q**3 / 7))
    graph.one("load", I("J_load"), Sf("wind", value=0.1 * sympy.sin(2 * sympy.pi * t)))
    graph.join("armature", GY("k_t"), "shaft")
    graph.join("shaft", "coupling")
    graph.join("coupling", TF("n", law=3 - sympy.cos(displacement("shaft"))), "load")
    graph.measure("angle", displacement="shaft")
    graph.measure("twist_torque", effort="twist", unit="N*m")
    graph.measure("power", effort("coupling") * flow("shaft"), unit="W")
    graph.parameter("R_a", 1.5, "ohm", std=0.0, source=Published('sheet "A" \\ p. 3'))
    graph.parameter("L_a", 3e-3, "H", bounds=(0, 1), source=Measured(method="bridge"))
    graph.parameter("J", 1.0 / 3.0, "kg*m^2", source=Reconciled("so that it's 176.76"))
    graph.parameter("mu", 0.1, "N*m*s", std=0.02, source=Fitted(("run 1", "run 2")))
    graph.parameter("k_t", 0.05, "N*m/A", source=Assumed("line 1\nline 2"))
    graph.parameter("tau", bounds=(0.0, float("inf")))
    return graph.finish()


def ladder() -> FinishedGraph:
    graph = BondGraph("ladder")
    for n in range(6):
        (graph.one if n % 2 else graph.zero)(
            f"j{n}", C(f"c{n}") if n % 2 else I(f"m{n}")
        )
        if n:
            graph.join(f"j{n - 1}", f"j{n}")
    graph.put(Se("push"), on="j0")
    return graph.finish()


GRAPHS = [
    motor(),
    ladder(),
    lowerleg_flight().finish(),
    upperleg_flight().finish(),
    lowerleg_stance().finish(),
    upperleg_stance().finish(),
]


@pytest.mark.parametrize("graph", GRAPHS, ids=lambda g: g.name)
def test_running_the_text_gives_an_equal_graph(graph: FinishedGraph) -> None:
    text = to_python(graph)
    assert remade(text) == graph
    assert to_python(remade(text)) == text


def test_the_text_reads_like_the_machine() -> None:
    cart = BondGraph("cart", domain="translation")
    cart.one("carriage", Se("force"), I("mass"), R("friction"))
    cart.parameter("mass", 95.0, "kg", std=1.0)
    cart.measure("position", displacement="carriage")
    assert to_python(cart.finish()).splitlines() == [
        "from bondgraph import BondGraph, I, R, Se",
        "",
        "",
        "def model() -> BondGraph:",
        '    graph = BondGraph("cart", domain="translation")',
        '    graph.one("carriage", Se("force"), I("mass"), R("friction"))',
        '    graph.parameter("mass", 95.0, "kg", std=1.0)',
        '    graph.measure("position", displacement="carriage")',
        "    return graph",
    ]


EDITS = [
    InsertElement(
        "load", R("rub", law=mu * sympy.sign(f)), (Parameter(name="mu", value=0.3),)
    ),
    ReplaceRelation(
        "bearing", tau * sympy.tanh(f / v_s), (Parameter(name="v_s", value=0.01),)
    ),
    ReplaceMeasurement(
        "angle", k * displacement("shaft") + 1e-3, (Parameter(name="k", value=2.0),)
    ),
]


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: edit.describe())
def test_edited_graphs_are_printed_too(edit: Any) -> None:
    edited = edit.apply(motor())
    assert remade(to_python(edited)) == edited
    assert edited != motor()


@pytest.mark.parametrize(
    "law",
    [
        mu * f / 2 + sympy.Rational(3, 7) * f**3,
        mu * sympy.sqrt(sympy.Abs(f)) * sympy.sign(f),
        mu * f ** sympy.Rational(3, 2) / (1 + f**2),
        mu * sympy.exp(-(sympy.Abs(f / v_s) ** tau)),
        0.1 * f + 1 / sympy.Float(3),
        sympy.Float("0.1234567890123456789012345", 25) * f,
        sympy.Max(0, f) - sympy.Min(0, mu * f, tau),
        sympy.Piecewise((mu * f, f > 0), (tau * f, True)),
        sympy.Piecewise((f, sympy.And(f > -k, f < k)), (0, sympy.Ne(f, mu)), (1, True)),
        sympy.pi * f - sympy.E + sympy.atan2(f, mu),
        sympy.Heaviside(f) * f - (-f) ** 2 - (mu - f) * (mu + f),
        2 ** (-f) - (f**2) ** mu + sympy.log(1 + f**2),
        mu * f + sympy.Symbol("lambda") + sympy.Symbol("graph") + sympy.Symbol("a-b"),
        mu * f + sympy.Symbol("K_") * sympy.Symbol("R") + sympy.Symbol("2nd"),
        displacement("at") * f + sympy.sin(t) ** 2,
    ],
    ids=str,
)
def test_laws_survive_exactly(law: sympy.Expr) -> None:
    graph = BondGraph("one law")
    graph.one("at", Se("u"), R("resistance", law=law))
    finished = graph.finish()
    assert remade(to_python(finished)) == finished


def test_a_rounding_survives() -> None:
    graph = BondGraph("printed")
    graph.one("at", Se("u"), I("inertia"), R("friction"))
    inertia = Parameter(
        name="inertia", value=1.2e-2, rounding=5e-5, std=1e-3, bounds=(0, 1)
    )
    graph.take(ParameterSet((inertia,)))
    finished = graph.finish()
    assert remade(to_python(finished)) == finished


def test_hostile_names_stay_text() -> None:
    graph = BondGraph("\"); import os  # \n ''' {x}")
    graph.one("at", Se("u"), R("r"))
    graph.measure('y"\n', flow="at")
    finished = graph.finish()
    assert remade(to_python(finished)) == finished


def test_a_graph_put_together_by_hand_is_written_bond_by_bond() -> None:
    graph = ladder()
    bonds = tuple(Bond(b.head, b.tail) if b.head == "m2" else b for b in graph.bonds)
    turned = replace(graph, bonds=bonds)
    text = to_python(turned)
    assert 'graph.bond("m2", ' in text
    assert remade(text) == turned


def test_bonds_between_elements_keep_their_domain() -> None:
    graph = BondGraph("tower", domain="hydraulic")
    graph.add(C("tank"), TF("ram"), R("brake"))
    graph.bond("tank", "ram")
    graph.bond("ram", "brake", domain="translation")
    finished = graph.finish()
    assert remade(to_python(finished)) == finished


def test_a_function_sympy_does_not_know_is_refused() -> None:
    graph = BondGraph("own function")
    graph.one("at", Se("u"), R("r", law=sympy.Function("mine")(f)))
    with pytest.raises(EquationError, match="mine"):
        to_python(graph.finish())


def test_an_inserted_element_reads_as_one_sentence() -> None:
    loss = R("loss", law=-0.5 * f)
    after = InsertElement("j3", loss).apply(ladder())
    assert describe_difference(ladder(), after) == ("one R added at j3",)
    assert describe_difference(after, ladder()) == ("one R removed at j3",)
    assert describe_difference(after, after) == ()


def test_divisions_read_as_divisions() -> None:
    graph = BondGraph("quotients")
    graph.one("at", Se("u"), R("r", law=mu * f / v_s / (k + 1) - 1 / (tau * k)))
    text = to_python(graph.finish())
    assert "law=f*mu/v_s/(k + 1) - 1/k/tau" in text.replace("(1 + k)", "(k + 1)")
    assert remade(text) == graph.finish()


def test_what_is_known_may_change_alone() -> None:
    before = motor()
    surer = replace(before.parameters["R_a"], std=0.1)
    after = before.with_parameters([surer])
    assert describe_difference(before, after) == (
        "what is known about parameter R_a changed",
    )


def test_differences_are_named() -> None:
    before = motor()
    after = before.with_parameters({"R_a": 1.6})
    for edit in EDITS:
        after = edit.apply(after)
    assert describe_difference(before, after) == (
        "one R added at load",
        "the law of bearing replaced: f*mu + tau*sign(f) before, tau*tanh(f/v_s) now",
        'measurement angle reads displacement("shaft")*k + 0.001 [rad], '
        'before displacement("shaft") [rad]',
        "parameter v_s added: 0.01",
        "parameter R_a from 1.5 ohm to 1.6 ohm",
        "parameter mu from 0.1 N*m*s to 0.3",
        "parameter k from no value to 2",
    )
