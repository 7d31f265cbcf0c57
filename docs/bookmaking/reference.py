"""The reference: every public name with its docstring, a page per floor."""

import inspect
from enum import Enum

import sympy

import bondgraph

FLOORS = {
    "structure": "Structure: graphs, elements, parameters, edits",
    "physics": "The library of physics",
    "causality": "Causality",
    "equations": "Equations",
    "numeric": "Numbers",
    "recordings": "Recordings",
    "simulation": "Simulation",
    "loopshaping": "Loop shaping",
    "fitting": "Fitting",
    "diagnosis": "Diagnosis",
    "reporting": "Reporting and export",
    "reconciliation": "Reconciliation of published numbers",
    "checking": "Checks, loading, notebooks, errors",
}
"""Floors from the lowest to the highest, as design goes, with the title of the page."""

_LAST = "checking"


def floor_of(name: str) -> str:
    """Return the floor that the public name `name` lives on."""
    home = bondgraph._homes()[name].split(".")[1]
    return home if home in FLOORS else _LAST


def pages() -> dict[str, str]:
    """Return the page of every floor by its file name."""
    found: dict[str, list[str]] = {floor: [] for floor in FLOORS}
    for name in bondgraph._homes():
        found[floor_of(name)].append(name)
    return {f"{floor}.md": _page(floor, names) for floor, names in found.items()}


def _page(floor: str, names: list[str]) -> str:
    blocks = "\n\n".join(_directive(name) for name in sorted(names, key=str.lower))
    return f"# {FLOORS[floor]}\n\n```{{eval-rst}}\n{blocks}\n```\n"


def _directive(name: str) -> str:
    value = getattr(bondgraph, name)
    path = f"bondgraph.{name}"
    if inspect.isclass(value):
        lines = [f".. autoclass:: {path}", "   :members:"]
        if issubclass(value, Enum):
            lines.append("   :undoc-members:")
        return "\n".join(lines)
    if inspect.isfunction(value):
        return f".. autofunction:: {path}"
    if isinstance(value, sympy.Symbol):
        return f".. py:data:: {path}\n\n   {_VARIABLES[name]}, in a law."
    return f".. autodata:: {path}\n   :no-value:"


_VARIABLES = {
    "e": "The effort of the element itself",
    "f": "The flow of the element itself",
    "p": "The momentum of the element itself",
    "q": "The displacement of the element itself",
    "t": "Time in seconds",
}


def escape_bars(
    app: object, what: str, name: str, obj: object, options: object, lines: list[str]
) -> None:
    """Let the bars of an absolute value be bars: reST takes them for substitutions."""
    del app, what, name, obj, options
    lines[:] = [line.replace("|", "\\|") for line in lines]
