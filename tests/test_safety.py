"""Only model files are code: no data, result or page ever makes the program run any.

What could execute something is listed here, each place with the reason why it is safe.
A new place fails the first test, until somebody has thought about it.
"""

import ast
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

import bondgraph
from bondgraph import (
    TF,
    BondGraph,
    I,
    Parameter,
    PublishedResult,
    R,
    Se,
    bind_to,
    derive,
    linearise,
    read_recording,
    reconcile,
    steady_state,
)
from bondgraph.checking.run import run_checks
from bondgraph.cli.shaping_file import read_request
from bondgraph.errors import BondGraphError
from bondgraph.structure.units import conversion

PACKAGE = Path(bondgraph.__file__).parent
ROOT = PACKAGE.parent
PROGRAMS = [ROOT / name for name in ("bondgraph", "flegx_models")]

EXECUTING = {
    "eval", "exec", "compile", "__import__", "import_module", "exec_module",
    "sympify", "S", "parse_expr", "parse_latex", "lambdify", "system", "popen",
    "Popen", "run_path", "run_module", "Markup", "loadmat", "read_pickle", "genfromtxt",
    "fork", "execv", "from_string", "startfile",
}  # fmt: skip
"""Names of functions that may make code of text, or trust text."""

NEVER = {
    "pickle", "cPickle", "dill", "cloudpickle", "joblib", "shelve", "marshal", "yaml",
    "ctypes", "cffi", "code", "runpy", "dbm", "xmlrpc", "telnetlib", "ftplib",
    "urllib.request", "http", "requests", "socket",
}  # fmt: skip
"""Modules without a use here: their files are programs, or they leave the machine."""

TRUSTING = (
    "innerHTML outerHTML insertAdjacentHTML document.write eval( Function( http:// "
    "https:// import( srcdoc"
).split()
"""What makes markup or code of a text in a page, or fetches some."""

ALLOWED = {
    ("bondgraph/__init__.py", "import_module"): "our own modules, by a table of names",
    ("bondgraph/cli/program.py", "import_module"): "our own commands, by their table",
    ("bondgraph/notebook/__init__.py", "import_module"): "our own, by a table",
    ("bondgraph/cli/work_options.py", "import_module"): "Dask, by its name",
    ("bondgraph/progress.py", "import_module"): "IPython, by its name",
    ("bondgraph/simulation/adaptive.py", "import_module"): "a solver, by its name",
    (
        "bondgraph/loading.py",
        "exec_module",
    ): "a model file is Python",
    ("bondgraph/loading.py", "import_module"): "a model named by the user",
    ("bondgraph/numeric/implicit/laws.py", "lambdify"): "expressions, never text",
    ("flegx_models/jump/mechanics.py", "lambdify"): "expressions, never text",
    ("bondgraph/reporting/python_expressions.py", "eval"): "text printed there before, "
    "from an expression, with names that were made identifiers",
    ("bondgraph/structure/signals.py", "sympify"): "strict: text is refused",
    ("bondgraph/reporting/report.py", "Markup"): "our own drawing, which escapes names",
    ("bondgraph/recordings/binary_tables.py", "loadmat"): "numbers; objects refused",
}


def sources():
    files = [file for program in PROGRAMS for file in sorted(program.rglob("*.py"))]
    assert len(files) > 300
    return files


def called(node):
    match node.func:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name
    return ""


def test_what_could_execute_text_is_where_it_is_allowed():
    found = Counter()
    for file in sources():
        where = file.relative_to(ROOT).as_posix()
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            match node:
                case ast.Call() if called(node) in EXECUTING:
                    if ast.unparse(node.func) != "re.compile":
                        found[where, called(node)] += 1
                case ast.keyword(arg="allow_pickle" | "shell"):
                    assert ast.unparse(node.value) == "False", where
                case ast.Import(names=names):
                    imported = {name.name for name in names}
                    assert not imported & NEVER, where
                case ast.ImportFrom(module=str(module)):
                    assert module not in NEVER, where
                    assert module.split(".")[0] not in NEVER, where
    assert {*found} - {*ALLOWED} == set()
    assert {*ALLOWED} - {*found} == set(), "no longer there: take it off the list"


def test_numpy_reads_no_objects():
    for file in sources():
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "np.load":
                given = {keyword.arg for keyword in node.keywords}
                assert "allow_pickle" in given, file


