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

STEP = 0.01
SHORT, LONG = 100, 15_000
"""Samples: a fit to so few runs the tape, one to so many native code."""
WINDOWS = FitSettings(horizon=Windows(50))


def cart(friction: sympy.Expr) -> FinishedGraph:
    """Return a sprung cart with a law of friction in ``size``."""
    graph = BondGraph("cart", domain="translation")
    graph.one("wheel", Se("force"), I("mass"), C("spring"), R("friction", law=friction))
    graph.measure("position", displacement="wheel")
    for name, value, unit in (("mass", 1.0, "kg"), ("spring", 0.1, "m/N")):
        graph.parameter(name, value, unit, bounds=(1e-3, 1e3))
    graph.parameter("size", 1.0, "N*s/m", bounds=(0.0, 1e3))
    return graph.finish()


def shaken(graph: FinishedGraph, samples: int) -> BoundRecording:
    """Return a recording of the cart with viscous friction, by semi-implicit Euler."""
    random = np.random.default_rng(1)
    force = np.repeat(random.normal(size=samples // 20), 20)
    position, x, v = np.zeros(samples), 0.0, 0.0
    for k in range(samples):
        position[k] = x
        v += STEP * (force[k] - 1.1 * v - 9.0 * x)
        x += STEP * v
    position += 1e-3 * random.normal(size=samples)
    channels = {"force": (force, "N"), "position": (position, "m")}
    time = STEP * np.arange(samples)
    return bind_to(graph, Recording.from_arrays("shaken", time, channels))


def tape() -> None:
    """Compile what runs tapes, as for short recordings and dry friction; filters."""
    size = sympy.Symbol("size")
    dry, smooth = cart(size * sympy.sign(f)), cart(size * f)
    for graph in (dry, smooth):
        fit(graph, [shaken(graph, SHORT)], settings=WINDOWS)
    fit_innovations(smooth, [shaken(smooth, SHORT)])


def native() -> None:
    """Compile what steps native code, smoothers, and the slopes of large models."""
    graph = cart(sympy.Symbol("size") * f)
    recording = shaken(graph, LONG)
    found = fit(graph, [recording], settings=WINDOWS)
    locate(found.fitted, [recording], places=["wheel"])
    model = compile_model(derive(graph))
    shots = Shots(recording.time, recording.inputs, recording.outputs, (0, LONG))
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
