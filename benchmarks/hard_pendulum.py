"""A pendulum driven over the top: whether fits from wrong starts find it.

10 s at 1 kHz of a chaotic swing, noise 1e-3 rad, five parameters, starts drawn evenly
on a logarithmic scale within a factor of three. The recording is made by the classical
Runge-Kutta method in numpy. A start counts as reaching the truth when every parameter
ends within two per cent of it.

    python -m benchmarks.hard_pendulum [STARTS]
"""

import sys
import time

import numpy as np
import sympy
from numpy.typing import NDArray

from benchmarks.measuring import print_machine, print_table
from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    I,
    R,
    Recording,
    Se,
    WholeRecordings,
    bind_to,
    f,
    fit,
    q,
)
from bondgraph.fitting.strategy import (
    Direct,
    GrowingWindows,
    MultipleShooting,
    Strategy,
)
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
TRUE = {"J": 0.05, "b": 0.01, "d": 0.001, "tau": 0.03, "mgl": 1.0}
UNITS = {
    "J": "kg*m^2",
    "b": "N*m*s/rad",
    "d": "N*m*s^2/rad^2",
    "tau": "N*m",
    "mgl": "N*m",
}
SLIP = 0.1
REACHED = 0.02


def pendulum(values: dict[str, float]) -> FinishedGraph:
    """Return the pendulum with viscous, quadratic and dry friction."""
    graph = BondGraph("pendulum over the top", domain="rotation")
    b, d, tau, mgl = sympy.symbols("b d tau mgl")
    drag = d * f * sympy.sqrt(f**2 + 1e-6)
    law = b * f + drag + tau * sympy.tanh(f / SLIP)
    weight = mgl * sympy.sin(q)
    graph.one(
        "shaft", Se("torque"), I("J"), R("loss", law=law), C("gravity", law=weight)
    )
    graph.measure("angle", displacement="shaft")
    for name, unit in UNITS.items():
        graph.parameter(name, values[name], unit, bounds=(1e-9, np.inf))
    return graph.finish()


def swing(*, seed: int, samples: int = 10_001, step: float = 1e-3) -> tuple[Array, ...]:
    """Return time, torque, angle with noise, and the true angle."""
    random = np.random.default_rng(seed)
    time = step * np.arange(samples)
    torque = sum(
        size * np.sin(2 * np.pi * rate * time + random.uniform(0, 2 * np.pi))
        for size, rate in ((0.7, 0.55), (0.5, 0.83), (0.3, 1.3))
    )
    angle = runge_kutta(np.asarray(torque), step)
    return time, np.asarray(torque), angle + 1e-3 * random.normal(size=samples), angle


def runge_kutta(torque: Array, step: float, substeps: int = 4) -> Array:
    """Return the angle from rest, the torque joined by straight lines."""
    inertia, b, d, tau, mgl = TRUE.values()

    def rate(x: Array, u: float) -> Array:
        w = x[1]
        loss = b * w + d * w * abs(w) + tau * np.tanh(w / SLIP)
        return np.array([w, (u - loss - mgl * np.sin(x[0])) / inertia])

    x, angle, h = np.zeros(2), np.zeros(len(torque)), step / substeps
    for k in range(len(torque) - 1):
        angle[k] = x[0]
        rise = (torque[k + 1] - torque[k]) / substeps
        for s in range(substeps):
            u = torque[k] + rise * s
            a = rate(x, u)
            b_ = rate(x + h / 2 * a, u + rise / 2)
            c = rate(x + h / 2 * b_, u + rise / 2)
            e = rate(x + h * c, u + rise)
            x = x + h / 6 * (a + 2 * b_ + 2 * c + e)
    angle[-1] = x[0]
    return angle


def recorded(
    graph: FinishedGraph, time: Array, torque: Array, angle: Array
) -> BoundRecording:
    """Return the swing bound to the pendulum."""
    channels = {"torque": (torque, "N*m"), "angle": (angle, "rad")}
    return bind_to(graph, Recording.from_arrays("swing", time, channels))


def starts(count: int, *, seed: int = 1) -> list[dict[str, float]]:
    """Return start values within a factor of three of the truth."""
    random = np.random.default_rng(seed)
    return [
        {name: value * 3.0 ** random.uniform(-1, 1) for name, value in TRUE.items()}
        for _ in range(count)
    ]


def reaches(
    strategy: Strategy, start: dict[str, float], data: tuple[Array, ...]
) -> bool:
    """Return whether a fit from `start` ends at the true parameters."""
    graph = pendulum(start)
    settings = FitSettings(horizon=WholeRecordings(), strategy=strategy)
    result = fit(graph, [recorded(graph, *data)], settings=settings)
    errors = [abs(e.value / TRUE[e.name] - 1.0) for e in result.estimates]
    return max(errors) <= REACHED


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    print_machine()
    time_axis, torque, angle, _ = swing(seed=0)
    data = (time_axis, torque, angle)
    print(f"angle from {angle.min():.1f} to {angle.max():.1f} rad")
    rows = []
    # The direct descent wanders to its iteration limit: a few starts show it.
    few = max(count // 4, 1)
    for strategy, tried in (
        (GrowingWindows(), count),
        (MultipleShooting(), count),
        (Direct(), few),
    ):
        begin = time.process_time()
        hits = sum(reaches(strategy, start, data) for start in starts(tried))
        spent = (time.process_time() - begin) / tried
        rows.append((type(strategy).__name__, f"{hits}/{tried}", f"{spent:.2g} s"))
        print(rows[-1], flush=True)
    print_table(
        "Starts that reach the parameters",
        ("strategy", "reached", "processor time per start"),
        rows,
    )


if __name__ == "__main__":
    main()
