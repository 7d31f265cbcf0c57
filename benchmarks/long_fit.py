"""What a fit to a million samples costs: processor time and peak memory.

    .venv/bin/python -m benchmarks.long_fit                    # 10^6 samples
    .venv/bin/python -m benchmarks.long_fit --samples 100000

A mass on a spring with a damper, recorded by scipy's exact discretisation with noise on
its position and its velocity; three parameters start 20 to 50 % off. It runs in this
process alone, so that the peak is that of the fit.
"""

import argparse
import resource
import time

import numpy as np
from scipy.signal import StateSpace, cont2discrete, dlsim

from benchmarks.measuring import print_table
from bondgraph import BondGraph, C, FitSettings, I, R, Recording, Se, Windows, bind_to
from bondgraph.fitting.estimate import fit_model
from bondgraph.structure.graph import FinishedGraph

STEP = 1e-3
TRUTH = {"mass": 2.0, "damper": 3.0, "spring": 1 / 400}
STARTS = {"mass": 1.5, "damper": 4.5, "spring": 1 / 300}
UNITS = {"mass": "kg", "damper": "N*s/m", "spring": "m/N"}
WINDOW = 1000


def machine() -> FinishedGraph:
    """Return the mass on its spring with wrong values."""
    graph = BondGraph("mass on a spring", domain="translation")
    graph.one("mass_moves", Se("force"), I("mass"), R("damper"), C("spring"))
    for name, value in STARTS.items():
        graph.parameter(name, value, UNITS[name], bounds=(value / 10, 10 * value))
    graph.measure("position", displacement="spring")
    graph.measure("velocity", flow="mass_moves")
    return graph.finish()


def recorded(samples: int) -> Recording:
    """Return what an independent simulation says that sensors read."""
    mass, damper, spring = TRUTH.values()
    random = np.random.default_rng(3)
    force = np.repeat(random.uniform(-10, 10, samples // 50 + 1), 50)[:samples]
    plant = StateSpace(
        [[0.0, 1.0], [-1 / (spring * mass), -damper / mass]],
        [[0.0], [1 / mass]],
        np.eye(2),
        np.zeros((2, 1)),
    )
    stepped = cont2discrete((plant.A, plant.B, plant.C, plant.D), STEP)
    _, read, _ = dlsim(stepped, force)
    noisy = read + 0.01 * read.std(axis=0) * random.standard_normal(read.shape)
    channels = {
        "force": (force, "N"),
        "position": (noisy[:, 0], "m"),
        "velocity": (noisy[:, 1], "m/s"),
    }
    return Recording.from_arrays("long", STEP * np.arange(samples), channels)


def peak() -> float:
    """Return the most memory that this process has held, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=1_000_000)
    samples = parser.parse_args().samples
    graph = machine()
    bound = bind_to(graph, recorded(samples))
    before, clock, used = peak(), time.perf_counter(), time.process_time()
    fitted = fit_model(graph, [bound], FitSettings(horizon=Windows(WINDOW)))
    wall, used = time.perf_counter() - clock, time.process_time() - used
    worst = max(abs(fitted.values[name] / true - 1) for name, true in TRUTH.items())
    print_table(
        f"Fit of three parameters to {samples} samples of two outputs",
        ["time", "processor", "memory before", "peak", "largest error"],
        [
            [
                f"{wall:.1f} s",
                f"{used:.1f} s",
                f"{before:.0f} MB",
                f"{peak():.0f} MB",
                f"{100 * worst:.2g} %",
            ]
        ],
    )


if __name__ == "__main__":
    main()
