"""What is said when loops have to be compiled before anything can run."""

import pytest
from numba import njit

from bondgraph.cli.first_use import ALWAYS, ONCE, told_of_compiling
from bondgraph.numeric.compiled import loops


def compiled_in(module: str):
    """Return a function of a module that is compiled at its first call."""

    def doubled(number):
        return 2.0 * number

    doubled.__module__ = module
    return njit(doubled)


@pytest.mark.parametrize("kept", [True, False])
def test_the_first_loop_that_is_compiled_is_told_and_no_other(kept, monkeypatch):
    if not kept:
        monkeypatch.setattr(loops, "FOLDER", None)
    said = []
    with told_of_compiling(said.append):
        for number in (1.0, 1.0):
            compiled_in("bondgraph.numeric.kernel.stage")(number)
    assert said == [ONCE if kept else ALWAYS]


def test_what_is_compiled_already_or_is_not_ours_is_not_told():
    ready = compiled_in("bondgraph.numeric.kernel.stage")
    ready(1.0)
    said = []
    with told_of_compiling(said.append):
        ready(2.0)
        compiled_in("someone.elses")(1.0)
    compiled_in("bondgraph.numeric.kernel.stage")(1.0)
    assert said == []
