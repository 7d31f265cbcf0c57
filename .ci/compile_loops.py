"""Compile the loops that a fresh checkout lacks, so that no test waits for them.

    compile_loops.py tape | native

The halves share no loop, so that they may run beside each other; each takes a minute.
"""

import sys

import numpy as np
import sympy

from bondgraph import (
    BondGraph,
    C,
    FinishedGraph,
    FitSettings,
    Hold,
    I,
    Native,
    R,
    Recording,
    RungeKutta4,
    Sdirk2,
    Se,
    Windows,
    bind_to,
    derive,
    f,
    fit,
    fit_innovations,
    locate,
    simulate_batch,
    state_space,
)
from bondgraph.numeric.model import compile_model
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.shooting import Shots, shoot

STEP, SAMPLES = 0.01, 200


def cart(friction: sympy.Expr) -> FinishedGraph:
    """Return a sprung cart with a law of friction in ``size``."""
    graph = BondGraph("cart", domain="translation")
    graph.one("wheel", Se("force"), I("mass"), C("spring"), R("friction", law=friction))
    graph.measure("position", displacement="wheel")
    for name, value, unit in (("mass", 1.0, "kg"), ("spring", 0.1, "m/N")):
        graph.parameter(name, value, unit, bounds=(1e-3, 1e3))
    graph.parameter("size", 1.0, "N*s/m", bounds=(0.0, 1e3))
    return graph.finish()


def shaken(graph: FinishedGraph) -> BoundRecording:
    """Return a recording of the cart with viscous friction, by semi-implicit Euler."""
    random = np.random.default_rng(1)
    force = np.repeat(random.normal(size=SAMPLES // 20), 20)
    position, x, v = np.zeros(SAMPLES), 0.0, 0.0
    for k in range(SAMPLES):
        position[k] = x
        v += STEP * (force[k] - 1.1 * v - 9.0 * x)
        x += STEP * v
    position += 1e-3 * random.normal(size=SAMPLES)
    channels = {"force": (force, "N"), "position": (position, "m")}
    time = STEP * np.arange(SAMPLES)
    return bind_to(graph, Recording.from_arrays("shaken", time, channels))


def tape() -> None:
    """Compile what runs tapes, as for short recordings, and what reads their slopes."""
    size, windows = sympy.Symbol("size"), FitSettings(horizon=Windows(50))
    dry, smooth = cart(size * sympy.sign(f)), cart(size * f)
    fit(dry, [shaken(dry)], settings=windows)
    recording = shaken(smooth)
    found = fit(smooth, [recording], settings=windows)
    locate(found.fitted, [recording], places=["wheel"])
    fit_innovations(smooth, [recording])


def native() -> None:
    """Compile what steps native code, and the slopes of large models."""
    graph = cart(sympy.Symbol("size") * f)
    recording = shaken(graph)
    model = compile_model(derive(graph))
    shots = Shots(recording.time, recording.inputs, recording.outputs, (0, SAMPLES))
    for solver in (RungeKutta4(), Sdirk2()):
        shoot(
            model,
            shots,
            parameters=np.ones(len(model.parameter_names)),
            initial=np.zeros((1, model.n_states)),
            directions=np.zeros(1, np.int64),
            solver=solver,
            hold=Hold.FIRST,
            engine=Native(),
        )
    simulate_batch(graph, [{"mass": 1.0}, {"mass": 1.1}], recording)
    state_space(graph)


if __name__ == "__main__":
    {"tape": tape, "native": native}[sys.argv[1]]()
