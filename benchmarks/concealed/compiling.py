"""Types of the compiled functions, so that the time loop is compiled once for all.

A machine's functions are passed to the loop as pointers of one type. Without that
numba would compile the whole loop anew for every machine. What is compiled is kept on
disk, in a folder named by a digest of all sources that it is made of: numba by itself
asks only whether a function's own file has changed, not what the function calls.
"""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba import config, njit, types

HOME = Path(__file__).parent

_VECTOR, _MATRIX = types.float64[::1], types.float64[:, ::1]
_INTEGERS = types.int64[::1]

FORCES = types.void(*[_VECTOR] * 10)
"""(q, v, z, u, p, acceleration, F, g, load, stored)."""
MASSES = types.void(_VECTOR, _VECTOR, _VECTOR, _MATRIX)
"""(q, v, p, M)."""
READINGS = types.void(*[_VECTOR] * 7)
"""(q, v, z, u, p, acceleration, y)."""

_SLOTS = types.Tuple((_INTEGERS, _MATRIX, _INTEGERS, _MATRIX, _INTEGERS, _MATRIX))
_FUNCTIONS = (
    types.FunctionType(FORCES),
    types.FunctionType(MASSES),
    types.FunctionType(READINGS),
)

PUSH = types.void(
    *_FUNCTIONS[:2], *[_VECTOR] * 6, _SLOTS, types.float64, *[_VECTOR] * 8, _MATRIX
)
_PATH = types.Tuple((_INTEGERS, _MATRIX))
_SENSORS = types.Tuple((_INTEGERS, _MATRIX, _VECTOR))
_CONTROL = types.Tuple(
    (
        _VECTOR,
        _VECTOR,
        _INTEGERS,
        _VECTOR,
        types.float64,
        types.float64,
    )
)
MARCH = types.Tuple((_MATRIX, _MATRIX, _MATRIX, _MATRIX))(
    *_FUNCTIONS,
    _VECTOR,
    types.UniTuple(_VECTOR, 3),
    _SLOTS,
    _PATH,
    _SENSORS,
    _CONTROL,
    _MATRIX,
    _MATRIX,
    _MATRIX,
    types.int64[:, ::1],
    types.float64,
    types.int64,
)


def _digest() -> str:
    """Return a name for the sources of what is compiled, as they are."""
    whole = hashlib.sha256()
    loops = (HOME / f"{name}.py" for name in ("compiling", "laws", "paths", "stepping"))
    for source in (*loops, *sorted((HOME / "machines").glob("*.py"))):
        whole.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    return whole.hexdigest()[:16]


KEPT = HOME / "__pycache__" / f"loops-{_digest()}"


def compiled(*signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return the decorator of what the time loop is made of, of a type if stated."""

    def decorate(function: Callable[..., Any]) -> Any:
        before = config.CACHE_DIR
        config.CACHE_DIR = str(KEPT)  # numba asks while it decorates
        try:
            return njit(*signature, cache=True)(function)
        finally:
            config.CACHE_DIR = before

    return decorate
