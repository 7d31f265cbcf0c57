"""Which test runs which line, and every mutant tried by the tests that run its line."""

import json
import os
import random
import resource
import sys
import time
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_loader
from itertools import accumulate
from pathlib import Path
from types import ModuleType
from typing import Any

from benchmarks.mutation.mutants import Mutant, mutants_of, mutated

TRUSTED = ("bondgraph/causality", "bondgraph/equations", "bondgraph/diagnosis/evidence")
TESTS = tuple(
    f"tests/test_{name}.py"
    for name in (
        "catalogue causality causality_choices causality_exhaustive "
        "causality_words composition diagnosis_workers energy equations "
        "equations_exactly evidence evidence_exactly explicit_form fields "
        "flegx_models hard_contact hard_numbers implicit_route invariants jump "
        "latex laws_turned_round linear_systems mechanics model_channels "
        "model_text planar_leg port_hamiltonian search_rules sensitivities "
        "set_valued_friction sparse_jacobian steady_state transfer_matrix"
    ).split()
)
"""The quickest that check these packages; others would kill more, for a longer wait."""

HEAVY = ("numpy", "scipy.linalg", "scipy.sparse.linalg", "scipy.special", "sympy",
         "networkx", "pint", "numba", "pytest", "control")  # fmt: skip
"""Imported once, before processes are split off.

Not what pytest wants to import itself (hypothesis): it would warn, and end with that.
"""

NOT_RUN = 99
"""The status of a process in which pytest could not even begin."""

FIRST_TESTS = 60
"""So many of those that run a mutant's line are tried first, the quickest."""

MOST_SECONDS = 40.0
"""Of tests, the quickest first, that a mutant has to live through: some lines are run
by a thousand tests.
"""

LEAST_LIMIT = 20.0  # s of processor time, with what is imported
COVERED, TRIED = "coverage.json", "tried.jsonl"


def cover(work: Path) -> None:
    """Run the tests once; keep how long each takes and which lines each runs."""
    try:
        coverage = import_module("coverage")
    except ModuleNotFoundError:
        raise SystemExit(
            "This needs the package coverage: pip install -e '.[benchmarks]'."
        ) from None
    pytest = import_module("pytest")
    measured = coverage.Coverage(
        branch=True, source=list(TRUSTED), data_file=str(work / "coverage")
    )
    listener = _Listener(measured)
    measured.start()
    files = [test for test in TESTS if Path(test).exists()]
    failed = pytest.main(["-q", "-n0", "-p", "no:cacheprovider", *files], [listener])
    measured.stop()
    measured.save()
    data = measured.get_data()
    lines = {
        _relative(file): {
            str(line): [context for context in contexts if context]
            for line, contexts in data.contexts_by_lineno(file).items()
        }
        for file in data.measured_files()
    }
    found = {"failed": int(failed), "seconds": listener.seconds, "lines": lines}
    (work / COVERED).write_text(json.dumps(found))
    measured.json_report(outfile=str(work / "branches.json"))
    measured.report(show_missing=True, skip_covered=True)


class _Listener:
    """Tells coverage which test is running, and times it."""

    def __init__(self, measured: Any) -> None:
        self.measured = measured
        self.seconds: dict[str, float] = {}

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        self.measured.switch_context(nodeid)
        self.seconds[nodeid] = -time.process_time()

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        self.seconds[nodeid] += time.process_time()
        self.measured.switch_context("")


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
    for name in HEAVY:
        import_module(name)
    _check_unchanged(covered["seconds"])
    began = time.monotonic()
    for mutant in drawn:
        if mutant.name in done or only not in mutant.path:
            continue
        if time.monotonic() - began > seconds:
            break
        entry = {"name": mutant.name, "of": len(every), **_tried(mutant, covered)}
        with (work / TRIED).open("a", encoding="utf-8") as file:
            file.write(json.dumps(entry) + "\n")


