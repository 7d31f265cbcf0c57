"""Which test runs which line, how long each takes, and the coverage of branches."""

import json
import time
from importlib import import_module
from pathlib import Path
from typing import Any

TRUSTED = ("bondgraph/causality", "bondgraph/equations", "bondgraph/diagnosis/evidence")
TESTS = tuple(
    f"tests/test_{name}.py"
    for name in (
        "catalogue causality causality_choices causality_exhaustive "
        "causality_words composition diagnosis_workers energy equations "
        "equations_exactly evidence evidence_exactly explicit_form fields "
        "flegx_models hard_contact hard_numbers implicit_route invariants jump "
        "kinks latex laws_turned_round linear_systems mechanics model_channels "
        "model_text planar_leg port_hamiltonian port_laws search_rules sensitivities "
        "set_valued_friction sparse_jacobian steady_state transfer_matrix"
    ).split()
)
"""The quickest that check these packages; others would kill more, for a longer wait."""

COVERED = "coverage.json"
COLLECTING = ""
"""Stands for the test where a line is run by no test, but while tests are imported."""


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
    lines = {_relative(f): data.contexts_by_lineno(f) for f in data.measured_files()}
    found = {"failed": int(failed), "seconds": listener.seconds, "lines": lines}
    (work / COVERED).write_text(json.dumps(found))
    branches = work / "branches.json"
    measured.json_report(outfile=str(branches))
    measured.report(show_missing=True, skip_covered=True)
    print(_shares(json.loads(branches.read_text())["files"]))


def _shares(files: dict[str, Any]) -> str:
    """Return package by package how many branches were taken."""
    lines = []
    for package in TRUSTED:
        inside = [f["summary"] for name, f in files.items() if name.startswith(package)]
        every = sum(summary["num_branches"] for summary in inside)
        taken = sum(summary["covered_branches"] for summary in inside)
        share = 100 * taken / every if every else 100.0
        lines.append(f"{package}: {taken} of {every} branches taken ({share:.1f} %)")
    return "\n".join(lines)


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
        self.measured.switch_context(COLLECTING)


def _relative(file: str) -> str:
    return Path(file).resolve().relative_to(Path.cwd()).as_posix()
