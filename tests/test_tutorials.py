"""The tutorials run from a fresh kernel, and what they show is what is kept in them."""

import re
import runpy
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "tutorials"
TUTORIALS = sorted(FOLDER.glob("*.ipynb"))
MARKED = [
    pytest.param(one, marks=pytest.mark.long) if "motor" in one.stem else one
    for one in TUTORIALS
]
EXECUTE = runpy.run_path(str(ROOT / "docs" / "tutorials" / "execute.py"))


def kinds(notebook):
    """Return what every cell shows: the kinds of its outputs, in their order."""
    return [
        [
            sorted(output.get("data", {})) or output.get("name", output.output_type)
            for output in cell.get("outputs", ())
        ]
        for cell in notebook.cells
    ]


@pytest.mark.parametrize("path", MARKED, ids=lambda path: path.stem)
def test_a_tutorial_runs_and_shows_what_is_kept_in_it(path, tmp_path):
    again = EXECUTE["tidied"](EXECUTE["executed"](path, tmp_path))
    assert kinds(again) == kinds(nbformat.read(path, as_version=4))


@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.stem)
def test_a_tutorial_is_kept_with_what_it_shows_and_nothing_of_a_machine(path):
    text = path.read_text(encoding="utf-8")
    notebook = nbformat.reads(text, as_version=4)
    assert sum(map(len, kinds(notebook))) >= 5
    for private in ("/root/", "/home/", "/tmp/", "/work/"):
        assert private not in text


def test_what_the_motor_lacked_is_what_was_left_out_of_its_equations():
    """The recording is stepped by hand with 95 kg, 203 N·s/m and 20 N dry friction."""
    kept = nbformat.read(FOLDER / "why_does_my_motor_not_match.ipynb", as_version=4)
    printed = "".join(
        output.text
        for cell in kept.cells
        for output in cell.get("outputs", ())
        if output.get("name") == "stdout"
    )
    assert "friction at carriage was left out" in printed
    said = dict(re.findall(r"^(\w+) = ([-\d.]+) ±", printed, re.M))
    assert float(said["mass"]) == pytest.approx(95.0, rel=0.01)
    assert float(said["viscous"]) == pytest.approx(203.0, rel=0.01)
    assert float(said["coulomb_carriage"]) == pytest.approx(20.0, rel=0.01)


def test_links_between_tutorials_lead_somewhere():
    names = {path.name for path in FOLDER.glob("*.ipynb")}
    for path in FOLDER.glob("*.ipynb"):
        cells = nbformat.read(path, as_version=4).cells
        for cell in cells:
            for part in cell.source.split("](")[1:]:
                target = part.partition(")")[0]
                assert target.startswith("https://") or target in names
