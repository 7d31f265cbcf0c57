"""Types of the compiled functions, so that the time loop is compiled once for all.

A machine's functions are passed to the loop as pointers of one type. Without that
numba would compile the whole loop anew for every machine.
"""

from collections.abc import Callable
from typing import Any

from numba import njit, types

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


def compiled(signature: Any) -> Callable[[Callable[..., None]], Any]:
    """Return the decorator that compiles a machine's function for the loop."""
    return njit(signature)
