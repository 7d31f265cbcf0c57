"""Every block of every page runs as a reader would type it, and every link leads on.

Python blocks of a page run in order, in one namespace and an empty folder. Shell blocks
call the program with the files that the page speaks of; one that is not run says why in
a comment above it: ``<!-- not run: reason -->``. A command or an option that a sentence
speaks of exists.
"""

import doctest
import re
import shlex
import shutil
import subprocess
from importlib import import_module
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.io import savemat

from bondgraph import C99, BondGraph, I, R, Se, export
from bondgraph.cli.program import COMMANDS, program

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = sorted(p for p in DOCS.rglob("*.md") if "generated" not in p.parts)
OUTSIDE = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md")]
SHELL = re.compile(
    r"(?:<!-- not run: (.+?) -->\n)?```(?:sh|shell|bash)\n(.*?)^```", re.M | re.S
)


def name(page: Path) -> str:
    return str(page.relative_to(DOCS).with_suffix(""))


def blocks(page: Path) -> list[str]:
    text = page.read_text(encoding="utf-8")
    return re.findall(r"^```python\n(.*?)^```", text, flags=re.M | re.S)


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p)], ids=name)
def test_the_code_of_a_page_runs(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, object] = {}
    for block in blocks(page):
        exec(compile(block, page.name, "exec"), namespace)


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_between_pages_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#:\s]+)\)", page.read_text(encoding="utf-8")):
        if "generated" not in Path(target).parts:
            assert (page.parent / target).exists(), f"{page.name} links to {target}"


WITHIN = {"extending/a_reader": "is written against the layer that reads files"}
OTHERS = [*sorted((ROOT / "examples").rglob("*.py")), *sorted(DOCS.rglob("*.ipynb"))]


@pytest.mark.parametrize("page", [*PAGES, *OTHERS], ids=lambda page: page.stem)
def test_what_a_page_teaches_is_imported_from_the_package_itself(page: Path) -> None:
    if page.is_relative_to(DOCS) and name(page) in WITHIN:
        return
    deep = re.compile(r"^[\s\"]*(?:from|import) bondgraph\.\S+", re.M)
    assert not deep.findall(page.read_text(encoding="utf-8"))


LEG = "from flegx_models.models import lowerleg_flight as {name}\n"
WITHOUT = (
    "from bondgraph import BondGraph, I, Se\n\n\n"
    "def leg():\n"
    '    graph = BondGraph("lower leg", domain="rotation")\n'
    '    graph.one("joint", Se("torque"), I("shank"))\n'
    '    graph.measure("angle", displacement="joint")\n'
    "    return graph\n"
)
AXIS = (
    "from bondgraph import BondGraph, I, R, Se\n\n\n"
    "def axis() -> BondGraph:\n"
    '    graph = BondGraph("axis", domain="translation")\n'
    '    graph.one("carriage", Se("force"), I("mass"), R("viscous"))\n'
    '    graph.measure("position", displacement="carriage")\n'
    '    graph.parameter("mass", 2.0, "kg", bounds=(0.1, 10))\n'
    '    graph.parameter("viscous", 1.0, "N*s/m", bounds=(0, 10))\n'
    "    return graph\n"
)


def lay_out(page: Path) -> None:
    """Put the files that the pages speak of into the working folder."""
    Path("leg.py").write_text(LEG.format(name="flight"), encoding="utf-8")
    Path("before.py").write_text(WITHOUT, encoding="utf-8")
    with_friction = WITHOUT.replace("I, Se", "I, R, Se").replace(
        'I("shank")', 'I("shank"), R("bearing")'
    )
    Path("after.py").write_text(with_friction, encoding="utf-8")
    Path("axis.py").write_text(AXIS, encoding="utf-8")
    time = np.arange(0.0, 4.0, 0.01)
    # x'' + x' = sin t from rest, of a mass of 1 and a damper of 1.
    way = 1.0 - 0.5 * (np.exp(-time) + np.sin(time) + np.cos(time))
    noise = 1e-3 * np.random.default_rng(5).normal(size=time.size)
    savemat("run.mat", {"t": time, "qm": way + noise, "F": np.sin(time)})
    for spec in re.findall(
        r"^```toml\n(.*?)^```", page.read_text("utf-8"), re.M | re.S
    ):
        Path("spec.toml").write_text(spec, encoding="utf-8")


SHELL_PAGES = [p for p in PAGES if SHELL.search(p.read_text(encoding="utf-8"))]


