"""A diagnosis that is stopped at random moments by real signals goes on to the same.

    python -m benchmarks.interruptions --stops 10

Each stop starts the diagnosis in a process of its own, waits until a random number of
results more is in its journal, and sends SIGINT or SIGKILL to it, or SIGKILL to one of
its workers. Afterwards it is let run, and its answer is held against that of a run that
nobody stopped, byte for byte. It also looks for processes that were left behind.
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.diagnosis_cost import chain, recorded
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.work import workers
from bondgraph.diagnosis.work.journal import FILE
from bondgraph.diagnosis.work.workers import Here, Processes
from bondgraph.physics.library import LIBRARY
from bondgraph.reporting.diagnosis_json import diagnosis_to_dict

ANSWER = "answer.json"


def one(folder: Path, count: int, words: list[str]) -> None:
    """Diagnose a chain of two masses, going on from what is in the folder."""
    workers.POOL_PAYS = 0.0
    options = Options(
        where=Processes(count) if count > 1 else Here(),
        library=tuple(p for p in LIBRARY if not words or p.word in words),
        most_findings=1,
        resume=folder,
    )
    training, held_out = recorded(2, 1500, 1), recorded(2, 800, 2)
    found = diagnose(chain(2), [training], held_out=[held_out], options=options)
    (folder / ANSWER).write_text(json.dumps(diagnosis_to_dict(found)))


def started(folder: Path, count: int, words: list[str]) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", __spec__.name, "--one", str(folder)]
    command += ["--workers", str(count), *(f"--law={word}" for word in words)]
    return subprocess.Popen(command, stderr=subprocess.DEVNULL)


def kept(folder: Path) -> int:
    """Return how many results are in the journal."""
    file = folder / FILE
    return file.read_bytes().count(b"\n") if file.exists() else 0


def children(process: int) -> list[int]:
    """Return the processes that a process has started, theirs too."""
    direct = Path(f"/proc/{process}/task/{process}/children")
    found = list(map(int, direct.read_text().split())) if direct.exists() else []
    return [*found, *(inner for child in found for inner in children(child))]


def stop(folder: Path, count: int, words: list[str], dice: random.Random) -> str:
    """Start, stop at a random moment, and say how."""
    more = kept(folder) + dice.randint(1, 6)
    process = started(folder, count, words)
    while process.poll() is None and kept(folder) < more:
        time.sleep(0.02)
    theirs = children(process.pid)
    how = dice.choice(["SIGINT", "SIGKILL", "worker"] if count > 1 else
                      ["SIGINT", "SIGKILL"])  # fmt: skip
    if process.poll() is not None:
        return "had ended"
    if how == "worker":
        if theirs:
            os.kill(dice.choice(theirs), signal.SIGKILL)
        process.wait()
        return f"worker of {len(theirs)} killed, ended with {process.returncode}"
    process.send_signal(getattr(signal, how))
    process.wait()
    time.sleep(2.0)
    left = [child for child in theirs if Path(f"/proc/{child}").exists()]
    return f"{how} at {kept(folder)} results, {len(left)} processes left behind"


def main() -> None:
    """Stop, go on, compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stops", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--law", action="append", default=[], help="only these")
    parser.add_argument("--one", type=Path, help="diagnose once, in this folder")
    chosen = parser.parse_args()
    if chosen.one:
        one(chosen.one, chosen.workers, chosen.law)
        return
    dice = random.Random(chosen.seed)
    with tempfile.TemporaryDirectory() as name:
        whole, stopped = Path(name, "whole"), Path(name, "stopped")
        for folder in (whole, stopped):
            folder.mkdir()
        for _ in range(chosen.stops):
            print(stop(stopped, chosen.workers, chosen.law, dice), flush=True)
        for folder, count in ((stopped, chosen.workers), (whole, 1)):
            started(folder, count, chosen.law).wait()
        same = (whole / ANSWER).read_bytes() == (stopped / ANSWER).read_bytes()
        print("the answer is the same" if same else "THE ANSWER DIFFERS")
        raise SystemExit(0 if same else 1)


if __name__ == "__main__":
    main()
