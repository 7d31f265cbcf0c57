"""Execute the tutorials and keep what they show: the notebooks are read as pages.

    python docs/tutorials/execute.py [NOTEBOOK ...]

What changes from run to run without meaning (times, counters, widths of a machine) is
left out, so that a notebook changes where its content does.
"""

import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode

HERE = Path(__file__).parent
TIMEOUT = 1800  # s, for one cell; the first one may have to compile, on a busy machine


def executed(path: Path, folder: Path) -> NotebookNode:
    """Return a notebook run from a fresh kernel in `folder`."""
    notebook = nbformat.read(path, as_version=4)
    resources = {"metadata": {"path": str(folder)}}
    client = NotebookClient(
        notebook,
        timeout=TIMEOUT,
        kernel_name="python3",
        resources=resources,
        coalesce_streams=True,  # A busy machine sends in two parts what is one print.
    )
    client.execute()
    return notebook


def tidied(notebook: NotebookNode) -> NotebookNode:
    """Return a notebook without what says nothing about its content."""
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook.metadata = NotebookNode({"kernelspec": kernel})
    for number, cell in enumerate(notebook.cells):
        cell.metadata = NotebookNode()
        cell.id = f"cell-{number}"
        if cell.cell_type == "code":
            cell.outputs = [one for one in cell.outputs if not _is_time_taken(one)]
        for output in cell.get("outputs", ()):
            if "data" in output:
                output.data.pop("text/plain", None) if len(output.data) > 1 else None
    return notebook


def _is_time_taken(output: NotebookNode) -> bool:
    """Return whether an output is what is left of a bar of progress."""
    return str(output.get("data", {}).get("text/html", "")).startswith("<small>done in")


def main(names: list[str]) -> None:
    """Execute the notebooks that are named, or all, and write them where they are."""
    paths = [Path(name) for name in names] or sorted(HERE.glob("*.ipynb"))
    for path in paths:
        with tempfile.TemporaryDirectory() as folder:
            nbformat.write(tidied(executed(path, Path(folder))), path)
        print(path.name)


if __name__ == "__main__":
    main(sys.argv[1:])
