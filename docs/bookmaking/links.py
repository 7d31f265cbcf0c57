"""Links from a page to a file of the repository that is not a page of the site."""

from pathlib import Path
from typing import Any

from docutils import nodes

ROOT = Path(__file__).resolve().parents[2]


def outside_the_site(
    app: Any, environment: Any, node: Any, content: nodes.Element
) -> nodes.Element | None:
    """Say where such a file lies; leave every other missing target a warning."""
    del app
    target = node.get("reftarget", "")
    here = Path(environment.doc2path(node["refdoc"])).parent
    for suffix in ("", ".md"):
        path = (here / f"{target}{suffix}").resolve()
        inside = path.is_relative_to(ROOT) and not path.is_relative_to(ROOT / "docs")
        if path.is_file() and inside:
            said = nodes.inline()
            said += content.deepcopy()
            said += nodes.Text(" (in the repository: ")
            said += nodes.literal(text=str(path.relative_to(ROOT)))
            said += nodes.Text(")")
            return said
    return None
