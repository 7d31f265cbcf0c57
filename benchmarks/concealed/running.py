"""Running the tool on cases, as a user would: the command line, files in, JSON out.

Only the public folder is read. A case that has an answer is not run again, so an
interrupted run goes on where it stopped.
"""

import json
import math
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

PROGRAM = "from bondgraph.cli import main; main()"

ONE_PROCESS = """
import json, os, pathlib, sys, time
from bondgraph.cli import main
for job in json.load(sys.stdin):
    os.chdir(job["folder"])
    begin, busy, code = time.perf_counter(), time.process_time(), 0
    try:
        sys.argv = ["bondgraph", *job["arguments"]]
        main()
    except SystemExit as ended:
        code = ended.code or 0
    status = "answered" if code == 0 else "refused" if code == 2 else "failed"
    record = {"status": status, "seconds": time.perf_counter() - begin,
              "cpu_seconds": time.process_time() - busy}
    pathlib.Path(job["record"]).write_text(json.dumps(record), "utf-8")
"""
"""The same command line for one case after the other, started once."""


def run_all(
    public: Path,
    answers: Path,
    *,
    workers: int,
    limit: float,
    names: Sequence[str] = (),
    most: int | None = None,
    again: bool = False,
    budget: float = math.inf,
) -> None:
    """Run `bondgraph diagnose` on every case that has no answer yet.

    Parameters
    ----------
    limit
        Seconds for one case; it is stopped after that, and counted as such.
    names
        Words of which a case's name must contain one.
    most
        How many cases at most, from the beginning of the list.
    again
        Whether to run cases again that were refused or failed.
    budget
        Seconds for all; cases that do not begin in time are left for another run, and
        one that is cut off by it is not counted against the tool.
    """
    answers.mkdir(parents=True, exist_ok=True)
    found = sorted(path.parent for path in public.glob("*/case.json"))
    found = [c for c in found if not names or any(n in c.name for n in names)][:most]
    waiting = [c for c in found if not _done(answers / f"{c.name}.run.json", again)]
    print(f"{len(found)} cases, {len(waiting)} to run", flush=True)
    end = time.monotonic() + budget

    def work(case: Path) -> str:
        left = end - time.monotonic()
        if left <= 0.0:
            return f"{case.name:40s} not run: the time for all is over"
        return _run(case, answers, limit, workers, left)

    with ThreadPoolExecutor(workers) as pool:
        for line in pool.map(work, waiting):
            print(line, flush=True)


def run_in_one_process(public: Path, answers: Path, minutes: float) -> None:
    """Run every case without an answer in one process, which saves the starts.

    Parameters
    ----------
    minutes
        After which the search for one is ended; what it has found by then stands.
    """
    limit = ["--workers", "1", "--time-limit", str(minutes)]
    answers.mkdir(parents=True, exist_ok=True)
    jobs = [
        {
            "folder": str(case.resolve()),
            "arguments": [*_arguments(case, answers), *limit],
            "record": str((answers / f"{case.name}.run.json").resolve()),
        }
        for case in sorted(path.parent for path in public.glob("*/case.json"))
        if not (answers / f"{case.name}.run.json").exists()
    ]
    with (answers / "said.txt").open("w", encoding="utf-8") as said:
        subprocess.run(
            [sys.executable, "-c", ONE_PROCESS],
            input=json.dumps(jobs),
            text=True,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            stdout=said,
            stderr=subprocess.STDOUT,
            check=True,
        )


def _arguments(case: Path, answers: Path) -> list[str]:
    """Return the command that a user would type in a case's folder."""
    told = json.loads((case / "case.json").read_text("utf-8"))
    return [
        "diagnose",
        told["model"],
        *told["train"],
        *(word for name in told["held_out"] for word in ("--held-out", name)),
        *told["options"],
        *("--json", str((answers / f"{case.name}.json").resolve())),
    ]


def _done(record: Path, again: bool) -> bool:
    """Return whether a case needs no run."""
    if not record.exists():
        return False
    status = json.loads(record.read_text("utf-8"))["status"]
    return not (again and status in ("refused", "failed"))


def _run(case: Path, answers: Path, limit: float, workers: int, left: float) -> str:
    """Run one case, write its answer and how it went, and return a line about it."""
    answer = answers / f"{case.name}.json"
    command = [sys.executable, "-c", PROGRAM, *_arguments(case, answers)]
    threads = str(max(1, (os.cpu_count() or 1) // workers))
    environment = {**os.environ, "NUMBA_NUM_THREADS": threads, "OMP_NUM_THREADS": "1"}
    begin, status, words = time.perf_counter(), "answered", ""
    try:
        done = subprocess.run(
            command,
            cwd=case,
            env=environment,
            capture_output=True,
            text=True,
            timeout=min(limit, left),
            check=False,
        )
        words = done.stderr[-2000:]
        if done.returncode or not answer.exists():
            status = "refused" if done.returncode == 2 else "failed"
    except subprocess.TimeoutExpired:
        if left < limit:
            return f"{case.name:40s} cut off: the time for all is over"
        status = "too long"
    seconds = time.perf_counter() - begin
    (answers / f"{case.name}.run.json").write_text(
        json.dumps({"status": status, "seconds": seconds, "stderr": words}, indent=1),
        "utf-8",
    )
    verdict = ""
    if status == "answered":
        content = json.loads(answer.read_text("utf-8"))
        says = [f"{f['physics']} at {f['place']}" for f in content["findings"]]
        verdict = f"{content['verdict']}: {', '.join(says)}"
    return f"{case.name:40s} {seconds:6.1f} s  {status} {verdict}"
