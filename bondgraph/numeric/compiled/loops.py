"""Decorators of compiled loops. Loads numba: import it late."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from bondgraph.numeric.compiled.cache import cache_folder, kept_in

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Function = TypeVar("Function", bound=Callable[..., Any])

FOLDER = cache_folder(Path(__file__).parents[1])


def _decorator(**options: Any) -> Callable[[Function], Function]:
    def decorate(function: Function) -> Function:
        if FOLDER is None:
            return _compiled(function, cache=False, **options)
        with kept_in(FOLDER):
            return _compiled(function, cache=True, **options)

    return decorate


def _compiled(function: Function, **options: Any) -> Function:
    made: Function = njit(nogil=True, error_model="numpy", **options)(function)
    return made


compiled = _decorator()
# numba counts references to every array at every call, which costs more than small
# loops do; it leaves that out where nothing is allocated.
lean = _decorator(_nrt=False)
"""For functions that allocate nothing."""
inlined = _decorator(_nrt=False, forceinline=True)
"""For small ones of them, written out where they are called."""
only_there = _decorator(inline="always")
"""For what one other function calls: compiled as a part of that one alone.

Whatever calls a compiled function compiles all of it again."""
