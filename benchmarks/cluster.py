"""A diagnosis on a Dask cluster of this machine: a worker killed, and what it costs.

    python -m benchmarks.cluster kill      # a worker is killed: the same answer?
    python -m benchmarks.cluster cost      # 1 and 2 workers
    python -m benchmarks.cluster pieces    # every piece, and a model up to 1000 workers

All times are processor seconds, which others on the machine change little. A step of a
diagnosis (a screening, a list of fits) waits for its slowest piece, so the time of a
diagnosis is that of the process that asks (with the scheduler, which runs in it here),
and for every step that of its busiest worker. The model deals the pieces of every step,
in their order and as long as they were, to the workers who are free first.
"""

import argparse
import heapq
import json
import os
import pickle
import random
import signal
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.diagnosis_cost import chain, recorded
from benchmarks.measuring import machine, print_table
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.work.workers import Here, On, Where
from bondgraph.reporting.diagnosis_json import diagnosis_to_dict
from bondgraph.simulation.threads import THREADS

RESULTS = Path(__file__).parent / "results" / "cluster.json"
WORKERS = (1, 2, 4, 8, 16, 32, 64, 125, 250, 500, 1000)
ONE_EACH = 10**9
"""So many workers make batches of one piece."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A batch that a worker did: of which step, by whom, in how many seconds."""

    step: int
    worker: int
    seconds: float
    sent: int


@dataclass(slots=True)
class Watched(Executor):
    """An executor that notes what every piece of work took, and where it was done."""

    inner: Executor
    heard: Callable[[], None] = lambda: None
    step: int = 0
    pieces: list[Piece] = field(default_factory=list)
    weighing: float = 0.0
    stages: dict[str, float] = field(default_factory=dict)
    stage: str = "fitting and adequacy, before the search"
    since: float = field(default_factory=time.process_time)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **rest: Any) -> Future[Any]:
        """Have the work done by the inner executor, and note what it took."""
        begin, step = time.process_time(), self.step
        sent = len(pickle.dumps((fn, args)))
        self.weighing += time.process_time() - begin
        outer: Future[Any] = Future()

        def done(future: Future[Any]) -> None:
            if error := future.exception():
                outer.set_exception(error)
                return
            result, worker, seconds = future.result()
            self.pieces.append(Piece(step, worker, seconds, sent))
            outer.set_result(result)
            self.heard()

        self.inner.submit(_timed, fn, *args, **rest).add_done_callback(done)
        return outer

    def progress(self, sentence: str) -> None:
        """Begin another step where the diagnosis says that it does."""
        self.step += sentence.endswith("to do")
        self.mark()
        self.stage = sentence.split(",", maxsplit=1)[0]

    def mark(self) -> None:
        """Book what the asking process has done on the stage that it was at."""
        now = time.process_time()
        before = self.stages.get(self.stage, 0.0)
        self.stages[self.stage] = before + now - self.since
        self.since = now


def _timed(work: Callable[..., Any], *args: Any) -> tuple[Any, int, float]:
    begin = time.thread_time()
    result = work(*args)
    return result, os.getpid(), time.thread_time() - begin


@contextmanager
def cluster(count: int) -> Iterator[Any]:
    """Yield a client of a cluster of so many processes with one thread each."""
    os.environ[THREADS] = "1"
    import distributed  # noqa: PLC0415

    with (
        distributed.LocalCluster(
            n_workers=count, threads_per_worker=1, dashboard_address=None
        ) as local,
        distributed.Client(local) as client,
    ):
        yield client


def answered(masses: int, samples: int, where: Where, progress: Any = None) -> str:
    """Return the answer of a diagnosis as JSON."""
    training, held_out = recorded(masses, samples, 1), recorded(masses, 800, 2)
    found = diagnose(
        chain(masses),
        [training],
        held_out=[held_out],
        options=Options(where=where, most_findings=1),
        progress=progress or (lambda _: None),
    )
    return json.dumps(diagnosis_to_dict(found))


def killed(masses: int, samples: int, seed: int) -> int:
    """Kill one of two workers in the middle; return 1 if the answer differs."""
    dice = random.Random(seed)
    alone = answered(masses, samples, Here())
    with cluster(2) as client:
        watched = Watched(client.get_executor())
        after = dice.randint(8, 40)

        def kill() -> None:
            if len(watched.pieces) == after:
                victim = dice.choice(sorted({piece.worker for piece in watched.pieces}))
                os.kill(victim, signal.SIGKILL)
                print(f"worker {victim} killed after {after} batches", flush=True)

        watched.heard = kill
        shared = answered(masses, samples, On(watched, 2), watched.progress)
        took_part = {piece.worker for piece in watched.pieces}
        print(f"{len(watched.pieces)} batches by {len(took_part)} processes")
    print("the answer is the same" if alone == shared else "THE ANSWER DIFFERS")
    return int(alone != shared or len(took_part) < 3)


