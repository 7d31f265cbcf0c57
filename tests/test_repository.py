"""The outside of the repository: what the README promises, and what CI runs."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from xml.etree import ElementTree as ET

from packaging.requirements import Requirement

from bondgraph.loading import load_model

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    """Return the fenced blocks of the README in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.M | re.S)


def test_the_example_in_the_readme_runs_and_prints_what_it_says(capsys):
    (example,) = blocks("python")
    exec(compile(example, "README.md", "exec"), {})
    assert capsys.readouterr().out.strip() == example.rpartition("# ")[2].strip()


def test_the_two_commands_are_single_lines():
    demo, tests, _ = blocks("sh")
    for command in (demo, tests):
        assert command.count("\n") == 1
        assert command.startswith("python3 -m venv .venv && ")
    assert demo.endswith("bondgraph demo\n")
    assert tests.endswith("pytest\n")


def test_ci_ends_with_exactly_the_readme_s_test_command():
    lines = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines(True)
    assert lines[-1] == blocks("sh")[1]
    assert (ROOT / ".ci" / "run").stat().st_mode & 0o111


def test_every_page_that_is_linked_exists():
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    for page in pages:
        text = page.read_text(encoding="utf-8")
        for link in re.findall(r"\]\(([^)#]+)\)", text):
            assert (page.parent / link).exists(), f"{page.name}: {link}"


def test_the_totals_of_the_final_sets_are_their_sums_and_the_readme_s():
    proof = (ROOT / "docs" / "proof.md").read_text(encoding="utf-8")
    table = re.search(r"^\| set \| cases .*?(?=\n\n)", proof, flags=re.M | re.S)
    _, _, *rows = (line.split("|")[2:6] for line in table.group().splitlines())
    *sets, total, _ = [[re.findall(r"\d+", cell) for cell in row] for row in rows]
    sums = [
        [sum(map(int, numbers)) for numbers in zip(*column, strict=True)]
        for column in zip(*sets, strict=True)
    ]
    said = [
        list(map(int, cell[: len(own)])) for cell, own in zip(total, sums, strict=True)
    ]
    assert said == sums
    assert f"[measured on {sums[0][0]} cases](docs/proof.md)" in README


def test_the_picture_shows_the_drive_as_it_is():
    picture = ET.fromstring((ROOT / "docs" / "lowerleg_drive.svg").read_text("utf-8"))
    said = "".join(picture.itertext())
    for node in load_model("flegx_models.demo:drive").nodes:
        assert node.name in said


def test_constraints_pin_every_package_that_is_declared():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = [Requirement(line) for line in lines if line and not line.startswith("#")]
    assert all(str(pin.specifier).startswith("==") and pin.url is None for pin in pins)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    texts = [*project["dependencies"], *(text for extra in extras for text in extra)]
    declared = {Requirement(text).name for text in texts} - {project["name"]}
    assert len(declared) > 15
    assert declared <= {pin.name for pin in pins}


def test_what_a_former_install_has_left_does_not_hide_the_package(tmp_path):
    # pip leaves the loops that were compiled, in folders without an __init__.py.
    (tmp_path / "bondgraph" / "numeric" / "__pycache__").mkdir(parents=True)
    told = subprocess.run(
        [
            sys.executable,
            "-c",
            "import bondgraph.numeric.model as m; print(m.__file__)",
        ],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert told.returncode == 0, told.stderr
    assert "model.py" in told.stdout