def test_no_template_trusts_a_text():
    for file in (PACKAGE / "reporting" / "templates").iterdir():
        text = file.read_text("utf-8")
        assert "safe" not in [w.strip() for w in text.replace("}}", "|").split("|")]
        assert "autoescape" not in text
        for trusting in TRUSTING:
            assert trusting not in text.replace("http://www.w3.org/", ""), file.name


# What follows tries it: each text would leave a file behind if it were executed.


@pytest.fixture
def trap(tmp_path):
    left = tmp_path / "executed"
    yield f"__import__('pathlib').Path({str(left)!r}).touch()"
    assert not left.exists()


def cart():
    graph = BondGraph("cart", domain="translation")
    graph.one("body", Se("force"), I("mass"), R("rub"))
    graph.measure("speed", flow="body")
    graph.parameter("mass", 1.0, "kg")
    graph.parameter("rub", 1.0, "N*s/m")
    return graph.finish()


def published(formula):
    result = PublishedResult(name="a", value=1.0, rounding=0.1, formula=formula)
    return reconcile([result], {"m": Parameter(name="m", value=1.0, unit="kg")})


@pytest.mark.parametrize(
    "use",
    [
        lambda text: R("rub", law=text),
        TF,
        lambda text: BondGraph("cart").measure("x", text, unit="m"),
        lambda text: linearise(derive(cart()), at={"force": text}),
        lambda text: steady_state(cart(), hold={"force": text}),
        lambda text: cart().with_parameters({"mass": text}),
        lambda text: conversion(text, "m"),
        published,
    ],
    ids="law name measurement point steady_state value unit formula".split(),
)
def test_text_in_place_of_a_number_or_expression_is_refused(trap, use):
    with pytest.raises((BondGraphError, ValueError, TypeError)):
        use(trap)


def test_names_and_units_of_a_recording_stay_text(trap, tmp_path):
    file = tmp_path / "run.csv"
    rows = "".join(f"{0.1 * i:g},{i},{i}\n" for i in range(20))
    file.write_text(f'"time [s]","{trap} [N]","speed [{trap}]"\n{rows}')
    with pytest.raises(BondGraphError):
        bind_to(cart(), read_recording(file))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("checks.toml", 'model = "cart.py:cart"\nquantity = "gain"\nvalue = "TRAP"'),
        ("checks.toml", 'model = "TRAP"\nquantity = "gain"\nvalue = 1.0'),
        ("shape.toml", 'at = {speed = "TRAP"}'),
        ("shape.toml", 'delay = "TRAP"'),
    ],
)
def test_files_of_declarations_stay_data(trap, tmp_path, name, text):
    file = tmp_path / name
    head = '[[check]]\nname = "a"\ninput = "force"\noutput = "speed"\ndigits = 2\n'
    head = head if name == "checks.toml" else ""
    file.write_text(head + text.replace("TRAP", trap))
    read = run_checks if name == "checks.toml" else read_request
    with pytest.raises(BondGraphError):
        read(file)


def test_objects_in_data_files_are_not_built(tmp_path):
    cell = np.empty(2, dtype=object)
    cell[:] = [np.arange(3.0), "text"]
    file = tmp_path / "cell.mat"
    savemat(file, {"time": np.arange(3.0), "x": cell})
    with pytest.raises(BondGraphError, match="not an array of numbers"):
        read_recording(file, mapping={"time": "time [s]", "x": "x [m]"})


def test_objects_in_hdf5_are_no_channels(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file["time"] = np.arange(3.0)
        file["x"] = np.array(["a", "b", "c"], dtype=object)
    with pytest.raises(BondGraphError, match="x"):
        read_recording(tmp_path / "run.h5", units={"time": "s", "x": "m"})


def test_every_package_that_ci_installs_is_pinned_by_digests():
    text = (ROOT / ".ci" / "requirements.txt").read_text("utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    pins = [line for line in lines if not line.startswith(" ")]
    assert len(pins) > 60
    assert all("==" in pin for pin in pins)
    for line, after in zip(lines, [*lines[1:], ""], strict=True):
        if not line.startswith(" "):
            assert after.startswith("    --hash=sha256:"), line


def test_the_digests_are_of_the_versions_that_were_tested():
    tested, pinned = (
        dict(re.findall(r"^([a-z0-9.-]+)==([^ \n]+)", text, flags=re.M))
        for text in (
            (ROOT / "constraints.txt").read_text("utf-8"),
            (ROOT / ".ci" / "requirements.txt").read_text("utf-8"),
        )
    )
    assert {n: v for n, v in pinned.items() if tested.get(n, v) != v} == {}
