"""The table that leads from the thesis to the code does not rot."""

import re
import runpy
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs" / "flegx_models.md").read_text(encoding="utf-8")
ELSEWHERE = (
    r"(?:section|chapter|figure|table)s?\s+\d\.\d[\d.]*(?:\s+(?:to|and)\s+\d\.[\d.]+)*"
)
LAST = {3: 34, 4: 36, 5: 24, 6: 5}  # the thesis's last equation of each chapter


def rows():
    """Return (thesis, where, test) of every row of the table."""
    table = PAGE.partition("## From the thesis to the code")[2]
    found = re.findall(r"^\| (.+?) \| .+? \| `(.+?)` \| `(.+?)` \|$", table, flags=re.M)
    assert len(found) == table.count("\n| ") - 2
    return found


def equations(text):
    """Return the equations (chapter, number) that a text names, ranges filled in."""
    named = set()
    for first, last in re.findall(r"\b(\d\.\d+)(?:\s+to\s+(\d\.\d+))?", text):
        chapter, start = map(int, first.split("."))
        end = int(last.split(".")[1]) if last else start
        named |= {(chapter, number) for number in range(start, end + 1)}
    return named


def thesis_equations(thesis):
    """Return the equations of a row, not its figures and tables."""
    (part,) = re.findall(r"eq\. ([\d., to]+?)(?:, figure.*)?$", thesis) or [""]
    return equations(part)


def test_every_equation_of_the_thesis_is_in_the_table():
    listed = set().union(*(thesis_equations(thesis) for thesis, *_ in rows()))
    assert listed == {(c, k) for c, last in LAST.items() for k in range(1, last + 1)}


@pytest.mark.parametrize(("thesis", "where", "test"), rows())
def test_a_row_leads_to_code_that_names_its_equations_and_to_a_test(
    thesis, where, test
):
    module, _, name = where.rpartition(".")
    home = import_module(f"flegx_models.{module}")
    thing = getattr(home, name)
    texts = [home.__doc__, thing.__doc__]
    texts += [member.__doc__ for member in vars(type(thing)).values()]
    if isinstance(thing, type):
        texts += [member.__doc__ for member in vars(thing).values()]
    whole = " ".join(text for text in texts if text)
    written = equations(re.sub(ELSEWHERE, "", whole, flags=re.I))
    assert thesis_equations(thesis) <= written
    file, _, function = test.partition("::")
    assert f"def {function}(" in (ROOT / "tests" / file).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "chapter", ["chapter3", "chapter4_models", "chapter5_loops", "chapter6_jump"]
)
def test_a_chapters_script_still_finds_what_it_draws(chapter):
    script = runpy.run_path(str(ROOT / "examples" / f"{chapter}.py"))
    assert callable(script["main"])


def test_chapter_5s_script_prints_its_tables():
    script = runpy.run_path(str(ROOT / "examples" / "chapter5_loops.py"))
    assert script["versions_table"]().count("\n") == 12
    assert "45.20" in script["loop_table"]()
    assert "-29.24" in script["gravity_table"]()
