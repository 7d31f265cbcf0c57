"""What a diagnosis costs: against the places of a machine and against the samples.

    .venv/bin/python -m benchmarks.diagnosis_cost             # slopes
    .venv/bin/python -m benchmarks.diagnosis_cost --large     # 100 000 samples

The machine is a chain of masses and springs, driven at one end, with dry friction
concealed at one mass; it is simulated here with numpy, not with the library.
"""

import argparse
import time

import numpy as np

from benchmarks.measuring import print_table
from bondgraph import BondGraph, C, I, R, Se
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.records import Diagnosis
from bondgraph.diagnosis.work.workers import Processes
from bondgraph.recordings.binding import BoundRecording, bind
from bondgraph.recordings.recording import Recording
from bondgraph.structure.graph import FinishedGraph

STEP, FINE = 0.005, 5
MASS, STIFFNESS, DAMPING, DRY = 1.0, 400.0, 0.5, 0.8


def chain(masses: int) -> FinishedGraph:
    """Return the chain without dry friction; its last spring holds to a wall."""
    graph = BondGraph(f"chain of {masses}", domain="translation")
    graph.one("mass1", Se("force"), I("m1"), R("b1"))
    for i in range(1, masses):
        graph.zero(f"spring{i}", C(f"c{i}"))
        graph.one(f"mass{i + 1}", I(f"m{i + 1}"), R(f"b{i + 1}"))
        graph.join(f"mass{i}", f"spring{i}")
        graph.join(f"spring{i}", f"mass{i + 1}")
    graph.put(C(f"c{masses}"), on=f"mass{masses}")
    for i in range(1, masses + 1):
        graph.parameter(f"m{i}", 1.1 * MASS, "kg", bounds=(0.01, 100))
        graph.parameter(f"b{i}", DAMPING, "N*s/m", std=0.0)
        graph.parameter(f"c{i}", 1 / STIFFNESS, "m/N", std=0.0)
        graph.measure(f"x{i}", displacement=f"mass{i}")
    return graph.finish()


def recorded(masses: int, samples: int, seed: int) -> BoundRecording:
    """Return the chain with dry friction at its middle mass, all positions read."""
    random = np.random.default_rng(seed)
    instants = STEP * np.arange(samples)
    waves = 2 * np.pi * np.outer(instants, random.uniform(0.1, 2.0, 8))
    force = 4.0 * np.sin(waves + random.uniform(0, 2 * np.pi, 8)).sum(axis=1)
    positions = _simulated(masses, force, masses // 2)
    channels = {"force": (force, "N")}
    for i in range(masses):
        noise = 1e-5 * random.standard_normal(samples)
        channels[f"x{i + 1}"] = (positions[:, i] + noise, "m")
    recording = Recording.from_arrays(f"run {seed}", instants, channels)
    outputs = {f"x{i + 1}": "m" for i in range(masses)}
    return bind(recording, {"force": "N"}, outputs)


def _simulated(masses: int, force: np.ndarray, rough: int) -> np.ndarray:
    x, v = np.zeros(masses + 1), np.zeros(masses)
    fine, hold = STEP / FINE, np.zeros(masses)
    hold[rough] = STEP / FINE * DRY / MASS
    positions = np.empty((len(force), masses))
    for k, push in enumerate(force):
        positions[k] = x[:-1]
        for _ in range(FINE):
            links = STIFFNESS * (x[:-1] - x[1:])
            pull = -links - DAMPING * v
            pull[1:] += links[:-1]
            pull[0] += push
            free = v + fine * pull / MASS
            v = np.sign(free) * np.maximum(np.abs(free) - hold, 0.0)
            x[:-1] += fine * v
    return positions


def timed(masses: int, samples: int, workers: int) -> tuple[float, Diagnosis, str]:
    """Return the seconds of a diagnosis, its answer, and where the time went."""
    graph = chain(masses)
    training, held_out = recorded(masses, samples, 1), recorded(masses, 2000, 2)
    stages: dict[str, float] = {}
    began = last = time.perf_counter()
    stage = ""

    def progress(sentence: str) -> None:
        nonlocal last, stage
        now = time.perf_counter()
        stages[stage] = stages.get(stage, 0.0) + now - last
        last, stage = now, sentence.split(",", maxsplit=1)[0]

    diagnosis = diagnose(
        graph,
        [training],
        held_out=[held_out],
        options=Options(where=Processes(workers), most_findings=1),
        progress=progress,
    )
    total = time.perf_counter() - began
    dearest = sorted(stages.items(), key=lambda item: -item[1])[:4]
    return total, diagnosis, ", ".join(f"{name} {took:.0f} s" for name, took in dearest)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    if arguments.large:
        cases = [(10, 100_000)]
    else:
        cases = [(2, 4000), (4, 4000), (8, 4000), (4, 16_000), (4, 64_000)]
    rows = []
    for masses, samples in cases:
        took, diagnosis, where = timed(masses, samples, arguments.workers)
        found = ", ".join(f"{f.physics} at {f.place}" for f in diagnosis.findings)
        rows.append([str(2 * masses - 1), str(samples), f"{took:.1f} s", found, where])
    print_table(
        "A diagnosis, one round and its check",
        ["junctions", "samples", "time", "found", "dearest steps"],
        rows,
    )


if __name__ == "__main__":
    main()