@dataclass(frozen=True, slots=True)
class Cost:
    """What one diagnosis took.

    Parameters
    ----------
    asking
        Processor seconds of the process that asks, the scheduler included.
    pieces
        What the workers did.
    wall
        Seconds on the wall.
    stages
        Processor seconds of the process that asks, by what it said last.
    """

    asking: float
    pieces: tuple[Piece, ...]
    wall: float
    stages: dict[str, float]

    @property
    def working(self) -> float:
        """Processor seconds of all workers together."""
        return sum(piece.seconds for piece in self.pieces)

    @property
    def busiest(self) -> float:
        """The busiest worker's processor seconds of every step, added up."""
        by_step: dict[int, dict[int, float]] = {}
        for piece in self.pieces:
            took = by_step.setdefault(piece.step, {})
            took[piece.worker] = took.get(piece.worker, 0.0) + piece.seconds
        return sum(max(took.values()) for took in by_step.values())

    def with_workers(self, count: int) -> float:
        """Return what the model says of so many workers, in seconds."""
        total, steps = self.asking, sorted({piece.step for piece in self.pieces})
        for step in steps:
            free = [0.0] * count
            for piece in self.pieces:
                if piece.step == step:
                    heapq.heappush(free, heapq.heappop(free) + piece.seconds)
            total += max(free)
        return total


def measured(masses: int, samples: int, count: int, batches_for: int) -> Cost:
    """Return what a diagnosis takes on a cluster that has loaded everything."""
    with cluster(count) as client:
        pool = client.get_executor()
        answered(masses, 300, On(pool, count))
        watched = Watched(pool)
        begin, asking = time.perf_counter(), time.process_time()
        answered(masses, samples, On(watched, batches_for), watched.progress)
        asking = time.process_time() - asking - watched.weighing
        wall = time.perf_counter() - begin
        watched.mark()
    return Cost(asking, tuple(watched.pieces), wall, watched.stages)


def cost(masses: int, samples: int) -> dict[str, Any]:
    """Measure one and two workers; print and return all of it."""
    counted = {n: measured(masses, samples, n, n) for n in (1, 2)}
    rows = [
        [
            str(n), f"{c.asking:.1f} s", f"{c.working:.1f} s", f"{c.busiest:.1f} s",
            f"{c.asking + c.busiest:.1f} s", f"{c.wall:.0f} s",
        ]
        for n, c in counted.items()
    ]  # fmt: skip
    print_table(
        f"{masses} masses, {samples} samples",
        ["workers", "asking", "working", "busiest", "asking and busiest", "wall"],
        rows,
    )
    return {
        str(n): {
            "asking": c.asking, "working": c.working, "busiest": c.busiest,
            "wall": c.wall, "batches": len(c.pieces),
        }
        for n, c in counted.items()
    }  # fmt: skip


def pieces(masses: int, samples: int) -> dict[str, Any]:
    """Measure every piece alone, and say what more workers would make of it."""
    single = measured(masses, samples, 2, ONE_EACH)
    first = single.with_workers(1)
    model = {n: single.with_workers(n) for n in WORKERS}
    print_table(
        f"{masses} masses: {len(single.pieces)} pieces, {single.asking:.1f} s asked",
        ["workers", "model", "speed-up"],
        [[str(n), f"{t:.1f} s", f"{first / t:.2f}"] for n, t in model.items()],
    )
    stages = sorted(single.stages.items(), key=lambda item: -item[1])
    print_table(
        "where the asking process spends it",
        ["stage", "processor time"],
        [[stage, f"{took:.1f} s"] for stage, took in stages[:8]],
    )
    per_step: dict[int, list[float]] = {}
    for piece in single.pieces:
        per_step.setdefault(piece.step, []).append(piece.seconds)
    sizes = sorted(piece.sent for piece in single.pieces)
    print(f"\nsent with a piece: median {sizes[len(sizes) // 2] / 1e3:.0f} kB")
    print("pieces, mean seconds: " + ", ".join(
        f"{len(took)} x {sum(took) / len(took):.2f}" for took in per_step.values()
    ))  # fmt: skip
    return {
        "pieces": list(per_step.values()),
        "asking": single.asking,
        "stages": single.stages,
        "bytes_sent_with_a_piece": sizes[len(sizes) // 2],
        "model": model,
    }


def main() -> int:
    """Kill, or measure."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("mode", choices=["kill", "cost", "pieces"])
    words.add_argument("--masses", type=int, default=2)
    words.add_argument("--samples", type=int, default=1200)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--out", type=Path, default=RESULTS)
    asked = words.parse_args()
    if asked.mode == "kill":
        return killed(asked.masses, asked.samples, asked.seed)
    measure = {"cost": cost, "pieces": pieces}[asked.mode]
    known = json.loads(asked.out.read_text()) if asked.out.exists() else {}
    found = measure(asked.masses, asked.samples)
    case = f"{asked.mode}: {asked.masses} masses, {asked.samples} samples"
    known[case] = {"machine": machine(), **found}
    asked.out.write_text(json.dumps(known, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
