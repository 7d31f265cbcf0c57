"""Every mutant tried by the tests that run its line, in a process of its own."""

import json
import os
import random
import resource
import signal
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from importlib import import_module
from itertools import accumulate
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from benchmarks.mutation.covering import COLLECTING, COVERED, TESTS, TRUSTED
from benchmarks.mutation.mutants import Mutant, mutants_of
from benchmarks.mutation.placing import (
    give_other_code,
    import_instead,
    is_inside_function,
)

HEAVY = ("numpy", "scipy.linalg", "scipy.sparse.linalg", "scipy.special", "sympy",
         "networkx", "pint", "numba", "pytest", "control")  # fmt: skip
"""Imported once, before processes are split off.

Not what pytest wants to import itself (hypothesis): it would warn, and end with that.
"""

OPTIONS = ("-q", "-s", "-n0", "-p", "no:cacheprovider", "--no-header")
SURVIVED, KILLED, NOT_PLACED, NOT_RUN = 0, 1, 98, 99
"""What the status of a process says; the last, that pytest could not even begin."""

MOST_SECONDS = 10.0
"""Of tests that a mutant has to live through: some lines are run by a thousand."""

LEAST_LIMIT = 10  # s of processor time for one test
IMPORTING_LIMIT = 60  # s of processor time until the first test
FEW = 60  # tests, by which it is checked that all is well without a mutant
TRIED = "tried.jsonl"


@dataclass(frozen=True, slots=True)
class Trial:
    """A mutant, or none, and the tests that it has to live through."""

    mutant: Mutant | None
    tests: tuple[str, ...]


Try = Callable[[Trial], str]


def try_mutants(work: Path, sample: int, seed: int, seconds: float, only: str) -> None:
    """Try a sample of all mutants that was not tried yet, as long as there is time."""
    if not (work / COVERED).exists():
        raise SystemExit(
            "Which test runs which line is not known yet: say coverage first."
        )
    covered = json.loads((work / COVERED).read_text())
    every = [
        mutant
        for folder in TRUSTED
        for path in sorted(Path(folder).rglob("*.py"))
        for mutant in mutants_of(path)
    ]
    drawn = random.Random(seed).sample(every, min(sample, len(every)))
    done = {entry["name"] for entry in entries(work)}
    waiting = [m for m in drawn if m.name not in done and only in m.path]

    def go_through(imported_anew: Try, in_place: Try) -> None:
        quickest = tuple(_ordered(covered["seconds"], covered["seconds"])[:FEW])
        for way in (imported_anew, in_place):
            if (fate := way(Trial(None, quickest))) != "survived":
                raise SystemExit(f"The tests do not pass without a mutant: {fate}.")
        began = time.monotonic()
        for mutant in waiting:
            if time.monotonic() - began > seconds:
                break
            found = _tried(mutant, covered, imported_anew, in_place)
            entry = {"name": mutant.name, "of": len(every), **found}
            with (work / TRIED).open("a", encoding="utf-8") as file:
                file.write(json.dumps(entry) + "\n")

    _with_both_ways(covered["seconds"], go_through)


def entries(work: Path) -> list[dict[str, Any]]:
    """Return what was tried so far, each mutant once: two runs may share the file."""
    file = work / TRIED
    text = file.read_text() if file.exists() else ""
    found = map(json.loads, text.splitlines())
    return list({entry["name"]: entry for entry in found}.values())


def _tried(
    mutant: Mutant, covered: dict[str, Any], imported_anew: Try, in_place: Try
) -> dict[str, Any]:
    """Return what became of a mutant: killed, out of time, survived or not run."""
    contexts = _contexts(mutant, covered["lines"].get(mutant.path, {}))
    seconds = covered["seconds"]
    chosen = _ordered({c for c in contexts if c != COLLECTING}, seconds)
    known = _within(chosen, seconds)
    found = {"tests": len(known), "left out": len(chosen) - len(known)}
    if not chosen:
        return {"fate": "not run", **found}
    fate = ""
    # What ran while tests were collected has left results of what is right.
    if COLLECTING not in contexts and is_inside_function(mutant):
        fate = in_place(Trial(mutant, tuple(known)))
    for some in _first_files(known) if not fate else ():
        fate = imported_anew(Trial(mutant, some))
        if fate != "survived":
            break
    return {"fate": fate, **found}


def _first_files(tests: list[str]) -> list[tuple[str, ...]]:
    """Return the tests of two files, then the others: importing all takes longest."""
    files = list(dict.fromkeys(test.partition("::")[0] for test in tests))[:2]
    first = tuple(t for t in tests if t.partition("::")[0] in files)
    rest = tuple(t for t in tests if t not in set(first))
    return [some for some in (first, rest) if some]


