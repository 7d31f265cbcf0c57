"""The page on the library says of every entry what the entry says of itself."""

import inspect
from itertools import islice, product
from pathlib import Path

import sympy
from physics_machines import MACHINES

from bondgraph.physics.hypothesis import Hypothesis, Passivity
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.base import Place
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.scales import Scales
from bondgraph.structure.signals import signals_in

PAGE = Path(__file__).parent.parent / "docs" / "physics_library.md"
HEADS = (
    *("Word", "What", "Law", "At", "Parameters", "Power"),
    *("Looks like; taken for", "After"),
)
POWER = {
    Passivity.DISSIPATIVE: "takes",
    Passivity.STORING: "stores",
    Passivity.SOURCE: "may give",
    Passivity.SIGNAL: "none",
}


def table() -> str:
    """Return one row per entry: run this file to print it."""
    found: dict[str, list[tuple[Place, Hypothesis]]] = {}
    for graph in MACHINES.values():
        for place, physics in product(all_places(graph, Scales()), LIBRARY):
            for hypothesis in islice(physics.propose(place), 1):  # no more are shown
                row = found.setdefault(type(physics).__name__, [])
                row.append((place, hypothesis))
    rows = [f"| {' | '.join(HEADS)} |", f"| {' | '.join(len(HEADS) * ['---'])} |"]
    for physics in LIBRARY:
        proposed = found[type(physics).__name__]
        doc = inspect.getdoc(type(physics)) or ""
        at = dict.fromkeys(_kind(place) for place, _ in proposed)
        place, hypothesis = proposed[0]
        cells = (
            f"`{physics.word}`",
            doc.splitlines()[0].rstrip("."),
            _law(place, hypothesis),
            ", ".join(at),
            "; ".join(_parameters(place, hypothesis)),
            POWER[physics.passivity],
            physics.signature,
            physics.reference,
        )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def _kind(place: Place) -> str:
    name = type(place).__name__.removesuffix("Place")
    kinds = {"OneJunction": "1", "ZeroJunction": "0"}
    kinds |= {"StockPair": "pair", "ApartPair": "apart", "MotionPair": "beside"}
    return kinds.get(name, name.lower())


def _law(place: Place, hypothesis: Hypothesis) -> str:
    """Return the law with names as in the column of parameters, sharp where it is."""
    if not all(place.graph.has_place(one.place) for one in signals_in(hypothesis.law)):
        return "by a state of its own"
    if hypothesis.physics == "unknown_relation":
        return "any curve"
    law = sympy.sstr(sympy.N(hypothesis.law, 3))
    law = law.replace(f"_{place.name}", "").replace("tanh(f/slip_flow)", "sign(f)")
    return f"`{law}`"


def _parameters(place: Place, hypothesis: Hypothesis) -> list[str]:
    """Return ``name >= bound [unit]`` of the fitted parameters of one hypothesis."""
    found = []
    for parameter in hypothesis.edit.parameters:
        if parameter.exact:
            continue
        stem = parameter.name.removesuffix(f"_{place.name}")
        low, _ = parameter.bounds
        bound = " ≥ 0" if low == 0.0 else " > 0" if low > 0.0 else ""
        unit = parameter.unit.replace("(", "").replace(")", "")
        unit = parameter.unit if "/" in parameter.unit else unit
        found.append(f"{stem}{bound} [{unit}]".replace("_", "\\_"))
    return found


def test_the_page_has_the_table_of_the_library():
    assert table() in PAGE.read_text(encoding="utf-8")


def test_the_front_page_says_how_many_laws_there_are():
    front = (PAGE.parent.parent / "README.md").read_text(encoding="utf-8")
    assert f"It knows the {len(LIBRARY)} laws of" in front


if __name__ == "__main__":
    print(table())
