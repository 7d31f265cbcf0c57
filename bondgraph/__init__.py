"""bondgraph: from a drawn machine to its equations, its fit and what it leaves out.

The public names are stated in ``__init__.pyi`` and imported on first use, so that
``import bondgraph`` stays quick while type checkers and editors know every name.
"""

from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

__version__ = "0.1.0"


@cache
def _homes() -> dict[str, str]:
    """Return the module of every public name, as the stub beside this file says."""
    import ast  # noqa: PLC0415

    stub = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    return {
        alias.name: f"{__name__}.{node.module}"
        for node in ast.parse(stub).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def __getattr__(name: str) -> Any:
    if name == "__all__":
        return __dir__()
    if not name.startswith("_") and (home := _homes().get(name)):
        return getattr(import_module(home), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*_homes(), "__version__"])