def _contexts(mutant: Mutant, lines: dict[str, list[str]]) -> set[str]:
    """Return the tests that run a mutant's line, all of the module where none does.

    Of a statement of many lines some are not told: the last one before counts.
    """
    before = [int(line) for line in lines if int(line) <= mutant.line]
    found = set(lines[str(max(before))]) if before else {COLLECTING}
    if found != {COLLECTING}:
        return found
    return {context for contexts in lines.values() for context in contexts}


def _ordered(tests: Iterable[str], seconds: dict[str, float]) -> list[str]:
    """Return the quickest first, the n-th case of one test as if n times as long.

    What a hundred cases do not notice, the next hardly does.
    """
    cases: Counter[str] = Counter()
    costs = {}
    for test in sorted(tests, key=lambda test: (seconds[test], test)):
        function = test.partition("[")[0]
        cases[function] += 1
        costs[test] = cases[function] * seconds[test]
    return sorted(costs, key=lambda test: (costs[test], test))


def _within(tests: list[str], seconds: dict[str, float]) -> list[str]:
    """Return the first of the tests, as many as take `MOST_SECONDS` together."""
    taken = accumulate(seconds[test] for test in tests)
    return [
        test
        for test, so_far in zip(tests, taken, strict=True)
        if so_far <= MOST_SECONDS
    ]


def _with_both_ways(
    seconds: dict[str, float], go_through: Callable[[Try, Try], None]
) -> None:
    """Have mutants tried from before and from after all tests were collected."""
    for name in HEAVY:
        import_module(name)
    ours, theirs = Pipe()
    if os.fork() == 0:
        ours.close()
        _serve(theirs, seconds)
    theirs.close()

    def imported_anew(trial: Trial) -> str:
        ours.send(trial)
        return str(ours.recv())

    class Collected:
        """Goes through the mutants where the tests would be run."""

        def pytest_runtestloop(self, session: Any) -> bool:
            items = {item.nodeid: item for item in session.items}

            def begin(trial: Trial) -> int:
                try:
                    if trial.mutant is not None:
                        give_other_code(trial.mutant)
                except (LookupError, ValueError):
                    return NOT_PLACED
                return _live_through(session, [items[t] for t in trial.tests], seconds)

            go_through(imported_anew, lambda trial: _fate(lambda: begin(trial)))
            return True

    files = [test for test in TESTS if Path(test).exists()]
    import_module("pytest").main([*OPTIONS, *files], [Collected()])
    ours.close()


def _serve(asked: Connection, seconds: dict[str, float]) -> None:
    """Answer with what tests made of mutants, each imported anew; never return."""

    class Chosen:
        """Runs the tests that were collected, until one fails."""

        def pytest_runtestloop(self, session: Any) -> bool:
            if not session.testsfailed:
                os._exit(_live_through(session, session.items, seconds))
            return True

    def begin(trial: Trial) -> int:
        if trial.mutant is not None:
            import_instead(trial.mutant)
        found = import_module("pytest").main([*OPTIONS, *trial.tests], [Chosen()])
        return KILLED if found else SURVIVED

    try:
        while True:
            trial = asked.recv()
            asked.send(_fate(lambda trial=trial: begin(trial)))
    except EOFError:
        os._exit(0)


def _live_through(session: Any, items: Sequence[Any], seconds: dict[str, float]) -> int:
    """Run tests until one fails; each may take ten times as long as it did."""
    for item, following in zip(items, [*items[1:], None], strict=True):
        _limit(LEAST_LIMIT + int(10.0 * seconds[item.nodeid]))
        item.ihook.pytest_runtest_protocol(item=item, nextitem=following)
        if session.testsfailed:
            return KILLED
    return SURVIVED


def _limit(seconds: int) -> None:
    """End this process after so much more processor time, or where it hangs."""
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (int(time.process_time()) + seconds, most))
    signal.alarm(10 * seconds)


def _fate(begin: Callable[[], int]) -> str:
    """Return what tests made of a mutant; empty where it could not be placed."""
    child = os.fork()
    if child == 0:
        _die_of_it(begin)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return "out of time"
    code = os.WEXITSTATUS(status)
    if code == NOT_RUN:
        raise SystemExit("pytest itself failed: what it says of mutants means nothing.")
    return {SURVIVED: "survived", NOT_PLACED: ""}.get(code, "killed")


def _die_of_it(begin: Callable[[], int]) -> None:
    """Run the tests, say by the status what came of it, and never return."""
    code = NOT_RUN
    try:
        _limit(IMPORTING_LIMIT)
        silent = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silent, 1)
        os.dup2(silent, 2)
        code = begin()
    finally:
        os._exit(code)
