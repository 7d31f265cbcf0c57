"""Links from a page to a file of the repository that is not a page of the site."""

from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx import addnodes

DOCS = Path(__file__).resolve().parents[1]
ROOT = DOCS.parent


def name_files_outside(app: Any, doctree: nodes.document) -> None:
    """Turn a link to a file beside the documentation into words that say where it is.

    The site is a folder of its own, so that there is nothing such a link could open.
    A target that does not exist stays, and Sphinx warns of it.
    """
    here = Path(app.env.doc2path(app.env.docname)).parent
    for link in list(doctree.findall(addnodes.pending_xref)):
        target = link.get("reftarget", "")
        for path in (here / target, here / f"{target}.md", Path(f"{target}.md")):
            found = path.resolve()
            if found.is_file() and not found.is_relative_to(DOCS):
                link.replace_self(_said(link, found))
                break


def _said(link: addnodes.pending_xref, path: Path) -> nodes.inline:
    said = nodes.inline()
    said += [child.deepcopy() for child in link.children]
    said += nodes.Text(" (in the repository: ")
    said += nodes.literal(text=str(path.relative_to(ROOT)))
    said += nodes.Text(")")
    return said
