"""Every block of every page runs as a reader would type it, and every link leads on.

Python blocks of a page run in order, in one namespace and an empty folder. Shell blocks
call the program with the files that the page speaks of; one that is not run says why in
a comment above it: ``<!-- not run: reason -->``.
"""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.io import savemat

from bondgraph.cli.program import program

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = sorted(p for p in DOCS.rglob("*.md") if "generated" not in p.parts)
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
