"""Cells of notebooks are IPython: a line may begin with ``!`` or ``%``."""

from typing import Any

from docutils import nodes


def read_as_ipython(app: Any, doctree: nodes.document) -> None:
    """Let the code of a notebook be coloured as what it is."""
    if str(app.env.doc2path(app.env.docname)).endswith(".ipynb"):
        for block in doctree.findall(nodes.literal_block):
            if block.get("language") == "python":
                block["language"] = "ipython3"
