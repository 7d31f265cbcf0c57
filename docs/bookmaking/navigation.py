"""Lists of pages that are kept by what is there: tutorials, and what no part lists.

A page that was only just written is found in the site before anyone has thought of a
better place for it, and a part may be named before it is written.
"""

import re
from collections.abc import Iterable
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
TUTORIALS = (
    "first_bond_graph",
    "flegx_from_bonds_to_controller",
    "why_does_my_motor_not_match",
    "your_own_machine",
)
"""The order in which they are read; others follow."""

_TOCTREE = re.compile(r"^```\{toctree\}\n(.*?)^```", re.M | re.S)


def tutorials() -> dict[str, str]:
    """Return the list of the tutorials that are there."""
    folder = DOCS / "tutorials"
    there = {p.stem for p in folder.iterdir() if p.suffix in (".md", ".ipynb")}
    there -= {"index"}
    order = [name for name in TUTORIALS if name in there]
    return {"list.inc": _toctree([*order, *sorted(there - set(order))])}


def rest() -> dict[str, str]:
    """Return the list of the top pages that no other list names."""
    listed = {name for page in DOCS.rglob("*.md") for name in named(page)}
    missing = sorted(p.stem for p in DOCS.glob("*.md") if p.stem not in listed)
    return {"rest.inc": _toctree(f"../{name}" for name in missing if name != "index")}


def named(page: Path) -> set[str]:
    """Return the names of the pages, without folders, that a page lists."""
    found = set()
    for body in _TOCTREE.findall(page.read_text(encoding="utf-8")):
        for line in body.splitlines():
            if line and not line.startswith(":"):
                target = re.sub(r".*<(.+)>", r"\1", line.strip())
                found.add(target.rpartition("/")[2])
    return found


def _toctree(names: Iterable[str]) -> str:
    lines = "\n".join(names)
    return f"```{{toctree}}\n:maxdepth: 1\n\n{lines}\n```\n" if lines else "\n"
