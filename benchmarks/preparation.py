"""From a graph to numbers: how long it takes, and how it grows with the machine.

The machine is a chain of masses joined by springs with dampers, two states per mass.
"""

import time
from functools import partial

import numpy as np

from benchmarks.measuring import print_machine, print_table, seconds, stopwatch
from bondgraph import BondGraph, C, I, R, Se, assign_causality, derive
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.numeric.native import model as native_model
from bondgraph.numeric.native.compiling import compiled_text
from bondgraph.simulation.engines import Engine, Interpreted, Native
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Sdirk2

STATES = (2, 10, 30)
LENGTHS = (10, 20, 40, 80, 160, 320, 640)
processor = partial(stopwatch, times=7, clock=time.process_time)
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


def first_simulation(model: NumericModel, engine: Engine) -> object:
    """Simulate 20 samples with all sensitivities: what a fit begins with."""
    nu, ny = len(model.input_names), len(model.output_names)
    shots = Shots(1e-3 * np.arange(20), np.ones((20, nu)), np.ones((20, ny)), (0, 20))
    n = len(model.parameter_names)
    return shoot(
        model,
        shots,
        parameters=np.ones(n),
        initial=np.zeros((1, model.n_states)),
        directions=np.arange(n),
        solver=Sdirk2(),
        hold=Hold.FIRST,
        engine=engine,
    )


def compile_seconds(model: NumericModel) -> float:
    """Return how long native code with sensitivities takes, compiled anew."""

    def compiled() -> object:
        native_model._compiled.cache_clear()
        compiled_text.cache_clear()
        return first_simulation(model, Native())

    return processor(compiled)[0]


def preparation() -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for states in STATES:
        write = chain(states // 2)
        finish, graph = processor(write.finish)
        cause, _ = processor(partial(assign_causality, graph))
        form, equations = processor(partial(derive, graph))
        tape, model = processor(partial(compile_model, equations))
        assert model.n_states == states
        begun, _ = processor(partial(first_simulation, model, Interpreted()))
        native = compile_seconds(model)
        rows.append(
            (
                str(states),
                seconds(finish),
                seconds(cause),
                seconds(form),
                seconds(tape),
                seconds(finish + form + tape + begun),
                seconds(native),
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
    model = compile_model(derive(chain(2).finish()))  # imports and first calls
    for engine in (Interpreted(), Native()):
        first_simulation(model, engine)
    print_table(
        "From a graph to a model ready to run (processor time)",
        ("states", "finish", "causality", "derive (with causality)", "tape",
         "ready and simulated", "native code", "operations"),
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