def entries(work: Path) -> list[dict[str, Any]]:
    """Return what was tried so far, each mutant once: two runs may share the file."""
    file = work / TRIED
    text = file.read_text() if file.exists() else ""
    found = map(json.loads, text.splitlines())
    return list({entry["name"]: entry for entry in found}.values())


def _tried(mutant: Mutant, covered: dict[str, Any]) -> dict[str, Any]:
    """Return what became of a mutant: killed, out of time, survived or not run."""
    lines = covered["lines"].get(mutant.path, {})
    tests = lines.get(str(mutant.line)) or [
        test for contexts in lines.values() for test in contexts
    ]
    seconds = covered["seconds"]
    chosen = sorted(set(tests), key=lambda test: (seconds[test], test))
    if not chosen:
        return {"fate": "not run", "tests": 0}
    fate = "survived"
    known = _within(chosen, seconds)
    for some in (known[:FIRST_TESTS], known[FIRST_TESTS:]):
        if some and fate == "survived":
            limit = LEAST_LIMIT + 10.0 * sum(seconds[test] for test in some)
            fate = _fate(mutant, some, int(limit))
    return {"fate": fate, "tests": len(known), "left out": len(chosen) - len(known)}


def _within(tests: list[str], seconds: dict[str, float]) -> list[str]:
    """Return the first of the tests, as many as take `MOST_SECONDS` together."""
    taken = accumulate(seconds[test] for test in tests)
    return [
        test
        for test, so_far in zip(tests, taken, strict=True)
        if so_far <= MOST_SECONDS
    ]


def _check_unchanged(seconds: dict[str, float]) -> None:
    """Refuse to go on where tests fail without a mutant: all would seem killed."""
    quickest = sorted(seconds, key=lambda test: (seconds[test], test))[:FIRST_TESTS]
    limit = LEAST_LIMIT + 10.0 * sum(seconds[test] for test in quickest)
    if (fate := _fate(None, quickest, int(limit))) != "survived":
        raise SystemExit(f"The tests do not pass without a mutant: {fate}.")


def _fate(mutant: Mutant | None, tests: list[str], limit: int) -> str:
    """Run tests in a process of their own, and say what they made of a mutant."""
    child = os.fork()
    if child == 0:
        _die_of_it(mutant, tests, limit)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return "out of time"
    code = os.WEXITSTATUS(status)
    if code == NOT_RUN:
        raise SystemExit("pytest itself failed: what it says of mutants means nothing.")
    return "killed" if code else "survived"


def _die_of_it(mutant: Mutant | None, tests: list[str], limit: int) -> None:
    """Run the tests with the mutant in place of its module; never return."""
    code = NOT_RUN
    try:
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
        silent = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silent, 1)
        os.dup2(silent, 2)
        if mutant is not None:
            sys.meta_path.insert(0, _Finder(mutant))
        options = ["-x", "-q", "-n0", "-p", "no:cacheprovider", "--no-header"]
        code = int(import_module("pytest").main([*options, *tests]))
    finally:
        os._exit(code)


class _Finder(MetaPathFinder):
    """Finds the mutant's module, and nothing else."""

    def __init__(self, mutant: Mutant) -> None:
        self.mutant = mutant
        self.name = mutant.path.removesuffix(".py").replace("/", ".")

    def find_spec(
        self, name: str, path: object = None, target: object = None
    ) -> ModuleSpec | None:
        """Return where the mutant's module comes from."""
        if name != self.name:
            return None
        return spec_from_loader(name, _Mutated(self.mutant), origin=self.mutant.path)


class _Mutated(Loader):
    """Executes the mutant's tree as the module."""

    def __init__(self, mutant: Mutant) -> None:
        self.mutant = mutant

    def exec_module(self, module: ModuleType) -> None:
        """Execute the module with the change made."""
        module.__file__ = str(Path(self.mutant.path).resolve())
        exec(compile(mutated(self.mutant), module.__file__, "exec"), module.__dict__)


def _relative(file: str) -> str:
    return Path(file).resolve().relative_to(Path.cwd()).as_posix()
