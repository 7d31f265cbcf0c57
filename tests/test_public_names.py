"""The public names: each imports, each is documented, and importing stays quick."""

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import bondgraph

SLOW = ("numba", "control", "matplotlib", "pandas", "pint", "sympy", "scipy", "rich")


@pytest.mark.parametrize("name", sorted(set(bondgraph.__all__) - {"__version__"}))
def test_every_public_name_imports_and_says_what_it_is(name):
    public = getattr(bondgraph, name)
    assert (public.__doc__ or "").strip()


def test_static_imports_name_what_is_served_at_run_time():
    tree = ast.parse(Path(bondgraph.__file__).read_text(encoding="utf-8"))
    static = {
        (node.module, alias.name)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("bondgraph")
        for alias in node.names
    }
    served = {(home, n) for home, names in bondgraph._HOME.items() for n in names}
    assert static == served
    for home, name in served:
        assert getattr(import_module(home), name) is getattr(bondgraph, name)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'BondGraf'"):
        bondgraph.BondGraf  # noqa: B018


@pytest.mark.parametrize("module", ["bondgraph", "bondgraph.cli"])
def test_importing_loads_nothing_slow(module):
    code = f"import sys, {module}; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert not set(SLOW) & set(done.stdout.split())
