"""Compiled loops on disk belong to the sources they were compiled from, all of them."""

import ast
import importlib
import os
import pickle
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numba
import numpy as np
import pytest
from numba import njit

import bondgraph
from bondgraph.numeric.compiled.cache import SOURCES, UNUSED, cache_folder, kept_in
from bondgraph.numeric.compiled.loops import FOLDER
from bondgraph.numeric.kernel.machine import run
from bondgraph.simulation.shots import Shots


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Return a package whose sources lie where those of compiled loops do."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    for name in SOURCES:
        (tmp_path / "package" / name).mkdir(parents=True)
        (tmp_path / "package" / name / "loop.py").write_text(f"a = '{name}'\n")
    return tmp_path / "package"


@pytest.mark.parametrize("name", SOURCES)
def test_another_state_of_any_source_has_another_folder(package, name):
    before = cache_folder(package)
    assert cache_folder(package) == before
    (package / "apart.py").write_text("b = 2\n")
    assert cache_folder(package) == before
    (package / name / "loop.py").write_text("a = 2\n")
    changed = cache_folder(package)
    (package / name / "further.py").write_text("")
    assert len({before, changed, cache_folder(package)}) == 3
    assert before.is_dir()  # a process may still be at work with it


def test_a_loop_is_compiled_anew_when_what_it_calls_changes(package, monkeypatch):
    monkeypatch.syspath_prepend(str(package / "kernel"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    source = "from numba import njit\n@njit(cache=True)\n"
    called, loop = package / "kernel" / "called.py", package / "kernel" / "calling.py"
    loop.write_text(f"from called import two\n{source}def loop():\n    return two()\n")

    def answer(number, folder):
        called.write_text(f"{source}def two():\n    return {number}\n")
        for module in ("called", "calling"):
            sys.modules.pop(module, None)
        importlib.invalidate_caches()
        with kept_in(folder or cache_folder(package)):
            return importlib.import_module("calling").loop()

    assert [answer(2, None), answer(3, None), answer(2, None)] == [2, 3, 2]
    shared = package / "shared"  # what numba does by itself, or this tests nothing
    assert [answer(2, shared), answer(3, shared)] == [2, 2]
    for module in ("called", "calling"):
        sys.modules.pop(module)


def test_the_loops_of_the_kernel_lie_in_the_folder_of_their_sources():
    assert Path(run.stats.cache_path).parent == FOLDER


def test_what_compiled_loops_are_made_of_lies_in_their_packages_or_their_file():
    root = Path(bondgraph.__file__).parent
    made_of = tuple(f"bondgraph.numeric.{name}." for name in SOURCES)
    loops = 0
    for path in root.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        taken = {
            (str(node.module), alias.name)
            for node in tree.body
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
        decorators = {"compiled", "lean", "inlined"}
        if decorators & {n for m, n in taken if m.endswith("compiled.loops")}:
            loops += 1
            own = {m for m, _ in taken if m.startswith("bondgraph")}
            assert all(m.startswith(made_of) for m in own), path
    assert loops > 15


def test_where_the_installation_cannot_be_written_the_user_s_caches_are_used(package):
    (package / "__pycache__").write_text("no folder can be made here")
    folder = cache_folder(package)
    assert folder.is_dir()
    assert package not in folder.parents
    assert folder.is_relative_to(package.parent / "home")


def test_where_nothing_can_be_written_nothing_is_kept(package):
    (package / "__pycache__").write_text("no folder can be made here")
    (package.parent / "home").write_text("nor here")
    assert cache_folder(package) is None


def test_the_user_s_choice_of_a_folder_counts(package, monkeypatch):
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(package / "chosen"))
    assert cache_folder(package).is_relative_to(package / "chosen")


def test_folders_long_unused_are_deleted_and_no_others(package):
    cache = package / "__pycache__"
    old, recent = cache / "loops-old", cache / "loops-recent"
    for folder in (old, recent):
        folder.mkdir(parents=True)
        (folder / "loop.nbi").write_bytes(b"code")
    long_ago = time.time() - UNUSED - 60.0
    os.utime(old, (long_ago, long_ago))
    os.utime(cache_folder(package), (long_ago, long_ago))
    own = cache_folder(package)
    assert {*cache.iterdir()} == {recent, own}
    assert time.time() - own.stat().st_mtime < UNUSED


def test_many_may_start_at_once(package):
    with ThreadPoolExecutor(8) as pool:
        folders = set(pool.map(lambda _: cache_folder(package), range(64)))
    assert len(folders) == 1


def test_decorating_in_several_threads_leaves_numba_s_setting_as_it_was(package):
    def decorated(_):
        with kept_in(package):
            return njit(cache=True)(lambda x: x).stats.cache_path

    with ThreadPoolExecutor(8) as pool:
        paths = set(pool.map(decorated, range(32)))
    assert {Path(path).parent for path in paths} == {package}
    assert numba.config.CACHE_DIR == ""


def test_however_samples_are_laid_out_one_loop_is_compiled_for_them():
    rows = np.arange(12.0).reshape(6, 2)
    frozen = rows.copy()
    frozen.flags.writeable = False
    laid_out = (rows, frozen, np.asfortranarray(rows), np.repeat(rows, 2, axis=0)[::2])
    assert len({numba.typeof(values) for values in laid_out}) == len(laid_out)
    shots = [Shots(values[:, 0], values, rows, (0, 6)) for values in laid_out]
    shots.append(pickle.loads(pickle.dumps(shots[0])))  # as another process gets it
    assert len({numba.typeof(shot.inputs) for shot in shots}) == 1
    assert len({numba.typeof(shot.time) for shot in shots}) == 1
    assert all(np.array_equal(shot.inputs, rows) for shot in shots)
    assert rows.flags.writeable  # what was given stays the giver's
