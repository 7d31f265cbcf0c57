"""From a graph to numbers: how long it takes, and how it grows with the machine.

The machine is a chain of masses joined by springs with dampers, two states per mass.
"""

from functools import partial

from benchmarks.measuring import print_machine, print_table, seconds, stopwatch
from bondgraph import BondGraph, C, I, R, Se, assign_causality, derive
from bondgraph.numeric.model import compile_model

STATES = (2, 10, 30)
LENGTHS = (10, 20, 40, 80, 160, 320, 640)
LONG = 160
"""From here on a run is long enough to be timed once."""


def chain(masses: int) -> BondGraph:
    """Return a chain fixed at one end and pulled at the other."""
    graph = BondGraph(f"chain of {masses}", domain="translation")
    for i in range(1, masses + 1):
        graph.one(f"mass_{i}", I(f"m_{i}"))
        graph.zero(f"link_{i}")
        graph.one(f"spring_{i}", C(f"c_{i}"), R(f"b_{i}"))
        graph.join(f"link_{i}", f"spring_{i}")
        graph.join(f"mass_{i}", f"link_{i}")
        if i > 1:
            graph.join(f"link_{i - 1}", f"mass_{i}")
    graph.put(Se("pull"), on="mass_1")
    graph.one("wall", R("anchor"))
    graph.join(f"link_{masses}", "wall")
    graph.measure("speed", flow="mass_1")
    return graph


def preparation() -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for states in STATES:
        write = chain(states // 2)
        finish, graph = stopwatch(write.finish)
        cause, _ = stopwatch(partial(assign_causality, graph))
        form, equations = stopwatch(partial(derive, graph))
        tape, model = stopwatch(partial(compile_model, equations))
        assert model.n_states == states
        rows.append(
            (
                str(states),
                seconds(finish),
                seconds(cause),
                seconds(form),
                seconds(tape),
                seconds(form + tape),
                str(len(model.dynamics.code)),
            )
        )
    return rows


def growth() -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for masses in LENGTHS:
        graph = chain(masses).finish()
        bonds = len(graph.bonds)
        cause, _ = stopwatch(partial(assign_causality, graph), times=5)
        form, _ = stopwatch(partial(derive, graph), times=1 if masses >= LONG else 3)
        rows.append(
            (
                str(masses),
                str(bonds),
                seconds(cause),
                f"{1e6 * cause / bonds:.3g} us",
                seconds(form),
                f"{1e6 * form / bonds:.3g} us",
            )
        )
    return rows


def main() -> None:
    print_machine()
    derive(chain(2).finish())  # imports and first calls
    print_table(
        "From a graph to a model ready to run",
        ("states", "finish", "causality", "derive (with causality)", "tape",
         "derive + tape", "operations"),
        preparation(),
    )  # fmt: skip
    print_table(
        "Growth with the length of the chain (level per bond is linear)",
        (
            *("masses", "bonds", "causality", "per bond"),
            *("derive (with causality)", "per bond"),
        ),
        growth(),
    )


if __name__ == "__main__":
    main()
