"""Trials in a process of their own: a crash or a hang ends one trial, not the sweep.

The worker writes one JSON line per trial. Where none comes in time it is killed, where
it dies it is replaced, and the trial that it was at is written down as what happened.
"""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector
from typing import Any

LIMIT = 60.0
"""Seconds of processor time for one trial, the start of its process included."""

WAITING = 20.0
"""Seconds on the wall per second of processor time: others use the machine too."""

MEMORY = 4 << 30
"""Bytes of address space of a worker; numba and its libraries take one of them."""

Line = dict[str, Any]


def watched(
    kind: str, first: int, count: int, *, limit: float = LIMIT
) -> Iterator[Line]:
    """Yield what became of trials `first` to ``first + count - 1``, in order."""
    at, end = first, first + count
    while at < end:
        command = [sys.executable, "-m", "benchmarks.fuzzing", "worker", kind]
        with subprocess.Popen(
            [*command, str(at), str(end - at)], stdout=subprocess.PIPE
        ) as worker:
            assert worker.stdout is not None
            for line in _lines(worker, limit):
                yield line
                at += 1
            if at < end:
                worker.kill()
                ended = worker.wait()
                hung = ended in (0, -signal.SIGKILL)
                said = "killed" if hung else f"the process ended with {ended}"
                yield {"seed": at, "end": "HUNG" if hung else "CRASHED", "said": said}
                at += 1


def _lines(worker: "subprocess.Popen[bytes]", limit: float) -> Iterator[Line]:
    """Yield a worker's JSON lines until it ends or one takes it too long."""
    assert worker.stdout is not None
    pipe, left = worker.stdout.fileno(), b""
    used, seen = 0.0, time.monotonic()
    with DefaultSelector() as selector:
        selector.register(pipe, EVENT_READ)
        while True:
            if selector.select(min(limit, 1.0)):
                more = os.read(pipe, 1 << 16)
                if not more:
                    return
                *lines, left = (left + more).split(b"\n")
                yield from map(json.loads, lines)
                used, seen = _processor_time(worker.pid), time.monotonic()
                continue
            worked = _processor_time(worker.pid) - used
            if worked > limit or time.monotonic() - seen > WAITING * limit:
                return


def _processor_time(pid: int) -> float:
    """Return the seconds that a process and the children it waited for have used."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text()
    except FileNotFoundError:
        return 0.0
    ticks = stat.rpartition(")")[2].split()[11:15]
    return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


def work(trial: Callable[[int], Line], first: int, count: int) -> None:
    """Run trials and write a line for each: what a worker does."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    for seed in range(first, first + count):
        try:
            line = trial(seed)
        except Exception as error:  # a trial that fails is what is looked for
            line = {
                "seed": seed,
                "end": "CRASHED",
                "said": f"{type(error).__name__}: {error}",
            }
        print(json.dumps(line), flush=True)
