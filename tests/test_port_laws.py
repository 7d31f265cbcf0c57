"""The law of a storing port, asked for either way round, is one law."""

import pytest
import sympy

from bondgraph.equations.deriving.inversion import Laws
from bondgraph.equations.power.port_laws import port_law
from bondgraph.errors import EquationError
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.elements import C, I, Se
from bondgraph.structure.fields import CField, IField
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import f, ports

L1, L2, M, c, k = sympy.symbols("L1 L2 M c k", real=True)


def graph_with(storage: I | C | IField | CField) -> FinishedGraph:
    graph = BondGraph("one storage")
    if isinstance(storage, I | C):
        graph.one("port", Se("u"), storage)
        return graph.finish()
    places = [f"place{i + 1}" for i in range(storage.size)]
    for i, place in enumerate(places):
        graph.one(place, Se(f"u{i + 1}"))
    graph.put(storage, on=places)
    return graph.finish()


def laws_of(
    graph: FinishedGraph, names: list[str], *, wants_stored: bool
) -> dict[str, sympy.Expr]:
    """Return the law of every port in symbols named after the ports."""
    laws = {}
    for name in names:
        law, reads = port_law(graph, Laws(graph), name, wants_stored=wants_stored)
        laws[name] = law.xreplace({x: sympy.Symbol(at) for x, at in reads.items()})
    return laws


COILS = IField.from_matrix("coils", [[L1, M], [M, L2]])
PLATES = CField.from_energy(
    "plates",
    k * ports("q", 2)[0] ** 2 / 2 + k * ports("q", 2)[0] * ports("q", 2)[1]
    + 3 * c * ports("q", 2)[1] ** 2,
)  # fmt: skip


@pytest.mark.parametrize(
    ("storage", "names"),
    [
        (I("m"), ["m"]),
        (C("give"), ["give"]),
        (COILS, ["coils[1]", "coils[2]"]),
        (PLATES, ["plates[1]", "plates[2]"]),
    ],
    ids=str,
)
def test_one_way_round_undoes_the_other(
    storage: I | C | IField | CField, names: list[str]
) -> None:
    graph = graph_with(storage)
    stored = laws_of(graph, names, wants_stored=True)
    given = laws_of(graph, names, wants_stored=False)
    put = {sympy.Symbol(name): law for name, law in given.items()}
    for name in names:
        back = stored[name].xreplace(put)
        assert sympy.cancel(back - sympy.Symbol(name)) == 0


def test_coils_have_the_currents_of_the_inverse_matrix() -> None:
    one, two = sympy.symbols("coils[1] coils[2]")
    given = laws_of(graph_with(COILS), ["coils[1]", "coils[2]"], wants_stored=False)
    determinant = L1 * L2 - M**2
    assert sympy.cancel(given["coils[1]"] - (L2 * one - M * two) / determinant) == 0
    assert sympy.cancel(given["coils[2]"] - (L1 * two - M * one) / determinant) == 0


def test_a_nonlinear_field_has_its_law_as_it_was_given_and_no_other() -> None:
    first, second = ports("q", 2)
    field = CField.from_energy("plates", k * first**2 / 2 + second**2 * (c - first))
    graph = graph_with(field)
    law, reads = port_law(graph, Laws(graph), "plates[2]", wants_stored=False)
    assert law == 2 * second * (c - first)
    assert reads == {first: "plates[1]", second: "plates[2]"}
    with pytest.raises(EquationError, match="no formula for what it stores") as told:
        port_law(graph, Laws(graph), "plates[2]", wants_stored=True)
    assert told.value.about == ("plates",)


def test_a_law_without_an_inverse_says_which_way_it_has_no_formula() -> None:
    graph = graph_with(I("i", law=f + f**5))
    assert port_law(graph, Laws(graph), "i", wants_stored=True)[0] == f + f**5
    with pytest.raises(EquationError, match="no formula for its flow or effort"):
        port_law(graph, Laws(graph), "i", wants_stored=False)
