"""Calls of native code by address, from compiled loops.

numba runs the functions below while it compiles; their arguments are its own objects.
"""

from collections.abc import Callable
from typing import Any, cast

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.extending import intrinsic
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def _values(typing: Any, address: Any, v: Any) -> Any:
    return types.void(types.int64, v), _generate


def _slopes(typing: Any, address: Any, v: Any, slopes: Any) -> Any:
    return types.void(types.int64, v, slopes), _generate


def _along(
    typing: Any, address: Any, v: Any, d: Any, own: Any, where: Any, n: Any
) -> Any:
    return types.void(types.int64, v, d, own, where, types.int64), _generate_along


def _generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    address, *arrays = given
    data = [
        context.make_array(kind)(context, builder, array).data
        for kind, array in zip(signature.args[1:], arrays, strict=True)
    ]
    _call(builder, address, data)
    return context.get_dummy_value()


def _generate_along(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    address, *arrays, n = given
    made = [
        context.make_array(kind)(context, builder, array)
        for kind, array in zip(signature.args[1:-1], arrays, strict=True)
    ]
    stride = builder.extract_value(made[1].shape, 1)
    _call(builder, address, [*(array.data for array in made), stride, n])
    return context.get_dummy_value()


def _call(builder: Any, address: Any, arguments: list[Any]) -> None:
    kind = ir.FunctionType(ir.VoidType(), [a.type for a in arguments])
    builder.call(builder.inttoptr(address, kind.as_pointer()), arguments)


call_values = cast("Callable[[int, Array], None]", intrinsic(_values))
"""Call ``void f(double *v)``."""
call_slopes = cast("Callable[[int, Array, Array], None]", intrinsic(_slopes))
"""Call ``void f(double *v, double *slopes)``."""
call_along = cast(
    "Callable[[int, Array, Array, Array, Integers, int], None]", intrinsic(_along)
)
"""Call ``void f(double *v, double *d, double *own, int64 *where, int64 stride, int64
n)``; the stride is that of `d`."""
