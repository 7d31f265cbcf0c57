"""A thousand parameter sets of the friction pendulum, 10 s at 1 kHz: how long."""

import numpy as np

from benchmarks.handwritten import numba_loop
from benchmarks.measuring import (
    interleaved,
    print_machine,
    print_table,
    seconds,
    stopwatch,
    write_results,
)
from benchmarks.simulation import (
    SAMPLES,
    START,
    STEP,
    VALUES,
    by_hand,
    pendulum,
    scipy_runs,
    torque,
)
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.batch import Batch, SetStatus, simulate_batch
from bondgraph.simulation.solvers import RungeKutta4, Sdirk2, Solver

SETS = 1000


def recording() -> BoundRecording:
    return BoundRecording(
        name="noisy torque",
        time=STEP * np.arange(SAMPLES),
        inputs=torque()[:, None],
        outputs=np.full((SAMPLES, 1), np.nan),
        input_names=("torque",),
        output_names=("angle",),
        input_units=("N*m",),
        output_units=("rad",),
    )


def main() -> None:
    print_machine()
    graph, driven, draw = pendulum().finish(), recording(), np.random.default_rng(1)
    sets = [
        {name: value * draw.uniform(0.8, 1.25) for name, value in VALUES.items()}
        for _ in range(SETS)
    ]

    def ours(solver: Solver, count: int) -> Batch:
        return simulate_batch(graph, sets[:count], driven, initial=START, solver=solver)

    ours(RungeKutta4(), 2)  # compiles
    one = by_hand(torque(), numba_loop)
    odeint = scipy_runs(torque())["scipy odeint, rtol 1e-06"]
    works = {
        "RungeKutta4, 1000 sets": lambda: ours(RungeKutta4(), SETS),
        "Sdirk2, 100 sets": lambda: ours(Sdirk2(), 100),
        "numba loop by hand, 100 sets": lambda: [one() for _ in range(100)],
        "scipy odeint, 1 set": odeint,
    }
    times = interleaved(works, rounds=5)
    wall, batch = stopwatch(lambda: ours(RungeKutta4(), SETS), times=7)
    assert set(batch.status) == {SetStatus.SUCCESSFUL}
    rows, record = [], []
    for (name, (best, middle)), count in zip(
        times.items(), (SETS, 100, 100, 1), strict=True
    ):
        each = best / count
        rows.append((name, seconds(best), seconds(middle), f"{1e3 * each:.3g} ms"))
        record.append({"what": name, "seconds": best, "median": middle, "each": each})
    columns = ("what", "processor time", "median", "per set")
    print_table("Many parameter sets", columns, rows)
    print(f"\nBy the clock, {SETS} sets took {seconds(wall)} on two threads.")
    record.append({"what": "1000 sets by the clock", "seconds": wall})
    write_results("batch", record)


if __name__ == "__main__":
    main()
