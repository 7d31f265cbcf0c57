"""How often the 95 % intervals of a fit hold the truth.

An electrical low-pass with an unknown resistance and sensor gain, made by
`scipy.signal.lsim` (exact for inputs joined by straight lines), fitted again and again
with new inputs and new noise. 95 % of 200 repeats have a standard error of 1.5 %.

    python -m benchmarks.coverage [REPEATS]
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import sympy
from numpy.typing import NDArray
from scipy.signal import lfilter, lsim

from benchmarks.measuring import print_machine, print_table
from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    R,
    Recording,
    Se,
    WholeRecordings,
    Windows,
    bind_to,
    displacement,
    fit,
)
from bondgraph.fitting.horizon import Horizon
from bondgraph.fitting.loss import Huber, StudentT
from bondgraph.fitting.noise import AutoregressiveNoise
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
Random = np.random.Generator
TRUE = {"r": 2.0, "gain": 10.0}
CAPACITY = 0.1
SAMPLES, STEP = 600, 0.02
NOISE = 0.1


def lowpass() -> FinishedGraph:
    """Return the filter, far from its true parameters."""
    graph = BondGraph("filter", domain="electrical")
    gain = sympy.Symbol("gain")
    graph.one("loop", Se("u"), R("r"), C("c"))
    graph.measure("v", gain * displacement("c"), unit="V")
    graph.parameter("r", 1.5, "ohm")
    graph.parameter("c", CAPACITY, "F", std=0.0)
    graph.parameter("gain", 8.0, "V/(A*s)")
    return graph.finish()


def white(random: Random) -> Array:
    """Return white noise."""
    return NOISE * random.normal(size=SAMPLES)


def coloured(random: Random, correlation: float = 0.9) -> Array:
    """Return first-order coloured noise of the same size."""
    white_noise = random.normal(size=SAMPLES + 300) * np.sqrt(1 - correlation**2)
    return NOISE * np.asarray(lfilter([1.0], [1.0, -correlation], white_noise))[300:]


def with_outliers(random: Random) -> Array:
    """Return white noise of which every twentieth sample is ten times as large."""
    far = random.uniform(size=SAMPLES) < 0.05
    return white(random) * np.where(far, 10.0, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One kind of disturbance and how the fit is told to meet it."""

    name: str
    noise: Callable[[Random], Array]
    settings: FitSettings
    lsb: float = 0.0
    input_noise: float = 0.0


def _settings(horizon: Horizon | None = None, **choices: object) -> FitSettings:
    chosen = WholeRecordings() if horizon is None else horizon
    return FitSettings(horizon=chosen, **choices)  # type: ignore[arg-type]


CASES = (
    Case(name="white", noise=white, settings=_settings()),
    Case(name="AR(1) 0.9", noise=coloured, settings=_settings()),
    Case(
        name="AR(1) 0.9, prewhitened",
        noise=coloured,
        settings=_settings(noise=AutoregressiveNoise()),
    ),
    Case(
        name="AR(1) 0.9, windows of 60", noise=coloured, settings=_settings(Windows(60))
    ),
    Case(name="quantised, step 0.35", noise=white, settings=_settings(), lsb=0.35),
    Case(name="input noise 5 %", noise=white, settings=_settings(), input_noise=0.05),
    Case(name="outliers", noise=with_outliers, settings=_settings()),
    Case(name="outliers, Huber", noise=with_outliers, settings=_settings(loss=Huber())),
    Case(
        name="outliers, Student t",
        noise=with_outliers,
        settings=_settings(loss=StudentT()),
    ),
)


@dataclass(frozen=True, slots=True)
class Repeats:
    """Per parameter: the share of intervals that hold the truth, error and half width.

    ``error`` is the root mean square error, ``std`` the mean std told, both relative.
    """

    covered: dict[str, float]
    error: dict[str, float]
    std: dict[str, float]


def repeat(case: Case, count: int, *, seed: int = 0) -> Repeats:
    """Fit `count` new recordings of one case."""
    graph, time = lowpass(), STEP * np.arange(SAMPLES)
    tau = TRUE["r"] * CAPACITY
    plant = ([[-1 / tau]], [[1 / TRUE["r"]]], [[TRUE["gain"]]], [[0.0]])
    hits = dict.fromkeys(TRUE, 0)
    squared, told = dict.fromkeys(TRUE, 0.0), dict.fromkeys(TRUE, 0.0)
    for index in range(count):
        random = np.random.default_rng([seed, index])
        rough = random.normal(size=SAMPLES + 19)
        u = np.convolve(rough, np.ones(20) / np.sqrt(20), mode="valid")
        v = np.asarray(lsim(plant, u, time)[1]) + case.noise(random)
        if case.lsb:
            v = case.lsb * np.round(v / case.lsb)
        seen = u + case.input_noise * random.normal(size=SAMPLES)
        channels = {"u": (seen, "V"), "v": (v, "V")}
        recording = bind_to(graph, Recording.from_arrays("made", time, channels))
        result = fit(graph, [recording], settings=case.settings)
        for name, value in TRUE.items():
            found = result.estimate(name)
            if found.interval is None or found.std is None:
                continue
            low, high = found.interval
            hits[name] += low <= value <= high
            squared[name] += (found.value / value - 1.0) ** 2 / count
            told[name] += found.std / value / count
    return Repeats(
        {name: hits[name] / count for name in TRUE},
        {name: float(np.sqrt(squared[name])) for name in TRUE},
        told,
    )


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    print_machine()
    rows = []
    for case in CASES:
        found = repeat(case, count)
        cells = [
            f"{100 * found.covered[n]:.1f} %, {100 * found.error[n]:.2g} %, "
            f"{100 * found.std[n]:.2g} %"
            for n in TRUE
        ]
        rows.append((case.name, *cells))
        print(rows[-1], flush=True)
    columns = ("noise", *(f"{n}: covered, true error, std told" for n in TRUE))
    print_table(f"Coverage of 95 % intervals in {count} repeats", columns, rows)


if __name__ == "__main__":
    main()