@pytest.mark.parametrize("page", SHELL_PAGES, ids=name)
def test_the_commands_of_a_page_are_served(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    lay_out(page)
    for reason, block in SHELL.findall(page.read_text(encoding="utf-8")):
        if reason:
            continue
        for line in filter(None, block.splitlines()):
            words = shlex.split(line, comments=True)
            assert words[0] == "bondgraph", f"{page.name} does not say why not: {line}"
            answer = CliRunner().invoke(program, words[1:])
            served = {0, 1} if words[1] == "diff" else {0}
            assert answer.exit_code in served, f"{line}\n{answer.output}"


SHOWN = {
    "python": "run by a test here; that of the README by one of the repository",
    "sh": "run by a test here, or says why it is not",
    "toml": "laid out for the commands of its page",
    "c": "compiled by a test here",
    "matlab": "run by the tests of the export, where Octave is",
    "text": "what something prints",
    "{include}": "", "{toctree}": "", "{raw}": "", "{eval-rst}": "",
}  # fmt: skip
FENCE = re.compile(r"^ *```+ *(\S*).*\n((?:.*\n)*?) *```+ *$", re.M)
COMMAND = re.compile(
    r"^\s*(?:\$ |bondgraph |python3? |pip |\.venv/|sphinx-build )", re.M
)


@pytest.mark.parametrize("page", [*PAGES, *OUTSIDE], ids=lambda page: page.stem)
def test_every_block_is_of_a_kind_that_is_tried(page: Path) -> None:
    for language, block in FENCE.findall(page.read_text(encoding="utf-8")):
        assert language in SHOWN, f"{page.name}: {block}"
        if language == "text":
            assert not COMMAND.search(block), f"{page.name} hides a command: {block}"


def test_every_block_of_the_readme_is_run_or_says_why_not() -> None:
    readme = OUTSIDE[0].read_text(encoding="utf-8")
    commands = SHELL.findall(readme)
    assert len(commands) == readme.count("```sh\n") == 3
    assert all(reason for reason, _ in commands)


@pytest.mark.parametrize("page", [*PAGES, *OUTSIDE], ids=lambda page: page.stem)
def test_commands_and_options_spoken_of_exist(page: Path) -> None:
    root = click.Context(program, info_name="bondgraph")
    options = {
        option
        for command in (program, *(program.get_command(root, n) for n in COMMANDS))
        if command is not None
        for parameter in command.params
        for option in (*parameter.opts, *parameter.secondary_opts)
    } | {"--help", "--version"}
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    for said in re.findall(r"`([^`]+)`", text):
        first, *words = said.split()
        if first == "bondgraph" and words and words[0].isalpha() and words[0].islower():
            assert words[0] in COMMANDS, f"{page.name}: {said}"
        if first == "bondgraph" or (first[:2] == "--" and "benchmarks." not in text):
            found = {w.partition("=")[0] for w in (first, *words) if w[:2] == "--"}
            assert found <= options, f"{page.name}: {said}"


WITH_EXAMPLES = [
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in sorted((ROOT / "bondgraph").rglob("*.py"))
    if ">>> " in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("module", WITH_EXAMPLES)
def test_examples_in_docstrings_print_what_they_say(module: str) -> None:
    result = doctest.testmod(import_module(module))
    assert result.attempted > 0
    assert result.failed == 0


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not here")
def test_the_c_of_the_page_on_exports_compiles_and_runs(tmp_path: Path) -> None:
    (block,) = re.findall(
        r"^```c\n(.*?)^```", (DOCS / "export.md").read_text(), re.M | re.S
    )
    include, _, body = block.partition("\n\n")
    leg = BondGraph("leg", domain="rotation")
    leg.one("joint", Se("torque"), I("shank"), R("c"))
    leg.parameter("shank", 0.1, "kg*m^2")
    leg.parameter("c", 0.3, "N*m*s")
    leg.measure("angle", displacement="joint")
    for file in export(leg.finish(), C99("leg")):
        (tmp_path / file.name).write_text(file.text, encoding="utf-8")
    given = "double t = 0.0, u[1] = {0.1};"
    text = f"{include}\nint main(void) {{ {given} {body} return status; }}\n"
    (tmp_path / "main.c").write_text(text, encoding="utf-8")
    words = ["gcc", "leg.c", "main.c", "-o", "run", "-lm"]
    subprocess.run(words, cwd=tmp_path, check=True)
    assert subprocess.run([tmp_path / "run"], check=False).returncode == 0
