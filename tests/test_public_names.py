"""The public names: each imports, each is documented, and importing stays quick."""

import ast
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

import bondgraph

ROOT = Path(__file__).parent.parent
SLOW = ("numba", "control", "matplotlib", "pandas", "pint", "sympy", "scipy", "rich")


@pytest.mark.parametrize("name", sorted(set(bondgraph.__all__) - {"__version__"}))
def test_every_public_name_imports_and_says_what_it_is(name):
    public = getattr(bondgraph, name)
    assert (public.__doc__ or "").strip()


def test_every_name_of_the_stub_is_served_from_where_it_says():
    stub = Path(bondgraph.__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    lines = [line for line in ast.parse(stub).body if isinstance(line, ast.ImportFrom)]
    stated = [(line.module, alias) for line in lines for alias in line.names]
    names = [alias.name for _, alias in stated]
    assert len(set(names)) == len(names) == len(bondgraph.__all__) - 1
    for home, alias in stated:
        assert alias.asname == alias.name  # or type checkers take it for private
        served = getattr(bondgraph, alias.name)
        assert served is getattr(import_module(f"bondgraph.{home}"), alias.name)


def test_what_editors_read_is_delivered():
    pyproject = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    delivered = set(pyproject["tool"]["setuptools"]["package-data"]["*"])
    assert {"py.typed", "*.pyi"} <= delivered
    assert set(dir(bondgraph)) == set(bondgraph.__all__)


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
