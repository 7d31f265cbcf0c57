"""In which order choices are offered, and at which end of a bond they put strokes."""

import sympy

from bondgraph import BondGraph, C, I, IField, R, RField, Se, e, f, p, ports, q
from bondgraph.causality.choices import Choice, choices
from bondgraph.causality.propagation import StrokeBoard

a, b = sympy.symbols("a b", positive=True)
e1, e2 = ports("e", 2)
f1, f2 = ports("f", 2)
p1, p2 = ports("p", 2)
BENT = (a * f1**3 + f2, b * f2 + f1)
STRAIGHT = (a * f1 + f2, b * f2 + f1)
GIVES_FLOW = (a * e1 + e2, b * e2 + e1)


def offered(graph: BondGraph) -> dict[str, tuple[Choice, StrokeBoard]]:
    """Return the choices by port, in their order, each with its board."""
    finished = graph.finish()
    board = StrokeBoard(finished)
    found = choices(board, finished.preferences)
    return {choice.port: (choice, board) for choice in found}


def beside(field: IField | RField, *others: I | C | R) -> BondGraph:
    """Return two 1-junctions that a field joins, with others at the first."""
    graph = BondGraph("pair")
    graph.one("first", Se("u"), *others)
    graph.one("second", Se("v"))
    graph.put(field, on=("first", "second"))
    return graph


def wanted_at(graph: BondGraph, port: str) -> str:
    """Return the node at which the stroke of a port is wanted."""
    choice, board = offered(graph)[port]
    return board.nodes[choice.at].name


def test_storages_come_before_resistances_and_the_stubborn_first() -> None:
    graph = BondGraph("row")
    graph.one(
        "cart",
        R("free"),
        R("straight", law=a * f),
        R("cubic", law=a * f**3),
        R("stuck", law=a * sympy.sign(f)),
        I("mass"),
        C("spring", law=a * q),
        C("stop", law=a * sympy.sign(q)),
    )
    order = list(offered(graph))
    assert order[:3] == ["stop", "mass", "spring"]
    assert order[3] == "stuck"
    assert order[-1] == "free"
    assert order.index("cubic") < order.index("straight")


def test_a_straight_resistive_field_chooses_between_one_way_and_willing_laws() -> None:
    stuck, willing = R("stuck", law=a * sympy.sign(f)), R("willing", law=a * f)
    order = list(offered(beside(RField("w", STRAIGHT), willing, stuck)))
    assert order == ["stuck", "w[1]", "w[2]", "willing"]


def test_a_bent_resistive_field_chooses_with_what_works_one_way_only() -> None:
    stuck = R("stuck", law=a * sympy.sign(f))
    # Within a rank the author's order holds: the field was put last.
    assert list(offered(beside(RField("w", BENT), stuck))) == ["stuck", "w[1]", "w[2]"]
    cubic = R("cubic", law=a * f**3)
    assert next(iter(offered(beside(RField("w", BENT), cubic)))) == "w[1]"


def test_a_field_that_gives_efforts_wants_the_strokes_at_its_junctions() -> None:
    assert wanted_at(beside(RField("w", STRAIGHT)), "w[2]") == "second"
    assert wanted_at(beside(RField("w", GIVES_FLOW)), "w[2]") == "w"


def test_a_resistance_wants_what_its_law_gives() -> None:
    def at(resistance: R) -> str:
        graph = BondGraph("one")
        graph.one("first", Se("u"), resistance, I("m"))
        return wanted_at(graph, "r")

    assert at(R("r")) == "first"
    assert at(R("r", law=a * f)) == "first"
    assert at(R("r", law=a * e)) == "r"


def test_a_bent_storage_field_comes_before_straight_storages() -> None:
    bent = IField("m", (a * p1**3 + p2, b * p2 + p1))
    assert next(iter(offered(beside(bent, I("plain"))))) == "m[1]"
    straight = IField.from_matrix("m", [[2, 1], [1, 3]])
    assert next(iter(offered(beside(straight, I("plain"))))) == "plain"
    assert wanted_at(beside(straight), "m[1]") == "m"


def wished(port: str, wanted: str) -> list[str]:
    """Return the order of choices on one junction where the author has one wish."""
    graph = BondGraph("row")
    graph.one(
        "cart",
        R("stuck", law=a * sympy.sign(f)),
        R("straight", law=a * f),
        C("stop", law=a * sympy.sign(q)),
        I("mass"),
    )
    graph.prefer(port, wanted)
    return list(offered(graph))


def test_what_the_author_wishes_is_chosen_first_among_its_like() -> None:
    assert wished("mass", "integral") == ["mass", "stop", "stuck", "straight"]
    # A resistance's wish comes before all other resistances and after every storage.
    order = wished("straight", "effort")
    assert order == ["stop", "mass", "straight", "stuck"]


def test_a_constant_law_works_one_way_only_and_a_plain_one_both() -> None:
    graph = BondGraph("row")
    graph.one("cart", R("plain", law=f), R("constant", law=a), I("m", law=p), C("k"))
    order = list(offered(graph))
    assert order == ["m", "k", "constant", "plain"]
    graph = BondGraph("row")
    graph.one("cart", I("plain", law=p), I("cubic", law=a * p**3), C("k"))
    assert list(offered(graph)) == ["cubic", "plain", "k"]
