"""The tutorials run from a fresh kernel, and what they show is what is kept in them."""

import runpy
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "tutorials"
# The fourth, with a diagnosis in it, is too long for every run: `execute.py` runs it.
QUICK = ("first_bond_graph", "flegx_from_bonds_to_controller", "your_own_machine")
TUTORIALS = [FOLDER / f"{name}.ipynb" for name in QUICK]
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


@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.stem)
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


def test_links_between_tutorials_lead_somewhere():
    names = {path.name for path in FOLDER.glob("*.ipynb")}
    for path in FOLDER.glob("*.ipynb"):
        cells = nbformat.read(path, as_version=4).cells
        for cell in cells:
            for part in cell.source.split("](")[1:]:
                target = part.partition(")")[0]
                assert target.startswith("https://") or target in names
